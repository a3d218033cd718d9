#include "light/light_view.h"

#include <algorithm>
#include <array>

#include "core/bounds.h"
#include "core/check.h"

namespace pelage {
namespace {

/// Texels left free on each side, so that bilinear look-ups inside the bounds never leave the map.
constexpr float kMargin = 2;
/// Wider than this (tangent of the half angle) a single frustum wastes its texels: six faces take over.
constexpr float kMaxTangent = 1.5f;
/// A perspective light's near plane, as a share of the distance to the far end of what it lights.
constexpr float kNearShare = 1e-3f;

/// Camera at `eye` with axes x right, y down, z forward; the axes must be orthonormal.
CameraView oriented_view(Vec3 eye, Vec3 right, Vec3 down, Vec3 forward) {
  CameraView view;
  const Vec3 axis[3] = {right, down, forward};
  for (int r = 0; r < 3; ++r) {
    float* row = view.world_to_camera.m[r];
    row[0] = axis[r].x, row[1] = axis[r].y, row[2] = axis[r].z, row[3] = -dot(axis[r], eye);
    float* column[3] = {&view.camera_to_world.m[0][r], &view.camera_to_world.m[1][r], &view.camera_to_world.m[2][r]};
    *column[0] = axis[r].x, *column[1] = axis[r].y, *column[2] = axis[r].z;
  }
  view.camera_to_world.m[0][3] = eye.x, view.camera_to_world.m[1][3] = eye.y, view.camera_to_world.m[2][3] = eye.z;
  return view;
}

CameraView looking_along(Vec3 eye, Vec3 forward) {
  const Vec3 helper = std::fabs(forward.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
  const Vec3 right = normalize(cross(forward, helper));
  return oriented_view(eye, right, cross(forward, right), forward);
}

/// Sets focal length, centre and size so that the image-plane box [lo, hi] fills the map but for the margin.
void fit_image(CameraView& view, Vec2 lo, Vec2 hi, int size) {
  const float wide = std::max({hi.x - lo.x, hi.y - lo.y, 1e-6f});
  view.focal = (static_cast<float>(size) - 2 * kMargin) / wide;
  const auto texels = [&](float extent) {
    return std::clamp(static_cast<int>(std::ceil(extent * view.focal + 2 * kMargin)), 8, size);
  };
  view.width = texels(hi.x - lo.x), view.height = texels(hi.y - lo.y);
  view.center_x = 0.5f * (static_cast<float>(view.width) - view.focal * (lo.x + hi.x));
  view.center_y = 0.5f * (static_cast<float>(view.height) - view.focal * (lo.y + hi.y));
}

CameraView directional_view(const Light& light, const Bounds& bounds, int size) {
  const float radius = 0.5f * length(bounds.extent()) + 1e-4f;
  CameraView view = looking_along(bounds.center() - light.direction * (2 * radius), light.direction);
  view.perspective = false;
  view.near_plane = 0.5f * radius;
  Vec2 lo{INFINITY, INFINITY}, hi{-INFINITY, -INFINITY};
  for (const Vec3 corner : corners(bounds)) {
    const Vec3 p = to_camera(view, corner);
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)}, hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
  }
  fit_image(view, lo, hi, size);
  return view;
}

/// The frustum over the box of the corners' tangents; false where the bounds are not well in front of the light.
bool frustum_view(const Light& light, const Bounds& bounds, int size, CameraView& view) {
  const Vec3 to_center = bounds.center() - light.position;
  if (length(to_center) < 1e-6f) return false;
  view = looking_along(light.position, normalize(to_center));
  view.perspective = true;
  Vec2 lo{INFINITY, INFINITY}, hi{-INFINITY, -INFINITY};
  float farthest = 0;
  for (const Vec3 corner : corners(bounds)) {
    const Vec3 p = to_camera(view, corner);
    if (p.z <= 0) return false;
    const float x = p.x / p.z, y = p.y / p.z;
    if (std::max(std::fabs(x), std::fabs(y)) > kMaxTangent) return false;
    lo = {std::min(lo.x, x), std::min(lo.y, y)}, hi = {std::max(hi.x, x), std::max(hi.y, y)};
    farthest = std::max(farthest, p.z);
  }
  view.near_plane = kNearShare * farthest;
  fit_image(view, lo, hi, size);
  return true;
}

std::vector<CameraView> cube_views(const Light& light, const Bounds& bounds, int size) {
  const std::array<Vec3, 6> forward{Vec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<CameraView> views;
  for (const Vec3 f : forward) {
    CameraView view = looking_along(light.position, f);
    view.perspective = true;
    view.near_plane = kNearShare * (length(bounds.extent()) + length(bounds.center() - light.position));
    fit_image(view, {-1, -1}, {1, 1}, size);
    views.push_back(view);
  }
  return views;
}

}  // namespace

std::vector<CameraView> light_views(const Light& light, const Bounds& bounds, int size) {
  PELAGE_CHECK(!bounds.empty());
  if (light.type == Light::Type::kDirectional) return {directional_view(light, bounds, size)};
  CameraView view;
  if (frustum_view(light, bounds, size, view)) return {view};
  return cube_views(light, bounds, size);
}

}  // namespace pelage
