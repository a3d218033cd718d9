// The color term of the orientation-aware filter's kernel, which no table can hold.
#pragma once

#include <cstddef>
#include <span>

#include "filter/kernel_taps.h"

namespace pelage {

/// Floats that `weights` of color_weights() needs beyond the number of taps.
inline constexpr std::size_t kColorWeightPadding = 64;

/// weights[i] = weight of tap i times exp(−Δ²/σ_c²) with the distance Δ in color from `here` to its pixel (the last factor of
/// Huang 2025, eq. 11). Wide; the same bits on any instruction set.
void color_weights(const MattePixel* here, std::span<const KernelTap> taps, const kernel::FilterKernel& terms,
                   std::span<float> weights);

}  // namespace pelage
