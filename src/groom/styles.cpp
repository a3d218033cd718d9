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
      s.length = 0.32f, s.length_variation = 0.12f, s.clumps = 900, s.clump_tightness = 0.5f, s.frizz = 0.15f;
      break;
    case HairStyle::kWavy:
      s.length = 0.33f, s.length_variation = 0.12f, s.clumps = 600, s.clump_tightness = 0.65f, s.frizz = 0.3f;
      s.curl_radius = 0.010f, s.curl_pitch = 0.085f, s.flyaways = 0.025f, s.volume = 0.018f;
      break;
    case HairStyle::kCurly:
      s.length = 0.40f, s.clumps = 480, s.clump_tightness = 0.85f, s.frizz = 0.3f, s.curl_radius = 0.009f;
      s.curl_pitch = 0.036f, s.flyaways = 0.03f, s.volume = 0.024f;
      break;
    case HairStyle::kAfro:
      s.length = 0.175f, s.length_variation = 0.05f, s.clumps = 2200, s.clump_tightness = 0.3f, s.frizz = 0.5f;
      s.curl_radius = 0.005f, s.curl_pitch = 0.012f, s.flyaways = 0.02f, s.gravity = 0.2f, s.width = 9e-5f;
      s.taper = 0.4f, s.volume = 0.004f;
      break;
    case HairStyle::kPonytail:
      s.length = 0.42f, s.length_variation = 0.1f, s.clumps = 900, s.clump_tightness = 0.35f, s.frizz = 0.12f;
      s.curl_radius = 0.003f, s.curl_pitch = 0.12f, s.flyaways = 0.012f, s.volume = 0.008f;
      break;
    case HairStyle::kCoat:
      s.length = 0.016f, s.length_variation = 0.2f, s.points = 16, s.width = 7e-5f, s.taper = 0.9f, s.clumps = 6000;
      s.clump_tightness = 0.55f, s.frizz = 0.4f, s.gravity = 0.3f, s.curl_radius = 0.0006f, s.curl_pitch = 0.012f;
      s.volume = 0.002f;
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
