#include "composite/composite.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

Vec3 texel(const Image& map, int x, int y) {
  const int w = map.width;
  const float* p = map.at((x % w + w) % w, std::clamp(y, 0, map.height - 1));
  return {p[0], p[1], p[2]};
}

// Bilinear look-up of the latitude-longitude map, which wraps around the vertical axis.
Vec3 look_up(const Environment& environment, Vec3 d) {
  constexpr float kPi = 3.14159265f;
  const Image& map = *environment.map;
  const float azimuth = std::atan2(d.x, -d.z) + environment.rotation;  // 0 along −Z, the middle column
  const float x = (0.5f + azimuth / (2 * kPi)) * static_cast<float>(map.width) - 0.5f;
  const float y = std::acos(std::clamp(d.y, -1.f, 1.f)) / kPi * static_cast<float>(map.height) - 0.5f;
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  return lerp(lerp(texel(map, ix, iy), texel(map, ix + 1, iy), x - fx),
              lerp(texel(map, ix, iy + 1), texel(map, ix + 1, iy + 1), x - fx), y - fy);
}

Vec3 view_direction(const CameraView& view, int x, int y) {
  if (!view.perspective) return normalize(transform_vector(view.camera_to_world, {0, 0, 1}));
  const Vec3 camera{(static_cast<float>(x) + 0.5f - view.center_x) / view.focal,
                    (static_cast<float>(y) + 0.5f - view.center_y) / view.focal, 1};
  return normalize(transform_vector(view.camera_to_world, camera));
}

}  // namespace

Backdrop make_backdrop(const Scene& scene, const CameraView& view) {
  Backdrop backdrop;
  const Environment& environment = scene.environment;
  if (scene.settings.transparent_background) {
    backdrop.alpha = 0;
    return backdrop;
  }
  backdrop.color = environment.visible ? environment.radiance : scene.settings.background;
  if (!environment.visible || !environment.map) return backdrop;
  const auto width = static_cast<std::size_t>(view.width), height = static_cast<std::size_t>(view.height);
  backdrop.pixels.resize(width * height);
  parallel_for(height, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = 0; x < width; ++x)
        backdrop.pixels[y * width + x] =
            environment.radiance * look_up(environment, view_direction(view, static_cast<int>(x), static_cast<int>(y)));
  });
  return backdrop;
}

}  // namespace pelage
