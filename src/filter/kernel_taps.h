// The pixels under the kernel of the orientation-aware filter, by the direction of the hair.
#pragma once

#include <pelage/vec.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/anisotropic.h"
#include "filter/kernel_field.h"
#include "kernel/scalar.h"

namespace pelage {

/// Directions without a sign, in kDirections cells; what lies in a cell takes the direction of its middle, at most 0.45° off.
/// They are given by the vector of twice the angle (MeanDirection), and cells are even in the share of x in its |x| + |y|, which
/// needs no arc tangent; the axes and diagonals are middles.
struct DirectionCells {
  static constexpr int kHalf = 128, kDirections = 2 * kHalf;  ///< cells of 90° and of 180°
  /// The cell of a doubled direction other than 0.
  static int cell_of(Vec2 doubled) {
    const float share = doubled.x / (std::fabs(doubled.x) + std::fabs(doubled.y));  // 1 … −1
    const float turned = doubled.y < 0 ? 3 + share : 1 - share;                     // 0 … 4 once around
    return static_cast<int>(turned * (kHalf / 2) + 0.5f) % kDirections;
  }
  /// The unit vector, of the angle itself, in the middle of a cell.
  static Vec2 middle(int cell);
};

/// The pixels under the kernel but for the one in its middle, for one direction. They come in pairs at equal distances on
/// either side, with equal weights; the first ones of the pairs are here.
struct KernelTaps {
  std::span<const std::int32_t> offset;  ///< in pixels of a row-major picture; the other one of the pair is at −offset
  std::span<const float> weight;         ///< but for the term of color, of which the pixel in the middle has 1
  float sum;                             ///< of the weights of all pixels, the one in the middle, too
};

/// The pixels of a kernel's variants for every direction.
class KernelTable {
 public:
  /// For pictures with `stride` pixels a row. O(variants · kDirections · reach²).
  KernelTable(const AnisotropicKernel& kernel, std::size_t stride);

  /// `choice` is not none.
  KernelTaps of(const KernelChoice& choice) const {
    const auto cell = static_cast<std::size_t>(choice.variant * DirectionCells::kDirections + choice.direction);
    const std::size_t first = first_[cell], count = first_[cell + 1] - first;
    return {std::span(offset_).subspan(first, count), std::span(weight_).subspan(first, count), sum_[cell]};
  }
  /// The most pairs that a choice has.
  std::size_t most_pairs() const;
  const kernel::FilterKernel& terms() const { return terms_; }

 private:
  kernel::FilterKernel terms_;
  std::vector<std::size_t> first_;  // by variant and direction
  std::vector<std::int32_t> offset_;
  std::vector<float> weight_, sum_;  // the latter by variant and direction, too
};

}  // namespace pelage
