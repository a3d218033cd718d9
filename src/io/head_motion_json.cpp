// Keyframes of a head from a JSON file.
#include <pelage/error.h>
#include <pelage/simulate.h>

#include <cmath>

#include "io/byte_source.h"
#include "io/scene_json.h"

namespace pelage {
namespace {

using namespace io;

constexpr double kFar = 1e6;

struct KeyText {
  float time = 0;
  Vec3 translation, axis{0, 1, 0};
  float angle = 0;  // radians
};

struct MotionText {
  Vec3 pivot;
  std::vector<KeyText> keys;
};

const Fields<KeyText>& key_fields() {
  static const Fields<KeyText> table{
      number_field("time", "Seconds; the first frame is at 0", &KeyText::time, -kFar, kFar).required(),
      vector_field("translation", "Meters from where the head is at rest", &KeyText::translation, -kFar, kFar),
      vector_field("axis", "Of the rotation, of any length", &KeyText::axis, -kFar, kFar),
      number_field("angle", "Degrees about the axis, counter-clockwise", &KeyText::angle, -180, 180, 3.14159265 / 180)};
  return table;
}

const Fields<MotionText>& motion_fields() {
  static const Fields<MotionText> table{
      vector_field("pivot", "What the head turns about, meters; else below the middle of the guides' roots", &MotionText::pivot,
                   -kFar, kFar),
      list_field("keys", "In order of time", &MotionText::keys, key_fields())};
  return table;
}

HeadKey key_of(const KeyText& text, const JsonValue& place) {
  if (!(length(text.axis) > 0)) place.fail("the axis has no length", "give the direction that the head turns about");
  const Vec3 v = normalize(text.axis) * std::sin(0.5f * text.angle);
  return {static_cast<double>(text.time), text.translation, {v.x, v.y, v.z, std::cos(0.5f * text.angle)}};
}

}  // namespace

HeadMotion read_head_motion(const std::string& path, Vec3 pivot) {
  const JsonDocument document(path, ByteSource::open(path).read_all(), "a head motion is {\"keys\": [{\"time\": 0}, …]}");
  const JsonValue root(document);
  MotionText text;
  text.pivot = pivot;
  read_object(root, motion_fields(), text);
  HeadMotion motion;
  motion.pivot = text.pivot;
  if (text.keys.empty()) root.fail("there are no keys", "give at least one");
  const std::vector<JsonValue> places = root.member("keys").elements();
  for (std::size_t i = 0; i < text.keys.size(); ++i) {
    motion.keys.push_back(key_of(text.keys[i], places[i]));
    if (i > 0 && !(motion.keys[i].time > motion.keys[i - 1].time))
      places[i].fail("its time is not after that of the key before", "give keys in order of time");
  }
  return motion;
}

}  // namespace pelage
