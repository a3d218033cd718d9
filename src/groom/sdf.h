// Signed distance building blocks: negative inside, metres. Distances are first-order exact at the surface (|∇d| ≈ 1
// there), which is all that meshing and collision need.
#pragma once

#include <pelage/vec.h>

#include <algorithm>
#include <cmath>

namespace pelage::groom {

inline float saturate(float x) { return std::clamp(x, 0.f, 1.f); }
inline float square(float x) { return x * x; }
inline float mix(float a, float b, float t) { return a + (b - a) * t; }
inline float smoothstep(float low, float high, float x) {
  const float t = saturate((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

/// Axis-aligned ellipsoid around the origin: with f = |p/r|, the distance to first order is (f − 1)/|∇f| = f(f − 1)/|p/r²|.
inline float sd_ellipsoid(Vec3 p, Vec3 radii) {
  const Vec3 scaled = p / radii;
  const float f = length(scaled), gradient = length(scaled / radii);
  return gradient > 0 ? f * (f - 1) / gradient : -std::min({radii.x, radii.y, radii.z});
}

/// Capsule from `a` to `b` whose radius runs from `radius_a` to `radius_b`.
inline float sd_capsule(Vec3 p, Vec3 a, Vec3 b, float radius_a, float radius_b) {
  const Vec3 ab = b - a;
  const float t = saturate(dot(p - a, ab) / dot(ab, ab));
  return length(p - a - ab * t) - mix(radius_a, radius_b, t);
}

/// Union whose seam is rounded over the distance `k` (quadratic polynomial blend).
inline float smooth_union(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.f) / k;
  return std::min(a, b) - h * h * k * 0.25f;
}
inline float smooth_intersection(float a, float b, float k) { return -smooth_union(-a, -b, k); }
/// `a` without `b`.
inline float smooth_difference(float a, float b, float k) { return -smooth_union(-a, b, k); }

}  // namespace pelage::groom
