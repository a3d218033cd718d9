#include "frame/window.h"

#include <algorithm>
#include <cmath>

#include "core/bounds.h"
#include "frame/camera_view.h"

namespace pelage {

Window window_of(const CameraView& view, const Bounds& strands, const MeshTracer& meshes) {
  const Window whole{0, 0, view.width, view.height};
  if (strands.empty()) return whole;
  Bounds box = strands;
  box.extend(meshes.bounds());
  constexpr float kMargin = 1;  // pixels, for roundings
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Vec3 corner : corners(box)) {
    const Vec3 c = transform_point(view.world_to_camera, corner);
    if (!(c.z >= view.near_plane)) return whole;
    const Vec2 p = project(view, c);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)}, high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const auto inside = [](float v, int size) { return static_cast<int>(std::clamp(v, 0.f, static_cast<float>(size))); };
  const int x = inside(low.x - kMargin, view.width), y = inside(low.y - kMargin, view.height),
            right = inside(std::ceil(high.x + kMargin), view.width), bottom = inside(std::ceil(high.y + kMargin), view.height);
  return {x, y, right - x, bottom - y};
}

CameraView view_of(CameraView view, const Window& window) {
  view.center_x -= static_cast<float>(window.x), view.center_y -= static_cast<float>(window.y);
  view.width = window.width, view.height = window.height;
  return view;
}

}  // namespace pelage
