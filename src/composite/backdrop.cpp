#include "composite/composite.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/environment_map.h"

namespace pelage {
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
        backdrop.pixels[y * width + x] = environment_radiance(
            environment, normalize(camera_ray(view, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f).direction));
  });
  return backdrop;
}

}  // namespace pelage
