// The color term of the orientation-aware filter's kernel, which no table can hold.
#pragma once

#include <cstddef>
#include <vector>

#include "filter/kernel_taps.h"

namespace pelage {

/// Of the pixels of the pairs of a kernel.
struct ColorWeights {
  std::vector<float> before, after;  ///< of the one at −offset and at offset

  /// For up to `pairs` pairs.
  explicit ColorWeights(std::size_t pairs);
  /// Weight of a pair times exp(−Δ²/σ_c²) with the distance Δ in color from `here` to its pixels (the last factor of Huang
  /// 2025, eq. 11). Wide; the same bits on any instruction set.
  void weigh(const Vec4* here, const KernelTaps& taps, const kernel::FilterKernel& terms);
};

}  // namespace pelage
