// The center layer, a segment per lane.
//
// Two phases that a small buffer joins, because a hair is a fraction of a pixel wide: of the columns that a band crosses
// one in five or ten has its pixel's center covered. The walk finds those and compresses them into the buffer; the
// depth test then runs on full lanes, a gather of the high halves of the 64-bit keys, with every address known in time
// to be prefetched. Only what passes goes on to the atomic minimum.
#include "raster/fragments.h"

#include <hwy/cache_control.h>

#include <algorithm>

#include "raster/keys.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/center_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "raster/compress-inl.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;
using Ints = hn::Vec<wide::IntTag>;
using Uints = hn::Vec<wide::UintTag>;

/// Bit l of the result tells whether fragment l may pass the depth test of its key as it is now.
HWY_INLINE std::uint64_t passing(const std::uint32_t* pixel, const float* depth, const PixelKey* keys) {
  std::uint64_t bits = 0;
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  for (std::size_t l = 0; l < hn::Lanes(kUint); ++l) {
    const PixelKey now = __atomic_load_n(keys + pixel[l], __ATOMIC_RELAXED);
    bits |= std::uint64_t{now >= pixel_key(depth[l], 0)} << l;
  }
#else
  // Keys may change under the gather. A stale half is larger than the present one, and only lets more through.
  const Ints index = hn::BitCast(kInt, hn::Add(hn::ShiftLeft<1>(hn::LoadU(kUint, pixel)), hn::Set(kUint, 1)));
  const Uints current = hn::GatherIndex(kUint, reinterpret_cast<const std::uint32_t*>(keys), index);
  const auto behind = hn::Lt(current, hn::BitCast(kUint, hn::LoadU(kFloat, depth)));
  hn::StoreMaskBits(kUint, hn::Not(behind), reinterpret_cast<std::uint8_t*>(&bits));
#endif
  return bits;
}

/// Depth test and atomic minimum of everything in the buffer, which is empty afterwards.
void Flush(FragmentBuffer& f, PixelKey* keys) {
  const std::size_t lanes = hn::Lanes(kUint), count = f.count, ahead = FragmentBuffer::kPadding - lanes;
  std::fill(&f.pixel[count], &f.pixel[count] + FragmentBuffer::kPadding, 0u);
  for (std::size_t i = 0; i < count && i < ahead; ++i) hwy::Prefetch(keys + f.pixel[i]);
  for (std::size_t i = 0; i < count; i += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) hwy::Prefetch(keys + f.pixel[i + ahead + l]);
    const std::uint64_t used = count - i < lanes ? (std::uint64_t{1} << (count - i)) - 1 : ~std::uint64_t{0};
    for (std::uint64_t bits = passing(&f.pixel[i], &f.depth[i], keys) & used; bits != 0; bits &= bits - 1) {
      const std::size_t l = i + static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
      atomic_min(keys[f.pixel[l]], pixel_key(f.depth[l], f.id[l]));
    }
  }
  f.count = 0;
}

HWY_INLINE void append(FragmentBuffer& f, Mask m, Uints pixel, Float depth, Uints id) {
  const Compressor compress(m);
  hn::StoreU(compress(pixel), kUint, &f.pixel[f.count]);
  hn::StoreU(compress(depth.v), kFloat, &f.depth[f.count]);
  hn::StoreU(compress(id), kUint, &f.id[f.count]);
  f.count += compress.count();
}

HWY_INLINE void append_visible(const SegmentLanes& w, Mask covered, Uints column_pixel, Float row, Float s, FragmentBuffer& f,
                               PixelKey* keys) {
  if (f.count + hn::Lanes(kUint) > FragmentBuffer::kCapacity) Flush(f, keys);
  append(f, covered, pixel_in_column(w, column_pixel, row), wide::raster_band_depth(w.band, s), w.id);
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
  for (std::size_t j = 0; j + 1 < block.count; j += lanes) {
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
  Flush(f, keys);
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
