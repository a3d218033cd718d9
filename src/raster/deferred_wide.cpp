// The two layers of deferred software rasterization in one walk, a segment per lane (Lipp 2026, §3.1.2).
//
// Columns of a segment are walked once. In each, the rows that the band touches are those between the lowest and the highest
// place of its edges; a thin strand touches one or two. The center layer takes those of them whose center the band covers.
#include "raster/fragments.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/deferred_wide.cpp"
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

/// Where the fragments of a walk go; without the conservative layer it is null.
struct Layers {
  DeferredKeys make;
  FragmentBuffer& fragments;
  PixelKey *center, *conservative;
};

/// One column of each lane: the rows that the band touches, or whose center it covers.
template <bool kConservative>
HWY_INLINE void visit_column(const SegmentLanes& w, Float column, Mask on_band, const wide::Vec2 touched_columns,
                             const Layers& layers) {
  const wide::RasterBand& band = w.band;
  const Float half_pixel(0.5f), u = column + half_pixel, s = u - band.u;
  const Float center = wide::raster_band_center(band, s), half = wide::raster_band_half(band, s);
  const Mask beside = on_band && column >= touched_columns.x && column <= touched_columns.y;
  const wide::Vec2 touched = wide::raster_touched_rows(band, column);
  Float row = wide::raster_first_row(center, half, half_pixel), highest = floor(center + half - half_pixel);
  if (kConservative) row = select(beside, min(row, touched.x), row), highest = select(beside, max(highest, touched.y), highest);
  row = max(row, Float(0.0f)), highest = min(highest, w.rows - Float(1.0f));
  Mask open = on_band && row <= highest;
  if (!wide::any(open)) return;
  const Uints rank = layers.make.rank(wide::raster_band_depth(band, s)), id = layers.make.id(w, s);
  const Uints first = first_in_column(w, column);
  do {
    const Uints pixel = pixel_in_column(w, first, row);
    const Mask covered = open && row >= wide::raster_first_row(center, half, half_pixel) &&
                         wide::raster_row_covered(row, half_pixel, center, half) &&
                         wide::raster_between_caps(band, u, row + half_pixel) && wide::raster_between_ends(band, u);
    if (kConservative) {
      const Mask taken = covered || (open && beside && row >= touched.x && row <= touched.y);
      const Uints flag = hn::IfThenElseZero(hn::RebindMask(kUint, covered.m), hn::Set(kUint, kCoversCenter));
      if (is_full(layers.fragments)) flush_both(layers.make, layers.fragments, layers.center, layers.conservative);
      append(taken, pixel, rank, hn::Or(id, flag), layers.fragments);
    } else if (wide::any(covered)) {
      append_fragments(layers.make, covered, pixel, rank, id, layers.fragments, layers.center);
    }
    row = row + Float(1.0f);
    open = open && row <= highest;
  } while (wide::any(open));
}

template <bool kConservative>
void walk_block(const ScreenBlock& block, int width, int height, const Layers& layers) {
  SegmentLanes w;
  for (std::size_t j = 0; j + block.stride < block.count; j += hn::Lanes(kUint)) {
    // Without the conservative layer only columns whose center lies beside the band.
    const float at = kConservative ? 0.0f : 0.5f, at_last = kConservative ? 1.0f : 0.5f;
    if (!load_segments(block, j, width, height, at, at_last, w)) continue;
    const wide::Vec2 touched_columns = wide::raster_touched_columns(w.band);
    Float column = w.column;
    do {
      visit_column<kConservative>(w, column, column <= w.last, touched_columns, layers);
      column = column + Float(1.0f);
    } while (wide::any(column <= w.last));
  }
}

void Deferred(const ScreenBlock& block, const DepthRange& range, int width, int height, FragmentBuffer& fragments,
              PixelKey* center, PixelKey* conservative) {
  const Layers layers{deferred_keys(block, range), fragments, center, conservative};
  if (!conservative) {
    walk_block<false>(block, width, height, layers);
    return flush_fragments(layers.make, fragments, center);
  }
  walk_block<true>(block, width, height, layers);
  flush_both(layers.make, fragments, center, conservative);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Deferred);

void raster_deferred(const ScreenBlock& block, const DepthRange& range, int width, int height, FragmentBuffer& fragments,
                     PixelKey* center, PixelKey* conservative) {
  HWY_DYNAMIC_DISPATCH(Deferred)(block, range, width, height, fragments, center, conservative);
}

}  // namespace pelage
#endif
