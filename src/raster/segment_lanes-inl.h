// A bunch of segments, one per lane, on its walk along their major axes. Included once per instruction set.
#if defined(PELAGE_SEGMENT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGE_SEGMENT_LANES_INL_H_
#undef PELAGE_SEGMENT_LANES_INL_H_
#else
#define PELAGE_SEGMENT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "frame/frame.h"
#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

const wide::FloatTag kFloat{};
const wide::IntTag kInt{};
const wide::UintTag kUint{};

struct SegmentLanes {
  wide::RasterBand band;
  wide::Float column, last;            // current and last column; a lane with column > last is done
  wide::Float rows;                    // of the minor axis
  hn::Vec<wide::UintTag> column_step;  // pixels per column …
  hn::Vec<wide::UintTag> row_step;     // … and per row
  hn::Vec<wide::UintTag> origin;       // takes the high bits out of pixel indices (first_in_column)
  hn::Vec<wide::UintTag> id;
};

/// Segments j … j + lanes − 1 of the block, which cross columns whose points at `at` … `at_last` (0…1 from their lower
/// side) their bands may reach; false where none crosses any.
HWY_INLINE bool load_segments(const ScreenBlock& block, std::size_t j, int width, int height, float at, float at_last,
                              SegmentLanes& w) {
  const auto pair = [&](const Buffer<float>& a, const Buffer<float>& b, std::size_t i) {
    return wide::Vec2(wide::load(&a[i]), wide::load(&b[i]));
  };
  const std::size_t k = j + block.stride;
  w.id = hn::LoadU(kUint, &block.id[j]);
  w.band = wide::raster_band(pair(block.x, block.y, j), pair(block.x, block.y, k), wide::load(&block.radius[j]),
                             wide::load(&block.radius[k]), wide::load(&block.depth[j]), wide::load(&block.depth[k]),
                             pair(block.cap_x, block.cap_y, j), pair(block.cap_x, block.cap_y, k));
  const wide::Float w_pixels(static_cast<float>(width)), h_pixels(static_cast<float>(height));
  const wide::Float columns = select(w.band.x_major, w_pixels, h_pixels);
  w.rows = select(w.band.x_major, h_pixels, w_pixels);
  w.column = max(ceil(w.band.first - wide::Float(at_last)), wide::Float(0.0f));
  w.last = min(floor(w.band.last - wide::Float(at)), columns - wide::Float(1.0f));
  const auto x_major = hn::RebindMask(kUint, w.band.x_major.m);
  const auto one = hn::Set(kUint, 1), line = hn::Set(kUint, static_cast<std::uint32_t>(width));
  w.column_step = hn::IfThenElse(x_major, one, line);
  w.row_step = hn::IfThenElse(x_major, line, one);
  w.origin = hn::Set(kUint, 0u - 0x4b000000u * (static_cast<std::uint32_t>(width) + 1));
  const wide::Mask none{hn::RebindMask(wide::kFloatTag, hn::Eq(w.id, hn::Set(kUint, ScreenBlock::kNoSegment)))};
  const wide::Mask used{hn::FirstN(wide::kFloatTag, block.count - block.stride - j)};
  const wide::Mask drawn = used && !none && w.column <= w.last;
  w.last = select(drawn, w.last, wide::Float(-1.0f));
  return wide::any(drawn);
}

// Indices of pixels; those outside the image are anything. The low bits of n + 2^23 are n, which is cheaper than a conversion
// that looks after numbers that do not fit.
HWY_INLINE hn::Vec<wide::UintTag> steps(wide::Float n, hn::Vec<wide::UintTag> step) {
  return hn::Mul(hn::BitCast(wide::UintTag(), (n + wide::Float(8388608.0f)).v), step);
}
/// Of each lane's column, what pixel_in_column() asks for. Goes on by `column_step`.
HWY_INLINE hn::Vec<wide::UintTag> first_in_column(const SegmentLanes& w, wide::Float column) {
  return hn::Add(steps(column, w.column_step), w.origin);
}
HWY_INLINE hn::Vec<wide::UintTag> pixel_in_column(const SegmentLanes& w, hn::Vec<wide::UintTag> first, wide::Float row) {
  return hn::Add(first, steps(row, w.row_step));
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
