// The pixels under the kernel of the orientation-aware filter, by the direction of the hair.
#pragma once

#include <pelage/vec.h>

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
  static constexpr int kDirections = 256;
  /// The cell of a vector other than 0.
  static int cell_of(Vec2 t);
  /// The unit vector in the middle of a cell.
  static Vec2 middle(int cell);
};

/// A pixel under the kernel.
struct KernelTap {
  std::int32_t offset;  ///< to it, in pixels of a row-major picture
  float weight;         ///< but for the term of color
};

/// All of a kernel's pixels for every direction, in the order of rows.
class KernelTaps {
 public:
  /// For pictures with `stride` pixels a row. O(kDirections · reach²).
  KernelTaps(const AnisotropicKernel& kernel, std::size_t stride);
  std::span<const KernelTap> of(Vec2 tangent) const {
    const auto cell = static_cast<std::size_t>(DirectionCells::cell_of(tangent));
    return std::span(taps_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }
  /// The most that a direction has.
  std::size_t most() const;
  const kernel::FilterKernel& terms() const { return terms_; }

 private:
  kernel::FilterKernel terms_;
  std::vector<std::size_t> first_;  // by cell
  std::vector<KernelTap> taps_;
};

}  // namespace pelage
