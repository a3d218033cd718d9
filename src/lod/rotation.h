// Rotations: how a handful of points has turned.
#pragma once

#include <pelage/vec.h>

#include <span>

#include "core/rotation.h"

namespace pelage {

/// The rotation that takes `rest` − its mean nearest to `moved` − its mean (least squares). Where points lie on a line, or in one
/// place, the turn that they do not tell is none. Both of the same size.
Rotation best_rotation(std::span<const Vec3> rest, std::span<const Vec3> moved);

/// From a to b at share t, the short way.
Rotation blend(const Rotation& a, const Rotation& b, float t);

}  // namespace pelage
