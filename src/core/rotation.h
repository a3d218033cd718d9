// Rotations and rigid motions.
#pragma once

#include <pelage/vec.h>

#include <cmath>

namespace pelage {

/// Unit quaternion.
struct Rotation {
  float w = 1;
  Vec3 v;

  Vec3 operator()(Vec3 p) const {
    const Vec3 t = cross(v, p) * 2.f;
    return p + t * w + cross(v, t);
  }
};

/// a ∘ b: first b, then a.
inline Rotation operator*(const Rotation& a, const Rotation& b) {
  return {a.w * b.w - dot(a.v, b.v), b.v * a.w + a.v * b.w + cross(a.v, b.v)};
}
inline Rotation inverse(const Rotation& r) { return {r.w, -r.v}; }
inline Rotation normalize(const Rotation& r) {
  const float l = std::sqrt(r.w * r.w + dot(r.v, r.v));
  return l > 0 ? Rotation{r.w / l, r.v / l} : Rotation();
}

/// The least rotation that takes direction `a` to `b`, both of unit length; any of them where they are opposite.
inline Rotation rotation_between(Vec3 a, Vec3 b) {
  const float cosine = dot(a, b);
  if (cosine > -0.999999f) return normalize(Rotation{1 + cosine, cross(a, b)});
  const Vec3 other = std::fabs(a.x) < 0.7f ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  return {0, normalize(cross(a, other))};
}

/// A rotation, then a translation.
struct Rigid {
  Rotation turn;
  Vec3 shift;

  Vec3 operator()(Vec3 p) const { return turn(p) + shift; }
};
inline Vec3 undo(const Rigid& r, Vec3 p) { return inverse(r.turn)(p - r.shift); }

inline Affine to_affine(const Rigid& r) {
  Affine a;
  const Vec3 columns[4] = {r.turn({1, 0, 0}), r.turn({0, 1, 0}), r.turn({0, 0, 1}), r.shift};
  for (int c = 0; c < 4; ++c) a.m[0][c] = columns[c].x, a.m[1][c] = columns[c].y, a.m[2][c] = columns[c].z;
  return a;
}

}  // namespace pelage
