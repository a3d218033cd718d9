#include "groom/head_motion.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/nearest.h"

namespace pelage {
namespace {

constexpr float kDegree = 3.14159265f / 180;

/// A key as numbers of one kind, so that one formula runs through all of them.
using Values = std::array<double, 7>;

Values values_of(const HeadKey& k) {
  const auto d = [](float x) { return static_cast<double>(x); };
  return {d(k.translation.x), d(k.translation.y), d(k.translation.z), d(k.rotation.x),
          d(k.rotation.y),    d(k.rotation.z),    d(k.rotation.w)};
}

/// q and −q are the same rotation: that of the two which is nearer to `like`.
Values nearer(Values v, const Values& like) {
  double cosine = 0;
  for (std::size_t c = 3; c < 7; ++c) cosine += v[c] * like[c];
  if (cosine < 0)
    for (std::size_t c = 3; c < 7; ++c) v[c] = -v[c];
  return v;
}

/// Change per second of the curve through three keys at the middle one.
Values slope(const HeadMotion& motion, std::size_t k, const Values& here) {
  Values s{};
  if (k == 0 || k + 1 == motion.keys.size()) return s;  // at rest at both ends
  const HeadKey &a = motion.keys[k - 1], &b = motion.keys[k + 1];
  const Values before = nearer(values_of(a), here), after = nearer(values_of(b), here);
  for (std::size_t c = 0; c < 7; ++c) s[c] = (after[c] - before[c]) / (b.time - a.time);
  return s;
}

Vec4 unit(double x, double y, double z, double w) {
  const double l = std::sqrt(x * x + y * y + z * z + w * w);
  const auto f = [&](double v) { return static_cast<float>(v / l); };
  return l > 0 ? Vec4(f(x), f(y), f(z), f(w)) : Vec4(0, 0, 0, 1);
}

HeadKey key_of(double time, const Values& v) {
  return {time, Vec3(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])),
          unit(v[3], v[4], v[5], v[6])};
}

Vec4 about(Vec3 axis, float degrees) {
  const float half = 0.5f * degrees * kDegree;
  const Vec3 v = axis * std::sin(half);
  return {v.x, v.y, v.z, std::cos(half)};
}

/// A motion of `period` seconds again and again, until `seconds` are over.
template <class Key>
HeadMotion repeated(double seconds, double step, const Key& key) {
  HeadMotion motion;
  for (std::size_t i = 0; static_cast<double>(i) * step < seconds + step; ++i) {
    HeadKey k = key(i);
    k.time = static_cast<double>(i) * step;
    motion.keys.push_back(k);
  }
  return motion;
}

HeadMotion nod(double seconds) {
  constexpr float kDegrees[] = {0, 22, -8, 22, -8, 0};
  return repeated(seconds, 0.4, [&](std::size_t i) { return HeadKey{0, {}, about({1, 0, 0}, kDegrees[i % 6])}; });
}

HeadMotion turn(double seconds) {
  constexpr float kDegrees[] = {0, 55, 55, -55, -55, 0};
  return repeated(seconds, 0.5, [&](std::size_t i) { return HeadKey{0, {}, about({0, 1, 0}, kDegrees[i % 6])}; });
}

// A step takes half a second: the head is highest in its middle and lowest at its end, and sways over the standing foot.
HeadMotion walk(double seconds) {
  return repeated(seconds, 0.125, [&](std::size_t i) {
    if (i == 0) return HeadKey();
    const float step = static_cast<float>(i) * 0.25f * 2 * 3.14159265f;  // one turn a step
    const float up = -0.02f * std::cos(step), aside = 0.015f * std::sin(0.5f * step);
    return HeadKey{0, {aside, up, 0}, about({1, 0, 0}, 2 * std::sin(step))};
  });
}

}  // namespace

namespace groom {

void check(const HeadMotion& motion) {
  for (std::size_t i = 0; i < motion.keys.size(); ++i) {
    const HeadKey& k = motion.keys[i];
    const auto require = [&](bool sound, const char* problem, const char* remedy) {
      if (!sound) throw Error("head motion", fmt::format("key {}", i), problem, remedy);
    };
    require(std::isfinite(k.time) && (i == 0 || k.time > motion.keys[i - 1].time),
            "its time is not after that of the key before", "give keys in order, in seconds");
    require(is_finite(k.translation) && length(k.translation) <= 1e6f, "its translation is out of range", "metres");
    const Vec4 r = k.rotation;
    const float norm = r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w;
    require(std::fabs(norm - 1) < 1e-3f, "its rotation is no unit quaternion", "x, y, z, w of length 1");
  }
  if (!is_finite(motion.pivot)) throw Error("head motion", "pivot", "it is not finite", "metres");
}

HeadKey key_at(const HeadMotion& motion, double time) {
  const std::vector<HeadKey>& keys = motion.keys;
  if (keys.empty()) return {};
  if (time <= keys.front().time) return keys.front();
  if (time >= keys.back().time) return keys.back();
  const auto after = std::upper_bound(keys.begin(), keys.end(), time, [](double t, const HeadKey& k) { return t < k.time; });
  const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
  const double span = keys[i + 1].time - keys[i].time, t = (time - keys[i].time) / span;
  const Values a = values_of(keys[i]), b = nearer(values_of(keys[i + 1]), a);
  const Values out = slope(motion, i, a), in = slope(motion, i + 1, b);
  const double t2 = t * t, t3 = t2 * t;
  Values v;
  for (std::size_t c = 0; c < v.size(); ++c)
    v[c] = (2 * t3 - 3 * t2 + 1) * a[c] + (3 * t2 - 2 * t3) * b[c] + span * ((t3 - 2 * t2 + t) * out[c] + (t3 - t2) * in[c]);
  return key_of(time, v);
}

Rigid head_pose(const HeadMotion& motion, double time) {
  const HeadKey k = key_at(motion, time);
  const Rotation turn = normalize(Rotation{k.rotation.w, Vec3(k.rotation.x, k.rotation.y, k.rotation.z)});
  return {turn, k.translation + (motion.pivot - turn(motion.pivot))};
}

}  // namespace groom

Affine head_at(const HeadMotion& motion, double time) { return to_affine(groom::head_pose(motion, time)); }

const std::vector<std::string>& head_motion_names() {
  static const std::vector<std::string> names{"still", "nod", "turn", "walk"};
  return names;
}

HeadMotion head_motion(const std::string& name, double seconds, Vec3 pivot) {
  HeadMotion motion;
  if (name == "nod") motion = nod(seconds);
  else if (name == "turn") motion = turn(seconds);
  else if (name == "walk") motion = walk(seconds);
  else if (name != "still")
    throw Error("head motion", name, "there is none of this name",
                fmt::format("did you mean `{}`?", nearest_name(name, head_motion_names())));
  motion.pivot = pivot;
  return motion;
}

Vec3 neck_of(const LodHierarchy& lod) {
  Bounds roots;
  for (std::size_t g = 0; g < lod.guide_count(); ++g) roots.extend(lod.guides[g * LodHierarchy::kPoints]);
  if (roots.empty()) return {};
  return {roots.center().x, roots.lower.y, roots.center().z};
}

}  // namespace pelage
