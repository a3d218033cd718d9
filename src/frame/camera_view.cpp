#include "frame/camera_view.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include "core/check.h"

namespace pelage {
namespace {

constexpr float kMostShift = 10;  // heights of the picture

[[noreturn]] void fail(const char* what, float value, const char* remedy) {
  throw Error("camera", what, fmt::format("{} is out of range", value), remedy);
}

void check_camera(const Camera& camera) {
  if (!(camera.near_plane > 0) || !std::isfinite(camera.near_plane))
    fail("near_plane", camera.near_plane, "give a distance above 0 metres");
  if (camera.projection == Camera::Projection::kPerspective) {
    if (!(camera.fov_y > 1e-4f && camera.fov_y < 3.14f)) fail("fov_y", camera.fov_y, "give an angle between 0 and pi radians");
  } else if (!(camera.height > 0) || !std::isfinite(camera.height)) {
    fail("height", camera.height, "give a height above 0 metres");
  }
  if (!is_finite(camera.eye) || !is_finite(camera.target) || camera.eye == camera.target)
    throw Error("camera", "target", "eye and target coincide or are not finite", "give two different points");
  if (!(std::fabs(camera.shift_x) <= kMostShift)) fail("shift_x", camera.shift_x, "-10…10");
  if (!(std::fabs(camera.shift_y) <= kMostShift)) fail("shift_y", camera.shift_y, "-10…10");
}

/// The way that a camera looks, and where right and down of the picture lie.
struct Axes {
  Vec3 right, down, forward;
};

Axes axes_of(const Camera& camera) {
  const Vec3 forward = normalize(camera.target - camera.eye);
  Vec3 side = cross(forward, normalize(camera.up));
  if (!(dot(side, side) > 1e-10f)) side = cross(forward, std::fabs(forward.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  const Vec3 right = normalize(side);
  return {right, cross(forward, right), forward};
}

void check_stereo(const Stereo& stereo) {
  if (!(stereo.separation > 0) || !std::isfinite(stereo.separation))
    fail("stereo.separation", stereo.separation, "give a distance above 0 meters");
  if (!(stereo.convergence >= 0) || !std::isfinite(stereo.convergence))
    fail("stereo.convergence", stereo.convergence, "give a distance above 0 meters, or 0 for that of the target");
}

}  // namespace

std::vector<Camera> eyes(const Camera& camera) {
  if (!camera.stereo) return {camera};
  check_stereo(*camera.stereo);
  if (camera.projection != Camera::Projection::kPerspective)
    throw Error("camera", "stereo", "two eyes see the same in an orthographic picture", "use a perspective camera");
  check_camera(camera);
  const float half = 0.5f * camera.stereo->separation;
  const float distance = length(camera.target - camera.eye);
  const float convergence = camera.stereo->convergence > 0 ? camera.stereo->convergence : distance;
  const float shift = half / (2 * convergence * std::tan(0.5f * camera.fov_y));
  const Vec3 right = axes_of(camera).right;
  const auto eye = [&](float side) {
    Camera one = camera;
    one.stereo.reset();
    one.eye += right * (side * half), one.target += right * (side * half);
    one.shift_x -= side * shift;
    if (!(std::fabs(one.shift_x) <= kMostShift))
      fail("stereo.convergence", convergence, "give a distance that is larger beside the separation of the eyes");
    return one;
  };
  return {eye(-1), eye(1)};
}

Affine compose(const Affine& a, const Affine& b) {
  Affine r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0.f);
  return r;
}

Affine inverse_of_similarity(const Affine& a) {
  const float scale = similarity_scale(a), share = 1 / (scale * scale);
  Affine r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.m[i][j] = a.m[j][i] * share;
  const Vec3 back = transform_vector(r, Vec3(a.m[0][3], a.m[1][3], a.m[2][3]));
  r.m[0][3] = -back.x, r.m[1][3] = -back.y, r.m[2][3] = -back.z;
  return r;
}

float similarity_scale(const Affine& a) { return length(Vec3(a.m[0][0], a.m[1][0], a.m[2][0])); }

CameraView make_camera_view(const Camera& camera, int width, int height) {
  PELAGE_CHECK(width > 0 && height > 0);
  if (camera.stereo)
    throw Error("camera", "stereo", "two eyes, where the picture of one is made",
                "give each of eyes() by itself, or use `pelage render`");
  check_camera(camera);
  const auto [right, down, forward] = axes_of(camera);

  CameraView view;
  const Vec3 axes[3] = {right, down, forward};
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = axes[i];
    const float row[4] = {a.x, a.y, a.z, -dot(a, camera.eye)};
    for (int j = 0; j < 4; ++j) view.world_to_camera.m[i][j] = row[j];
  }
  for (int j = 0; j < 3; ++j) {
    view.camera_to_world.m[0][j] = axes[j].x;
    view.camera_to_world.m[1][j] = axes[j].y;
    view.camera_to_world.m[2][j] = axes[j].z;
  }
  view.camera_to_world.m[0][3] = camera.eye.x;
  view.camera_to_world.m[1][3] = camera.eye.y;
  view.camera_to_world.m[2][3] = camera.eye.z;

  view.perspective = camera.projection == Camera::Projection::kPerspective;
  view.focal = view.perspective ? 0.5f * static_cast<float>(height) / std::tan(0.5f * camera.fov_y)
                                : static_cast<float>(height) / camera.height;
  view.center_x = 0.5f * static_cast<float>(width) - camera.shift_x * static_cast<float>(height);
  view.center_y = 0.5f * static_cast<float>(height) + camera.shift_y * static_cast<float>(height);
  view.near_plane = camera.near_plane;
  view.width = width;
  view.height = height;
  return view;
}

Ray camera_ray(const CameraView& view, float x, float y) {
  const float px = (x - view.center_x) / view.focal, py = (y - view.center_y) / view.focal;
  const Vec3 eye = view.perspective ? Vec3(0, 0, 0) : Vec3(px, py, 0);
  const Vec3 along = view.perspective ? Vec3(px, py, 1) : Vec3(0, 0, 1);
  return {transform_point(view.camera_to_world, eye), transform_vector(view.camera_to_world, along), view.near_plane};
}

}  // namespace pelage
