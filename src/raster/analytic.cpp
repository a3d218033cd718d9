#include "raster/analytic.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "raster/band_area.h"
#include "raster/band_walk.h"

namespace pelage {

StrandAreas::StrandAreas() : entries_(1024) {}

std::size_t StrandAreas::find(std::uint32_t pixel) const {
  std::size_t slot = (pixel * 2654435769u) & (entries_.size() - 1);  // Knuth's multiplicative hash
  while (entries_[slot].pixel != pixel && entries_[slot].pixel != kFree) slot = (slot + 1) & (entries_.size() - 1);
  return slot;
}

void StrandAreas::grow() {
  std::vector<Entry> old(entries_.size() * 2);
  old.swap(entries_);
  for (std::uint32_t& slot : used_) {
    const std::size_t moved = find(old[slot].pixel);
    entries_[moved] = old[slot];
    slot = static_cast<std::uint32_t>(moved);
  }
}

void StrandAreas::add(std::uint32_t pixel, std::uint32_t segment, float area, std::uint64_t mask, float cos2, float sin2) {
  std::size_t slot = find(pixel);
  if (entries_[slot].pixel == kFree) {
    if (2 * used_.size() >= entries_.size()) {
      grow();
      slot = find(pixel);
    }
    entries_[slot].pixel = pixel;
    used_.push_back(static_cast<std::uint32_t>(slot));
  }
  Entry& e = entries_[slot];
  if (segment > e.segment + 1) e.end_visit();
  e.segment = segment, e.area += area, e.mask |= mask, e.cos2 += area * cos2, e.sin2 += area * sin2;
}

void StrandAreas::Entry::end_visit() {
  area = std::min(area, 1.f);
  const bool masked = mask != 0 && covered_mask != 0;
  const float overlap = masked ? static_cast<float>(std::popcount(mask & covered_mask)) / 64 : area * covered;
  covered = std::clamp(covered + area - overlap, std::max(area, covered), 1.f);
  covered_mask |= mask;
  area = 0, mask = 0;
}

namespace {

constexpr std::uint32_t kOpaque = 0x80000000u;  // optical depth beyond which nothing is seen through

void add_strand(StrandAreas& areas, GBuffer& out) {
  areas.drain([&](const StrandAreas::Entry& e) {
    const float depth = e.covered < 1 ? std::min(-std::log1p(-e.covered), kMaxStrandDepth) : kMaxStrandDepth;
    const std::atomic_ref<std::uint32_t> sum(out.coverage[e.pixel]);
    if (sum.load(std::memory_order_relaxed) < kOpaque)
      sum.fetch_add(static_cast<std::uint32_t>(depth / GBuffer::kCoverageUnit + 0.5f), std::memory_order_relaxed);
    const auto add = [&](Buffer<std::int32_t>& layer, float value) {
      std::atomic_ref(layer[e.pixel])
          .fetch_add(static_cast<std::int32_t>(std::lround(value / kAreaUnit)), std::memory_order_relaxed);
    };
    add(out.tangent_cos2, e.cos2), add(out.tangent_sin2, e.sin2);
  });
}

/// Share of a pixel's samples before which `depth` lies.
float visible_share(const GBuffer& out, std::size_t pixel, float depth) {
  if (out.opaque_depth.empty()) return 1;
  const std::size_t samples = static_cast<std::size_t>(out.samples);
  const float* opaque = &out.opaque_depth[pixel * samples];
  const auto seen = std::count_if(opaque, opaque + samples, [&](float z) { return depth <= z; });
  return static_cast<float>(seen) / static_cast<float>(samples);
}

}  // namespace

void raster_analytic(const ScreenBlock& block, StrandAreas& areas, GBuffer& out) {
  const std::size_t width = static_cast<std::size_t>(out.width);
  for (std::size_t j = 0; j < block.count; ++j) {
    if (block.id[j] == ScreenBlock::kNoSegment) {
      add_strand(areas, out);
      continue;
    }
    const Vec2 d(block.x[j + 1] - block.x[j], block.y[j + 1] - block.y[j]);
    const float square = dot(d, d);
    if (!(square > 0)) continue;
    const float cos2 = (d.x * d.x - d.y * d.y) / square, sin2 = 2 * d.x * d.y / square;
    const kernel::RasterBand band = band_at(block, j);
    const bool wide = block.radius[j] >= kMaskRadius;
    walk_areas(band, out.width, out.height, [&](int x, int y, float depth, float area, const PixelSides& p) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      const float seen = area * visible_share(out, pixel, depth);
      if (seen > 0)
        areas.add(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(j), seen, wide ? band_mask(band, p) : 0, cos2,
                  sin2);
    });
  }
}

}  // namespace pelage
