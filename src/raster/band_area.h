// Exact area of a band inside the pixels that it touches.
#pragma once

#include "raster/band_walk.h"

namespace pelage {

/// The part of a pixel around its center (0, 0) that a convex clip leaves.
class PixelPolygon {
 public:
  /// Keeps a·x + b·y + c ≥ 0 (Sutherland & Hodgman 1974; references.bib: Sutherland1974Clipping).
  void clip(float a, float b, float c) {
    if (c >= 0.5f * (std::fabs(a) + std::fabs(b))) return;  // does not reach the pixel
    Vec2 kept[kMost];
    int count = 0;
    for (int i = 0; i < count_; ++i) {
      const Vec2 p = corners_[i], q = corners_[i + 1 < count_ ? i + 1 : 0];
      const float side_p = a * p.x + b * p.y + c, side_q = a * q.x + b * q.y + c;
      if (side_p >= 0) kept[count++] = p;
      if ((side_p >= 0) != (side_q >= 0)) kept[count++] = p + (q - p) * (side_p / (side_p - side_q));
    }
    count_ = count;
    std::copy(kept, kept + count, corners_);
  }
  bool empty() const { return count_ < 3; }
  float area() const {
    float twice = 0;
    for (int i = 1; i + 1 < count_; ++i) {
      const Vec2 p = corners_[i] - corners_[0], q = corners_[i + 1] - corners_[0];
      twice += p.x * q.y - p.y * q.x;
    }
    return 0.5f * std::fabs(twice);
  }

 private:
  static constexpr int kMost = 16;  // a square cut by six lines has at most ten corners
  Vec2 corners_[kMost] = {{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}};
  int count_ = 4;
};

/// The part of the pixel around (u, v) that the band covers; u, v along the band's major and minor axis.
inline PixelPolygon band_in_pixel(const kernel::RasterBand& band, float u, float v) {
  const float s = u - band.u;
  const float center = kernel::raster_band_center(band, s) - v, half = kernel::raster_band_half(band, s);
  PixelPolygon p;
  p.clip(band.slope + band.half_slope, -1, center + half);
  p.clip(-(band.slope - band.half_slope), 1, -(center - half));
  p.clip(band.cap_a.x, band.cap_a.y, kernel::raster_cap_side(band.cap_a, u, v, band.u, band.v));
  p.clip(-band.cap_b.x, -band.cap_b.y, -kernel::raster_cap_side(band.cap_b, u, v, band.end_u, band.end_v));
  p.clip(1, 0, u - band.first);
  p.clip(-1, 0, band.last - u);
  return p;
}

/// Which of 8 × 8 points of a pixel the band covers.
inline std::uint64_t band_mask(const kernel::RasterBand& band, const PixelSides& p) {
  std::uint64_t mask = 0;
  for (int i = 0; i < 64; ++i) {
    const float x = (static_cast<float>(i & 7) - 3.5f) / 8, y = (static_cast<float>(i >> 3) - 3.5f) / 8;
    const float o_u = band.x_major ? x : y, o_v = band.x_major ? y : x;
    if (kernel::raster_sample_covered(p.v - p.center, kernel::raster_sample_shift(band, o_u, o_v), p.half,
                                      kernel::raster_sample_growth(band, o_u)) &&
        kernel::raster_sample_between_caps(band, p.side_a, p.side_b, p.u, o_u, o_v))
      mask |= std::uint64_t{1} << i;
  }
  return mask;
}

/// Whether walk_centers() visits this pixel. Its roundings are its own, and what it covers has to count as touched.
inline bool covers_center(const kernel::RasterBand& band, const PixelSides& p) {
  const float column = p.u - 0.5f, row = p.v - 0.5f;
  return column >= std::ceil(band.first - 0.5f) && column <= std::floor(band.last - 0.5f) &&
         row >= kernel::raster_first_row(p.center, p.half, 0.5f) && kernel::raster_row_covered(row, 0.5f, p.center, p.half) &&
         kernel::raster_between_caps(band, p.u, p.v);
}

/// Calls emit(x, y, depth) for every pixel that the band touches: some part of it is covered, however small.
template <class Emit>
void walk_touched(const kernel::RasterBand& band, int width, int height, const Emit& emit) {
  walk_pixels(band, width, height, [&](int column, int row, const PixelSides& p) {
    const bool between_edges = p.whole && p.half >= 0.5f * std::fabs(band.half_slope);
    if (between_edges || !band_in_pixel(band, p.u, p.v).empty() || covers_center(band, p))
      emit(band.x_major ? column : row, band.x_major ? row : column, kernel::raster_band_depth(band, p.u - band.u));
  });
}

/// Calls emit(x, y, depth, area, PixelSides) for every pixel of which the band covers a part, 0 < area ≤ 1.
template <class Emit>
void walk_areas(const kernel::RasterBand& band, int width, int height, const Emit& emit) {
  walk_pixels(band, width, height, [&](int column, int row, const PixelSides& p) {
    const float area = p.whole ? kernel::raster_band_area(band, p.v, p.center, p.half) : band_in_pixel(band, p.u, p.v).area();
    if (area > 0)
      emit(band.x_major ? column : row, band.x_major ? row : column, kernel::raster_band_depth(band, p.u - band.u), area, p);
  });
}

}  // namespace pelage
