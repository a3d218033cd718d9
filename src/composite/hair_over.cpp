#include <cmath>

#include "composite/composite.h"
#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

/// What lies behind the hair of a pixel: premultiplied R, G, B and alpha.
Vec4 behind(const OpaqueLayer& opaque, const Backdrop& backdrop, std::size_t pixel) {
  const Vec3 color = backdrop.pixels.empty() ? backdrop.color : backdrop.pixels[pixel];
  const Vec4 back(color.x * backdrop.alpha, color.y * backdrop.alpha, color.z * backdrop.alpha, backdrop.alpha);
  if (opaque.shade.empty()) return back;
  const auto samples = static_cast<std::size_t>(opaque.samples);
  Vec4 sum(0, 0, 0, 0);
  for (std::size_t s = pixel * samples; s < (pixel + 1) * samples; ++s) {
    const bool hit = opaque.shade[s] != OpaqueLayer::kNone;
    const Vec3 c = hit ? opaque_color(opaque, s) : Vec3(back.x, back.y, back.z);
    sum = {sum.x + c.x, sum.y + c.y, sum.z + c.z, sum.w + (hit ? 1 : back.w)};
  }
  const float share = 1 / static_cast<float>(samples);
  return {sum.x * share, sum.y * share, sum.z * share, sum.w * share};
}

}  // namespace

Image hair_over(const HairPicture& hair, const OpaqueLayer& opaque, const Backdrop& backdrop, int width, int height,
                float exposure) {
  PELAGE_CHECK(hair.left >= 0 && hair.left + hair.width <= width && hair.top >= 0 && hair.top + hair.height <= height);
  Image image(width, height, {"R", "G", "B", "A"});
  const float light = std::exp2(exposure);
  parallel_for(static_cast<std::size_t>(height), 8, [&](std::size_t first, std::size_t last) {
    std::size_t pixel = first * static_cast<std::size_t>(width);
    float* out = image.pixels.data() + 4 * pixel;
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < width; ++x, ++pixel, out += 4) {
        Vec4 p = behind(opaque, backdrop, pixel);
        const int column = x - hair.left, row = y - hair.top;
        if (column >= 0 && column < hair.width && row >= 0 && row < hair.height) {
          const Vec4 h = hair.color[static_cast<std::size_t>(row) * static_cast<std::size_t>(hair.width) +
                                    static_cast<std::size_t>(column)];
          const float through = 1 - h.w;
          p = {h.x + p.x * through, h.y + p.y * through, h.z + p.z * through, h.w + p.w * through};
        }
        out[0] = p.x * light, out[1] = p.y * light, out[2] = p.z * light, out[3] = p.w;
      }
  });
  return image;
}

}  // namespace pelage
