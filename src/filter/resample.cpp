#include "filter/resample.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;

void read_between(const Image& image, float x, float y, AlphaKind alpha, float* out) {
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f), u = x - 0.5f - fx, v = y - 0.5f - fy;
  const auto column = [&](float i) { return static_cast<int>(std::clamp(i, 0.f, static_cast<float>(image.width - 1))); };
  const auto row = [&](float i) { return static_cast<int>(std::clamp(i, 0.f, static_cast<float>(image.height - 1))); };
  PixelSum sum(alpha);
  sum.add(image.at(column(fx), row(fy)), (1 - u) * (1 - v));
  sum.add(image.at(column(fx + 1), row(fy)), u * (1 - v));
  sum.add(image.at(column(fx), row(fy + 1)), (1 - u) * v);
  sum.add(image.at(column(fx + 1), row(fy + 1)), u * v);
  sum.write(out);
}

}  // namespace

void PixelSum::add(const float* rgba, float weight) {
  const float color = alpha_ == AlphaKind::kStraight ? weight * rgba[3] : weight;
  for (int c = 0; c < 3; ++c) sum_[c] += color * rgba[c];
  sum_[3] += weight * rgba[3];
}

void PixelSum::write(float* rgba) const {
  const float scale = alpha_ == AlphaKind::kPremultiplied ? 1.f : sum_[3] > 0 ? 1 / sum_[3] : 0.f;
  for (int c = 0; c < 3; ++c) rgba[c] = sum_[c] * scale;
  rgba[3] = sum_[3];
}

Image resample(const Image& image, const Buffer<Vec2>& offsets, AlphaKind alpha) {
  PELAGE_CHECK_EQ(image.channel_count(), 4u);
  PELAGE_CHECK_EQ(offsets.size() * 4, image.pixels.size());
  const auto width = static_cast<std::size_t>(image.width);
  Image result = image;
  parallel_for(static_cast<std::size_t>(image.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p) {
      const Vec2 offset = offsets[p];
      if (offset == Vec2()) continue;
      const float x = static_cast<float>(p % width) + 0.5f + offset.x, y = static_cast<float>(p / width) + 0.5f + offset.y;
      read_between(image, x, y, alpha, result.pixels.data() + 4 * p);
    }
  });
  return result;
}

Buffer<float> display_luma(const Image& display) {
  PELAGE_CHECK_EQ(display.channel_count(), 4u);
  Buffer<float> luma(display.pixels.size() / 4);
  parallel_for(luma.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const float* c = display.pixels.data() + 4 * p;
      luma[p] = c[3] * (0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2]);
    }
  });
  return luma;
}

}  // namespace pelage
