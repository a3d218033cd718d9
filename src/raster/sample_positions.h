// Where the 1, 2, 4, 8 or 16 samples of a pixel are.
#pragma once

#include <pelage/vec.h>

#include <array>
#include <cstddef>

namespace pelage {

inline constexpr int kMaxSamples = 16;

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

inline bool is_sample_count(int count) { return count == 1 || count == 2 || count == 4 || count == 8 || count == 16; }

}  // namespace pelage
