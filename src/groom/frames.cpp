#include "groom/frames.h"

#include <algorithm>
#include <cmath>

namespace pelage::groom {
namespace {

/// v mirrored at the plane through the origin across `axis`; v itself where the axis vanishes.
Vec3 reflect(Vec3 v, Vec3 axis) {
  const float c = dot(axis, axis);
  return c > 1e-20f ? v - axis * (2 / c * dot(axis, v)) : v;
}

Vec3 any_across(Vec3 t) { return normalize(std::abs(t.x) < 0.9f ? cross(t, Vec3(1, 0, 0)) : cross(t, Vec3(0, 1, 0))); }

}  // namespace

void rotation_minimizing_frames(const Vec3* p, int count, Vec3 normal, Vec3* side, Vec3* up) {
  const auto tangent = [&](int i) {
    const Vec3 t = normalize(p[std::min(i + 1, count - 1)] - p[std::max(i - 1, 0)]);
    return dot(t, t) > 0 ? t : Vec3(0, 1, 0);
  };
  Vec3 t = tangent(0), r = normal - t * dot(normal, t);
  r = dot(r, r) > 1e-6f ? normalize(r) : any_across(t);
  for (int i = 0; i < count; ++i) {
    if (i > 0) {
      const Vec3 step = p[i] - p[i - 1], next = tangent(i);
      r = reflect(reflect(r, step), next - reflect(t, step));
      r = normalize(r - next * dot(r, next));  // rounding only
      t = next;
    }
    side[i] = r, up[i] = cross(t, r);
  }
}

}  // namespace pelage::groom
