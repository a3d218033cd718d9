// The fast coverage layer, a segment per lane: parts of segments inside pixels, by lane, for raster/coverage.cpp to add up.
#include "raster/coverage.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/coverage_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;

/// Segments that may reach a pixel that is not full. Those that reach farther than the next tile always may.
Mask reaching_open(const ScreenBlock& block, std::size_t j, const FullTiles& tiles) {
  const Float x = wide::load(&block.x[j]), y = wide::load(&block.y[j]), x1 = wide::load(&block.x[j + 1]),
              y1 = wide::load(&block.y[j + 1]);
  const Float radius = max(wide::load(&block.radius[j]), wide::load(&block.radius[j + 1]));
  const Float reach = max(abs(x1 - x), abs(y1 - y)) + radius * Float(1.5f) + Float(1.0f);
  const Float tile_x = floor(x * Float(1.0f / FullTiles::kSide)), tile_y = floor(y * Float(1.0f / FullTiles::kSide));
  const Float across(static_cast<float>(tiles.across())), down(static_cast<float>(tiles.down()));
  const Mask known = reach < Float(static_cast<float>(FullTiles::kSide)) && tile_x >= Float(0.0f) && tile_y >= Float(0.0f) &&
                     tile_x < across && tile_y < down;
  const auto index = hn::ConvertTo(kInt, select(known, tile_y * across + tile_x, Float(0.0f)).v);
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  HWY_ALIGN std::int32_t at[hn::MaxLanes(wide::IntTag())], deep[hn::MaxLanes(wide::IntTag())];
  hn::Store(index, kInt, at);
  for (std::size_t l = 0; l < hn::Lanes(kInt); ++l) deep[l] = tiles.deep_at(at[l]);
  const auto flags = hn::Load(kInt, deep);
#else
  const auto flags = hn::GatherIndex(kInt, tiles.deep(), index);
#endif
  const Mask deep_lanes{hn::RebindMask(kFloat, hn::Ne(flags, hn::Zero(kInt)))};
  return !(known && deep_lanes);
}

/// Appends the lanes of `used` to their lists, those whose pixels are not full yet.
void append(const SegmentLanes& w, Mask used, Float column, Float row, Float area, Float depth, const GBuffer& out,
            CoverageScratch& scratch) {
  HWY_ALIGN float areas[hn::MaxLanes(wide::FloatTag())], depths[hn::MaxLanes(wide::FloatTag())];
  HWY_ALIGN std::uint32_t pixels[hn::MaxLanes(wide::UintTag())];
  hn::Store(area.v, kFloat, areas);
  hn::Store(depth.v, kFloat, depths);
  hn::Store(pixel_in_column(w, first_in_column(w, column), row), kUint, pixels);
  std::uint64_t bits = 0;
  hn::StoreMaskBits(kFloat, used.m, reinterpret_cast<std::uint8_t*>(&bits));
  for (; bits != 0; bits &= bits - 1) {
    const std::size_t l = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    if (std::atomic_ref(out.coverage[pixels[l]]).load(std::memory_order_relaxed) >= kFullDepth) continue;
    scratch.lanes[l].push_back({pixels[l], areas[l], depths[l]});
  }
}

/// One column of each lane, as far as its segment crosses it.
HWY_INLINE void visit_column(const SegmentLanes& w, Mask drawn, Float column, const GBuffer& out, CoverageScratch& scratch) {
  const wide::RasterBand& band = w.band;
  const Float from = max(column, min(band.u, band.end_u)), to = min(column + Float(1.0f), max(band.u, band.end_u));
  const Float share = to - from;
  const Float s = (from + to) * Float(0.5f) - band.u;
  const Float center = wide::raster_band_center(band, s), half = wide::raster_band_half(band, s);
  const Float spread = half + (abs(band.slope) + abs(band.half_slope)) * Float(0.5f) * share;
  Float row = max(floor(center - spread), Float(0.0f));
  const Float last = min(floor(center + spread), w.rows - Float(1.0f));
  Mask open = drawn && column <= w.last && share > Float(0.0f) && row <= last;
  while (wide::any(open)) {
    const Float area = wide::raster_band_area_part(band, row + Float(0.5f), center, half, share);
    const Mask covered = open && area > Float(0.0f);
    if (wide::any(covered)) append(w, covered, column, row, area, wide::raster_band_depth(band, s), out, scratch);
    row = row + Float(1.0f);
    open = open && row <= last;
  }
}

void Coverage(const ScreenBlock& block, CoverageScratch& scratch, FullTiles& tiles, GBuffer& out) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  SegmentLanes w;
  for (std::size_t j = 0; j < block.count; j += lanes) {
    const Mask reaching = reaching_open(block, j, tiles);
    if (wide::any(reaching) && load_segments(block, j, out.width, out.height, 0.0f, 1.0f, w)) {
      Float column = w.column;
      do {
        visit_column(w, reaching, column, out, scratch);
        column = column + Float(1.0f);
      } while (wide::any(reaching && column <= w.last));
    }
    add_fragments(block, j, lanes, scratch, tiles, out);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Coverage);

void raster_coverage(const ScreenBlock& block, CoverageScratch& scratch, FullTiles& tiles, GBuffer& out) {
  HWY_DYNAMIC_DISPATCH(Coverage)(block, scratch, tiles, out);
}

}  // namespace pelage
#endif
