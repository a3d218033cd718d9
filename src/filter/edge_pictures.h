// Pictures for tests of edge filters: shapes sampled at pixel centers, and how much of each pixel they really cover.
#pragma once

#include <pelage/image.h>
#include <pelage/runtime.h>

#include <cmath>

#include "core/rng.h"

namespace pelage::test {

/// White where inside(x, y), black elsewhere; opaque. `grid`² samples a pixel, 1: its center.
template <class Inside>
Image shape(int width, int height, int grid, const Inside& inside) {
  Image image(width, height, {"R", "G", "B", "A"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int hits = 0;
      for (int i = 0; i < grid * grid; ++i)
        hits += inside(static_cast<float>(x) + (static_cast<float>(i % grid) + 0.5f) / static_cast<float>(grid),
                       static_cast<float>(y) + (static_cast<float>(i / grid) + 0.5f) / static_cast<float>(grid));
      float* p = image.at(x, y);
      p[0] = p[1] = p[2] = static_cast<float>(hits) / static_cast<float>(grid * grid);
      p[3] = 1;
    }
  return image;
}

inline Image noise_picture(int width, int height) {
  Image image(width, height, {"R", "G", "B", "A"});
  Rng rng(3, 0);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i % 4 == 3 ? 1.f : rng.uniform();
  return image;
}

/// Whether filter(picture) is the same by one thread and by five.
template <class Filter>
bool same_bits_for_any_threads(const Filter& filter) {
  const Image noise = noise_picture(131, 77);
  set_thread_count(1);
  const Image one = filter(noise);
  set_thread_count(5);
  const Image five = filter(noise);
  set_thread_count(0);
  return one.pixels == five.pixels;
}

inline Image transposed(const Image& image) {
  Image result(image.height, image.width, image.channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 4; ++c) result.at(y, x)[c] = image.at(x, y)[c];
  return result;
}

/// Root of the mean squared difference of the red channels, `border` pixels at every side left away.
inline double rms_inside(const Image& a, const Image& b, int border) {
  double sum = 0;
  int count = 0;
  for (int y = border; y < a.height - border; ++y)
    for (int x = border; x < a.width - border; ++x, ++count) {
      const double d = static_cast<double>(a.at(x, y)[0] - b.at(x, y)[0]);
      sum += d * d;
    }
  return std::sqrt(sum / count);
}

}  // namespace pelage::test
