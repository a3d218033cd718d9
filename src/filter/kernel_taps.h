// The pixels under the kernel of the orientation-aware filter, by the direction of the hair.
#pragma once

#include <pelage/vec.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/anisotropic.h"
#include "kernel/scalar.h"

namespace pelage {

/// Directions without a sign, in kDirections cells; what lies in a cell takes the direction of its middle, at most 0.45° off.
/// Cells are even in the share of x in |x| + |y|, which needs no arc tangent; the axes and diagonals are middles.
struct DirectionCells {
  static constexpr int kQuadrant = 128, kDirections = 2 * kQuadrant;  ///< cells of 90° and of 180°
  /// The cell of a vector other than 0.
  static int cell_of(Vec2 t) {
    // Turned into the half plane y ≥ 0: from (1, 0) over (0, 1) to (−1, 0).
    const float x = t.y < 0 ? -t.x : t.x, y = std::fabs(t.y);
    const float share = x / (std::fabs(x) + y);  // 1 … −1
    return static_cast<int>((1 - share) * kQuadrant + 0.5f) % kDirections;
  }
  /// The unit vector in the middle of a cell.
  static Vec2 middle(int cell);
};

/// The pixels under the kernel but for the one in its middle, for one direction. They come in pairs at equal distances on
/// either side, with equal weights; the first ones of the pairs are here.
struct KernelTaps {
  std::span<const std::int32_t> offset;  ///< in pixels of a row-major picture; the other one of the pair is at −offset
  std::span<const float> weight;         ///< but for the term of color, of which the pixel in the middle has 1
};

/// A kernel's pixels for every direction.
class KernelTable {
 public:
  /// For pictures with `stride` pixels a row. O(kDirections · reach²).
  KernelTable(const AnisotropicKernel& kernel, std::size_t stride);

  KernelTaps along(Vec2 tangent) const {
    const auto cell = static_cast<std::size_t>(DirectionCells::cell_of(tangent));
    const std::size_t first = first_[cell], count = first_[cell + 1] - first;
    return {std::span(offset_).subspan(first, count), std::span(weight_).subspan(first, count)};
  }
  /// The most pairs that a direction has.
  std::size_t most_pairs() const;
  const kernel::FilterKernel& terms() const { return terms_; }
  /// Whether all weights are 1.
  bool flat() const { return flat_; }

 private:
  kernel::FilterKernel terms_;
  bool flat_;
  std::vector<std::size_t> first_;  // by cell
  std::vector<std::int32_t> offset_;
  std::vector<float> weight_;
};

}  // namespace pelage
