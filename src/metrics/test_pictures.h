// Pictures for the tests of metrics: smooth, with edges, lines, points and noise, the same on every machine.
#pragma once

#include <pelage/metrics.h>

#include <cmath>

#include "core/rng.h"

namespace pelage::metrics {

inline Picture make_picture(int width, int height, Encoding encoding = Encoding::kDisplay) {
  return {Image(width, height, {"R", "G", "B"}), encoding, "picture"};
}

/// Waves, a bright square, thin lines and a dot; values 0…1.
inline Picture drawn(int width, int height, Encoding encoding = Encoding::kDisplay) {
  Picture picture = make_picture(width, height, encoding);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float* c = picture.image.at(x, y);
      const float u = static_cast<float>(x) / static_cast<float>(width), v = static_cast<float>(y) / static_cast<float>(height);
      for (int i = 0; i < 3; ++i)
        c[i] = 0.5f + 0.3f * std::sin(9 * u + static_cast<float>(i)) * std::cos(7 * v - static_cast<float>(i));
      if (u > 0.2f && u < 0.4f && v > 0.3f && v < 0.6f) c[0] = 0.95f, c[1] = 0.9f, c[2] = 0.2f;
      if ((x + 2 * y) % 23 == 0) c[0] = 0.05f, c[1] = 0.1f, c[2] = 0.6f;
      if (x % 31 == 7 && y % 29 == 5) c[0] = c[1] = c[2] = 1;
    }
  return picture;
}

/// `picture` plus noise of the given amplitude, kept in 0…1.
inline Picture noisy(Picture picture, float amplitude, std::uint32_t seed = 1) {
  const std::size_t n = picture.image.channel_count();
  for (std::size_t i = 0; i < picture.image.pixels.size(); ++i) {
    const RandomBits bits = pcg4d(static_cast<std::uint32_t>(i / n), static_cast<std::uint32_t>(i % n), seed, 0);
    float& value = picture.image.pixels[i];
    value = std::clamp(value + amplitude * (2 * uniform_from_bits(bits.x) - 1), 0.f, 1.f);
  }
  return picture;
}

}  // namespace pelage::metrics
