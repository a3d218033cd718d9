// Lights as cameras: where their maps look from, and how wide.
#pragma once

#include <pelage/scene.h>

#include <vector>

#include "frame/frame.h"

namespace pelage {

/// Cameras that together see all of `bounds` from the light, each at most `size` texels wide and high: one, or the six
/// faces of a cube (in the order +X −X +Y −Y +Z −Z) for a point or spot light that is inside `bounds` or too near for one.
///
/// `bounds` must not be empty. The outermost texels are a margin that nothing inside `bounds` projects to.
std::vector<CameraView> light_views(const Light& light, const Bounds& bounds, int size);

/// Camera-space position of a world-space point (x right, y down, z forward).
inline Vec3 to_camera(const CameraView& view, Vec3 p) { return transform_point(view.world_to_camera, p); }

/// Metres that a texel spans at depth `z`.
inline float texel_size(const CameraView& view, float z) { return (view.perspective ? z : 1.f) / view.focal; }

}  // namespace pelage
