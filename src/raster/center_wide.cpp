// The center layer, a segment per lane.
//
// Two phases that a small buffer joins, because a hair is a fraction of a pixel wide: of the columns that a band crosses
// one in five or ten has its pixel's center covered. The walk finds those and compresses them into the buffer; the
// depth test then runs on full lanes, a gather of the high halves of the 64-bit keys, with every address known in time
// to be prefetched. Only what passes goes on to the atomic minimum.
#include "raster/fragments.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/center_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "raster/fragments-inl.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;
using Uints = hn::Vec<wide::UintTag>;

HWY_INLINE void append_visible(const SegmentLanes& w, Mask covered, Uints column_pixel, Float row, Float s, FragmentBuffer& f,
                               PixelKey* keys) {
  const SegmentKeys make;
  append_fragments(make, covered, pixel_in_column(w, column_pixel, row), make.rank(wide::raster_band_depth(w.band, s)),
                   make.id(w, s), f, keys);
}

/// One column of each lane: appends the covered rows. A thin band covers one at most, in some lanes and not in others: it is
/// appended without asking whether any lane has it, since with 4 or 8 lanes that branch cannot be predicted.
template <bool kThin>
HWY_INLINE void visit_column(const SegmentLanes& w, Float column, Uints column_pixel, FragmentBuffer& f, PixelKey* keys) {
  const wide::RasterBand& band = w.band;
  const Float half_pixel(0.5f);
  const Float u = column + half_pixel, s = u - band.u;
  const Float center = wide::raster_band_center(band, s), half = wide::raster_band_half(band, s);
  Float row = wide::raster_first_row(center, half, half_pixel);
  if (!kThin) row = max(row, Float(0.0f));
  Mask open = column <= w.last && wide::raster_row_covered(row, half_pixel, center, half) && row < w.rows;
  if (kThin) {
    open = open && row >= Float(0.0f) && wide::raster_between_caps(band, u, row + half_pixel);
    append_visible(w, open, column_pixel, row, s, f, keys);
    return;
  }
  while (wide::any(open)) {
    const Mask covered = open && wide::raster_between_caps(band, u, row + half_pixel);
    if (wide::any(covered)) append_visible(w, covered, column_pixel, row, s, f, keys);
    row = row + Float(1.0f);
    open = open && wide::raster_row_covered(row, half_pixel, center, half) && row < w.rows;
  }
}

void Center(const ScreenBlock& block, int width, int height, FragmentBuffer& f, PixelKey* keys) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  SegmentLanes w;
  for (std::size_t j = 0; j + block.stride < block.count; j += lanes) {
    if (!load_segments(block, j, width, height, 0.5f, 0.5f, w)) continue;
    const Float at_end = wide::raster_band_half(w.band, w.band.end_u - w.band.u);
    const bool thin = !wide::any(max(w.band.half, at_end) >= Float(0.49f));
    Float column = w.column;
    Uints column_pixel = first_in_column(w, column);
    do {
      if (thin) visit_column<true>(w, column, column_pixel, f, keys);
      else visit_column<false>(w, column, column_pixel, f, keys);
      column = column + Float(1.0f);
      column_pixel = hn::Add(column_pixel, w.column_step);
    } while (wide::any(column <= w.last));
  }
  flush_fragments(SegmentKeys(), f, keys);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Center);

void raster_center(const ScreenBlock& block, int width, int height, FragmentBuffer& fragments, PixelKey* keys) {
  HWY_DYNAMIC_DISPATCH(Center)(block, width, height, fragments, keys);
}

}  // namespace pelage
#endif
