// One band, one point at a time: the plain walk over the pixels of a band that every fast rasterizer must agree with.
#pragma once

#include <algorithm>

#include "frame/frame.h"
#include "kernel/scalar.h"

namespace pelage {

/// The band of the segment that starts at point j of `block` (see kernel/raster/band.h).
inline kernel::RasterBand band_at(const ScreenBlock& block, std::size_t j) {
  return kernel::raster_band({block.x[j], block.y[j]}, {block.x[j + 1], block.y[j + 1]}, block.radius[j],
                             block.radius[j + 1], block.depth[j], block.depth[j + 1], {block.cap_x[j], block.cap_y[j]},
                             {block.cap_x[j + 1], block.cap_y[j + 1]});
}

/// Calls emit(x, y, depth) for every pixel of a width × height image whose point at `at` (from the pixel's top left
/// corner, 0…1) the band covers: a DDA along the major axis, rows of the minor axis inside.
template <class Emit>
void walk_band(const kernel::RasterBand& band, int width, int height, Vec2 at, const Emit& emit) {
  const float at_u = band.x_major ? at.x : at.y, at_v = band.x_major ? at.y : at.x;
  const int columns = band.x_major ? width : height, rows = band.x_major ? height : width;
  const int first = static_cast<int>(std::max(std::ceil(band.first - at_u), 0.f));
  const int last = static_cast<int>(std::min(std::floor(band.last - at_u), static_cast<float>(columns - 1)));
  for (int column = first; column <= last; ++column) {
    const float u = static_cast<float>(column) + at_u, s = u - band.u;
    const float center = kernel::raster_band_center(band, s), half = kernel::raster_band_half(band, s);
    const float lowest = (center - half) - at_v;  // ceil() of it is raster_first_row()
    int row = static_cast<int>(lowest);
    row = std::max(row + (static_cast<float>(row) < lowest), 0);
    for (; row < rows && kernel::raster_row_covered(static_cast<float>(row), at_v, center, half); ++row)
      if (kernel::raster_between_caps(band, u, static_cast<float>(row) + at_v))
        emit(band.x_major ? column : row, band.x_major ? row : column, kernel::raster_band_depth(band, s));
  }
}

}  // namespace pelage
