// Rotations: how a handful of points has turned.
#pragma once

#include <pelage/vec.h>

#include <span>

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

/// The rotation that takes `rest` − its mean nearest to `moved` − its mean (least squares). Where points lie on a line, or in one
/// place, the turn that they do not tell is none. Both of the same size.
Rotation best_rotation(std::span<const Vec3> rest, std::span<const Vec3> moved);

/// From a to b at share t, the short way.
Rotation blend(const Rotation& a, const Rotation& b, float t);

}  // namespace pelage
