#include "filter/motion.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/reproject.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;

/// Calls paint(vector, rgba) for every pixel, where there is something with alpha 1.
template <class Paint>
Image paint_motion(const Buffer<Vec2>& motion, const Buffer<float>& depth, int width, int height, const Paint& paint) {
  Image image(width, height, {"R", "G", "B", "A"});
  PELAGE_CHECK_EQ(motion.size() * 4, image.pixels.size());
  parallel_for(motion.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      float* rgba = image.pixels.data() + 4 * p;
      paint(motion[p], rgba);
      rgba[3] = std::isinf(depth[p]) ? 0.f : 1.f;
    }
  });
  return image;
}

}  // namespace

Buffer<Vec2> motion_vectors(const CameraView& view, const CameraView& before, const Buffer<float>& depth,
                            const Buffer<Vec3>& way) {
  const auto width = static_cast<std::size_t>(view.width), height = static_cast<std::size_t>(view.height);
  PELAGE_CHECK_EQ(depth.size(), width * height);
  PELAGE_CHECK(way.empty() || way.size() == depth.size());
  const Vec2 outside(2 * static_cast<float>(view.width), 2 * static_cast<float>(view.height));
  Buffer<Vec2> motion(width * height);
  parallel_for(height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p) {
      const Vec2 at(static_cast<float>(p % width) + 0.5f, static_cast<float>(p / width) + 0.5f);
      // Back through `view` itself, so that rounding cancels and a still camera moves nothing at all.
      const Seen now = reproject(view, view, at, depth[p]),
                 then = reproject(view, before, at, depth[p], way.empty() ? Vec3() : way[p]);
      motion[p] = then.visible ? then.at - now.at : outside;
    }
  });
  return motion;
}

Image motion_data(const Buffer<Vec2>& motion, const Buffer<float>& depth, int width, int height) {
  return paint_motion(motion, depth, width, height, [](Vec2 v, float* rgb) { rgb[0] = v.x, rgb[1] = v.y; });
}

Image motion_display(const Buffer<Vec2>& motion, const Buffer<float>& depth, int width, int height) {
  constexpr float kFull = 16;  // pixels
  return paint_motion(motion, depth, width, height, [](Vec2 v, float* rgb) {
    const float length = std::sqrt(v.x * v.x + v.y * v.y);
    const float saturation = std::min(1.f, std::log2(1 + length) / std::log2(1 + kFull));
    const float hue = std::atan2(v.y, v.x) * (3 / 3.14159265f) + 6;  // sixths of a turn
    for (int c = 0; c < 3; ++c) {
      const float k = std::fmod(hue + static_cast<float>(5 - 2 * c), 6.f);
      rgb[c] = 0.7f + saturation * (0.3f - std::clamp(std::min(k, 4 - k), 0.f, 1.f));
    }
  });
}

}  // namespace pelage
