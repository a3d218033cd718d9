// Where the samples of a pixel are: the same places for the rasterizer, for jittered frames and for the path tracer.
#pragma once

#include <pelage/scene.h>
#include <pelage/vec.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage {

inline constexpr int kMaxSamples = 16;

inline bool is_sample_count(int count) { return count == 1 || count == 2 || count == 4 || count == 8 || count == 16; }

/// Positions of `count` ∈ {1, 2, 4, 8, 16} samples, from the pixel's top left corner, 0…1: the standard patterns of
/// Direct3D 11 (D3D11_STANDARD_MULTISAMPLE_QUALITY_LEVELS), which Vulkan calls standardSampleLocations. One sample
/// sits at the center. Entries from `count` on are unused. references.bib: Khronos2023Vulkan, "Multisampling".
inline std::array<Vec2, kMaxSamples> sample_positions(int count) {
  struct Sixteenths {
    int x, y;
  };
  static constexpr Sixteenths k1[] = {{0, 0}};
  static constexpr Sixteenths k2[] = {{4, 4}, {-4, -4}};
  static constexpr Sixteenths k4[] = {{-2, -6}, {6, -2}, {-6, 2}, {2, 6}};
  static constexpr Sixteenths k8[] = {{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};
  static constexpr Sixteenths k16[] = {{1, 1},  {-1, -3}, {-3, 2},  {4, -1}, {-5, -2}, {2, 5},  {5, 3}, {3, -5},
                                       {-2, 6}, {0, -7},  {-4, -6}, {-6, 4}, {-8, 0},  {7, -4}, {6, 7}, {-7, -8}};
  const Sixteenths* table = count == 1 ? k1 : count == 2 ? k2 : count == 4 ? k4 : count == 8 ? k8 : k16;
  std::array<Vec2, kMaxSamples> positions;
  for (int i = 0; i < count; ++i)
    positions[static_cast<std::size_t>(i)] =
        Vec2(0.5f + static_cast<float>(table[i].x) / 16.f, 0.5f + static_cast<float>(table[i].y) / 16.f);
  return positions;
}

/// Σ digit_k(i)·base^−(k+1): the digits of `i` mirrored at the point, [0, 1).
inline float radical_inverse(std::uint32_t i, std::uint32_t base) {
  double value = 0, digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) value += digit * (i % base);
  return static_cast<float>(value);
}

/// Positions of any number of samples, from the pixel's top left corner, 0…1; count ≥ 1. 1, 2, 4, 8 and 16 are
/// sample_positions(). Any other set is Hammersley's, ((i + ½)/count, mirrored bits of i + half a step): a net in base 2
/// where count is a power of two. With 64 samples its area of a band across the pixel is wrong by 0.018 (RMS over
/// bands of any angle, place and width), that of random positions by 0.036. references.bib: Niederreiter1992Random.
inline std::vector<Vec2> pixel_sample_positions(int count) {
  std::vector<Vec2> positions;
  if (is_sample_count(count)) {
    const auto standard = sample_positions(count);
    positions.assign(standard.begin(), standard.begin() + count);
    return positions;
  }
  std::uint32_t steps = 1;  // the first power of two ≥ count
  while (steps < static_cast<std::uint32_t>(count)) steps *= 2;
  const float half_step = 0.5f / static_cast<float>(steps);
  for (int i = 0; i < count; ++i)
    positions.emplace_back((static_cast<float>(i) + 0.5f) / static_cast<float>(count),
                           radical_inverse(static_cast<std::uint32_t>(i), 2) + half_step);
  return positions;
}

/// Position `frame` (0, 1, …) of an endless sequence of frames that take one sample each: Halton's, bases 2 and 3, without
/// its point 0. Any run of it is spread evenly. references.bib: Karis2014Temporal.
inline Vec2 jitter_position(std::uint32_t frame) { return {radical_inverse(frame + 1, 2), radical_inverse(frame + 1, 3)}; }

/// Whether a method works by strand linking, and how many samples a pixel it can take: squares of visibility pixels.
inline bool is_linking(Method method) { return method == Method::kLink || method == Method::kLinkTaa; }
inline bool is_link_sample_count(int samples) { return samples == 1 || samples == 4 || samples == 9 || samples == 16; }

/// Samples a pixel that method swr can take.
inline bool is_deferred_sample_count(int samples) { return samples == 1 || samples == 2 || samples == 4 || samples == 8; }

}  // namespace pelage
