// From a place of one picture to the place of the same point of the world in another.
#pragma once

#include <cmath>

#include "frame/camera_view.h"
#include "frame/frame.h"

namespace pelage {

/// The camera-space point that is seen at `at` (pixels) in depth z, metres.
inline Vec3 unproject(const CameraView& view, Vec2 at, float z) {
  const float w = view.perspective ? z : 1.f;
  return {(at.x - view.center_x) / view.focal * w, (at.y - view.center_y) / view.focal * w, z};
}

/// Where a point is seen: pixels and camera z, metres. `visible` is false, and the rest 0, behind the near plane.
struct Seen {
  Vec2 at;
  float depth = 0;
  bool visible = false;
};

/// Where `to` sees the point that `from` sees at `at` in depth z, metres, and that has moved by `way`, metres in the world. z = +inf is infinitely far: only the direction
/// counts, and an orthographic camera sees it in the same place wherever it stands.
inline Seen reproject(const CameraView& from, const CameraView& to, Vec2 at, float z, Vec3 way = {}) {
  if (std::isinf(z)) {
    if (!from.perspective || !to.perspective) return {at, z, true};
    const Vec3 c = transform_vector(to.world_to_camera, transform_vector(from.camera_to_world, unproject(from, at, 1)));
    return c.z > 0 ? Seen{project(to, c), z, true} : Seen{};
  }
  const Vec3 c = transform_point(to.world_to_camera, transform_point(from.camera_to_world, unproject(from, at, z)) + way);
  return c.z >= to.near_plane ? Seen{project(to, c), c.z, true} : Seen{};
}

}  // namespace pelage
