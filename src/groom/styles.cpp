// The named styles and what makes each look right.
#include <pelage/error.h>
#include <pelage/grow.h>

#include <cstddef>

#include "core/nearest.h"

namespace pelage {

GrowSettings grow_defaults(HairStyle style) {
  GrowSettings s;
  s.style = style;
  switch (style) {
    case HairStyle::kStraight:
      s.length = 0.32f, s.length_variation = 0.12f, s.clumps = 700, s.clump_tightness = 0.45f, s.frizz = 0.12f;
      break;
    case HairStyle::kWavy:
      s.length = 0.34f, s.curl_radius = 0.008f, s.curl_pitch = 0.075f, s.clumps = 500, s.clump_tightness = 0.6f;
      s.frizz = 0.25f, s.flyaways = 0.025f;
      break;
    case HairStyle::kCurly:
      s.length = 0.36f, s.curl_radius = 0.0085f, s.curl_pitch = 0.034f, s.clumps = 420, s.clump_tightness = 0.75f;
      s.frizz = 0.3f, s.flyaways = 0.03f;
      break;
    case HairStyle::kAfro:
      s.length = 0.20f, s.length_variation = 0.2f, s.curl_radius = 0.0035f, s.curl_pitch = 0.009f, s.clumps = 3000;
      s.clump_tightness = 0.35f, s.frizz = 0.6f, s.gravity = 0.05f;
      break;
    case HairStyle::kPonytail:
      s.length = 0.42f, s.length_variation = 0.1f, s.clumps = 600, s.clump_tightness = 0.35f, s.frizz = 0.12f;
      s.flyaways = 0.01f;
      break;
    case HairStyle::kCoat:
      s.length = 0.018f, s.length_variation = 0.2f, s.points = 16, s.width = 6e-5f, s.taper = 0.9f, s.clumps = 4000;
      s.clump_tightness = 0.5f, s.frizz = 0.25f, s.gravity = 0.3f;
      break;
  }
  return s;
}

const std::vector<std::string>& hair_style_names() {
  static const std::vector<std::string> names{"straight", "wavy", "curly", "afro", "ponytail", "coat"};
  return names;
}

HairStyle hair_style_from_name(const std::string& name) {
  const std::vector<std::string>& names = hair_style_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<HairStyle>(i);
  throw Error("style", name, "unknown hair style", "did you mean \"" + nearest_name(name, names) + "\"?");
}

}  // namespace pelage
