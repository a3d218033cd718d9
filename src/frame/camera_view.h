// From the camera of a scene to the numbers that projection needs; shared by raster (the eye) and light (shadow views).
#pragma once

#include <pelage/scene.h>

#include "core/ray.h"
#include "frame/frame.h"

namespace pelage {

/// The view of `camera` on an image of width × height pixels (square pixels; `fov_y` and `height` span the height).
/// Throws Error("camera", …) where an angle, a height or the near plane is out of range, or eye and target coincide, or
/// the camera stands for two eyes.
/// An `up` along the view direction is replaced by another axis.
CameraView make_camera_view(const Camera& camera, int width, int height);

/// a ∘ b: first b, then a.
Affine compose(const Affine& a, const Affine& b);

/// The inverse of a similarity.
Affine inverse_of_similarity(const Affine& a);

/// The one scale factor of a similarity: length of its first column.
float similarity_scale(const Affine& a);

/// Pixels per metre, facing the camera, at camera depth z > 0.
inline float pixels_per_metre(const CameraView& view, float z) { return view.perspective ? view.focal / z : view.focal; }

/// Ray through a place of the image, pixels, from the near plane on; its parameter is the camera depth.
Ray camera_ray(const CameraView& view, float x, float y);

/// Where a point in camera space is seen, pixels.
inline Vec2 project(const CameraView& view, Vec3 c) {
  const float scale = pixels_per_metre(view, c.z);
  return {view.center_x + scale * c.x, view.center_y + scale * c.y};
}

/// Unit direction from a point of the world to the eye.
inline Vec3 direction_to_eye(const CameraView& view, Vec3 position) {
  if (view.perspective) return normalize(transform_point(view.camera_to_world, {0, 0, 0}) - position);
  return normalize(transform_vector(view.camera_to_world, {0, 0, -1}));
}

/// Where something at `c` that moves along `v`, both in camera space, moves on the screen: pixels per length of v.
inline Vec2 project_direction(const CameraView& view, Vec3 c, Vec3 v) {
  const float scale = pixels_per_metre(view, c.z);
  if (!view.perspective) return {scale * v.x, scale * v.y};
  return {scale * (v.x - c.x * v.z / c.z), scale * (v.y - c.y * v.z / c.z)};
}

}  // namespace pelage
