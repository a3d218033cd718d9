// The inner loops of the orientation-aware filter: one row of pixels.
#pragma once

#include <cstddef>

#include "core/buffer.h"
#include "filter/anisotropic.h"

namespace pelage {

/// The matte around its hair with a border of pixels without tangents, as wide as the kernel reaches, so that loops need no
/// ends. Rows have room for whole vectors.
struct FilterPlanes {
  static constexpr std::size_t kPadding = 64;
  int left = 0, top = 0;      ///< pixel of the matte that the first one inside the border is
  int width = 0, height = 0;  ///< without the border
  int reach = 0;              ///< of the border, pixels
  std::size_t stride = 0;
  Buffer<float> r, g, b, alpha, tangent_x, tangent_y;
  Buffer<float> weight;  ///< 1 where there is a tangent, else 0

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y + reach) * stride + static_cast<std::size_t>(x + reach);
  }
};

/// Filters row y: sums to r, g, b, alpha [width + kPadding], zero where there is no tangent. filter_row() runs on the active instruction
/// set; filter_row_scalar() is the reference of the tests, with the same bits.
struct FilterRow {
  float *r, *g, *b, *alpha;
};
void filter_row(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out);
void filter_row_scalar(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out);

}  // namespace pelage
