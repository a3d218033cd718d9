// One band, one point at a time: the plain walk over the pixels of a band that every fast rasterizer must agree with.
#pragma once

#include <algorithm>
#include <cmath>

#include "frame/frame.h"
#include "kernel/scalar.h"

namespace pelage {

/// The band of the segment that starts at point j of `block` (see kernel/raster/band.h).
inline kernel::RasterBand band_at(const ScreenBlock& block, std::size_t j) {
  return kernel::raster_band({block.x[j], block.y[j]}, {block.x[j + 1], block.y[j + 1]}, block.radius[j], block.radius[j + 1],
                             block.depth[j], block.depth[j + 1], {block.cap_x[j], block.cap_y[j]},
                             {block.cap_x[j + 1], block.cap_y[j + 1]});
}

/// Calls emit(x, y, depth) for every pixel of a width × height image whose center the band covers: a DDA along the major
/// axis, rows of the minor axis inside.
template <class Emit>
void walk_centers(const kernel::RasterBand& band, int width, int height, const Emit& emit) {
  const int columns = band.x_major ? width : height, rows = band.x_major ? height : width;
  const int first = static_cast<int>(std::max(std::ceil(band.first - 0.5f), 0.f));
  const int last = static_cast<int>(std::min(std::floor(band.last - 0.5f), static_cast<float>(columns - 1)));
  for (int column = first; column <= last; ++column) {
    const float u = static_cast<float>(column) + 0.5f, s = u - band.u;
    const float center = kernel::raster_band_center(band, s), half = kernel::raster_band_half(band, s);
    const float lowest = (center - half) - 0.5f;  // ceil() of it is raster_first_row()
    int row = static_cast<int>(lowest);
    row = std::max(row + (static_cast<float>(row) < lowest), 0);
    for (; row < rows && kernel::raster_row_covered(static_cast<float>(row), 0.5f, center, half); ++row)
      if (kernel::raster_between_caps(band, u, static_cast<float>(row) + 0.5f))
        emit(band.x_major ? column : row, band.x_major ? row : column, kernel::raster_band_depth(band, s));
  }
}

/// A pixel that a band may touch, along the band's axes.
struct PixelSides {
  float u, v;            ///< the pixel's center
  float center, half;    ///< of the band in this column
  float side_a, side_b;  ///< raster_cap_side() of the pixel's center
  bool whole;            ///< neither caps nor ends of the band cut the pixel
};

/// Calls visit(column, row, PixelSides) for every pixel of the image that the band may touch, all that it does touch
/// among them.
template <class Visit>
void walk_pixels(const kernel::RasterBand& band, int width, int height, const Visit& visit) {
  const int columns = band.x_major ? width : height, rows = band.x_major ? height : width;
  const int first = static_cast<int>(std::max(std::ceil(band.first - 1.f), 0.f));
  const int last = static_cast<int>(std::min(std::floor(band.last), static_cast<float>(columns - 1)));
  for (int column = first; column <= last; ++column) {
    PixelSides p;
    p.u = static_cast<float>(column) + 0.5f;
    p.center = kernel::raster_band_center(band, p.u - band.u), p.half = kernel::raster_band_half(band, p.u - band.u);
    const int lowest = static_cast<int>(std::max(kernel::raster_lowest_row(band, p.center, p.half), 0.f));
    const int highest =
        static_cast<int>(std::min(kernel::raster_highest_row(band, p.center, p.half), static_cast<float>(rows - 1)));
    for (int row = lowest; row <= highest; ++row) {
      p.v = static_cast<float>(row) + 0.5f;
      p.side_a = kernel::raster_cap_side(band.cap_a, p.u, p.v, band.u, band.v);
      p.side_b = kernel::raster_cap_side(band.cap_b, p.u, p.v, band.end_u, band.end_v);
      p.whole = kernel::raster_pixel_between_caps(band, p.side_a, p.side_b, p.u);
      visit(column, row, p);
    }
  }
}

/// Calls emit(x, y, depth, mask) for every pixel of which the band covers samples; bit i of `mask` stands for the
/// `count` ≤ 32 positions in turn.
template <class Emit>
void walk_samples(const kernel::RasterBand& band, int width, int height, const Vec2* positions, int count, const Emit& emit) {
  walk_pixels(band, width, height, [&](int column, int row, const PixelSides& p) {
    std::uint32_t mask = 0;
    for (int i = 0; i < count; ++i) {
      const float x = positions[i].x - 0.5f, y = positions[i].y - 0.5f;
      const float o_u = band.x_major ? x : y, o_v = band.x_major ? y : x;
      if (kernel::raster_sample_covered(p.v - p.center, kernel::raster_sample_shift(band, o_u, o_v), p.half,
                                        kernel::raster_sample_growth(band, o_u)) &&
          kernel::raster_sample_between_caps(band, p.side_a, p.side_b, p.u, o_u, o_v))
        mask |= std::uint32_t{1} << i;
    }
    if (mask != 0)
      emit(band.x_major ? column : row, band.x_major ? row : column, kernel::raster_band_depth(band, p.u - band.u), mask);
  });
}

}  // namespace pelage
