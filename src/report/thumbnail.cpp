#include "report/thumbnail.h"

#include <pelage/metrics.h>
#include <pelage/render.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace pelage::report {
namespace {

// Means of boxes of whole pixels; small pictures stay as they are.
Image reduced(const Image& image) {
  const int side = std::max(image.width, image.height);
  if (side <= kThumbnailSide) return image;
  const auto scaled = [&](int length) { return std::max(1, length * kThumbnailSide / side); };
  Image small(scaled(image.width), scaled(image.height), image.channels);
  const std::size_t channels = image.channel_count();
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const int left = x * image.width / small.width, right = (x + 1) * image.width / small.width;
      const int top = y * image.height / small.height, bottom = (y + 1) * image.height / small.height;
      const auto count = static_cast<float>((right - left) * (bottom - top));
      for (int v = top; v < bottom; ++v)
        for (int u = left; u < right; ++u)
          for (std::size_t c = 0; c < channels; ++c) small.at(x, y)[c] += image.at(u, v)[c] / count;
    }
  return small;
}

}  // namespace

Image thumbnail(const Image& linear, ToneMap curve) {
  PELAGE_CHECK_EQ(linear.channel_count(), 3u);
  const Image small = reduced(linear);
  Image opaque(small.width, small.height, {"R", "G", "B", "A"}), shown = small;
  for (std::size_t i = 0, o = 0; i < small.pixels.size(); i += 3, o += 4) {
    std::copy_n(&small.pixels[i], 3, &opaque.pixels[o]);
    opaque.pixels[o + 3] = 1;
  }
  const Image display = make_display(opaque, curve);
  for (std::size_t i = 0, o = 0; i < shown.pixels.size(); i += 3, o += 4) std::copy_n(&display.pixels[o], 3, &shown.pixels[i]);
  return shown;
}

Image error_thumbnail(const Image& error) {
  PELAGE_CHECK_EQ(error.channel_count(), 1u);
  return color_error({"flip", reduced(error)}, 1);
}

std::vector<std::string> error_colors() {
  constexpr int kSteps = 256;
  Image ramp(kSteps, 1, {"error"});
  for (int i = 0; i < kSteps; ++i) *ramp.at(i, 0) = static_cast<float>(i) / (kSteps - 1);
  const Image painted = color_error({"flip", ramp}, 1);
  std::vector<std::string> colors;
  const auto byte = [](float x) { return std::lround(255 * x); };
  for (int i = 0; i < kSteps; ++i) {
    const float* const p = painted.at(i, 0);
    colors.push_back(fmt::format("#{:02x}{:02x}{:02x}", byte(p[0]), byte(p[1]), byte(p[2])));
  }
  return colors;
}

}  // namespace pelage::report
