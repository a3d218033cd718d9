#include "raster/coverage.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pelage {
namespace {

constexpr float kMostArea = 0.99999f;

/// Whether something at `depth` is behind all samples of a pixel.
bool hidden(const GBuffer& out, std::size_t pixel, float depth) {
  if (out.opaque_depth.empty()) return false;
  const std::size_t samples = static_cast<std::size_t>(out.samples);
  const float* opaque = &out.opaque_depth[pixel * samples];
  return std::all_of(opaque, opaque + samples, [&](float z) { return z < depth; });
}

}  // namespace

FullTiles::FullTiles(int width, int height, const PixelMask* full)
    : across_((width + kSide - 1) / kSide), down_((height + kSide - 1) / kSide),
      open_(std::make_unique<std::atomic<std::uint8_t>[]>(static_cast<std::size_t>(across_ * down_))),
      deep_(std::make_unique<std::int32_t[]>(static_cast<std::size_t>(across_ * down_))) {
  const auto count_full = [&](int x, int y) {
    int count = 0;
    for (int j = y * kSide; full && j < std::min(height, (y + 1) * kSide); ++j)
      count += std::popcount(full->bits(x * kSide, j, kSide));
    return count;
  };
  for (int y = 0; y < down_; ++y)
    for (int x = 0; x < across_; ++x) {
      const int pixels = std::min(kSide, width - x * kSide) * std::min(kSide, height - y * kSide);
      open_[static_cast<std::size_t>(y * across_ + x)] = static_cast<std::uint8_t>(pixels - count_full(x, y));
    }
  for (int y = 0; full && y < down_; ++y)
    for (int x = 0; x < across_; ++x) deep_[static_cast<std::size_t>(y * across_ + x)] = full_with_neighbors(x, y);
}

bool FullTiles::full_with_neighbors(int tile_x, int tile_y) const {
  bool deep = true;
  for (int n = 0; n < 9; ++n) deep = deep && full(tile_x + n % 3 - 1, tile_y + n / 3 - 1);
  return deep;
}

bool FullTiles::full(int tile_x, int tile_y) const {
  if (tile_x < 0 || tile_y < 0 || tile_x >= across_ || tile_y >= down_) return true;
  return open_[static_cast<std::size_t>(tile_y * across_ + tile_x)].load() == 0;
}

void FullTiles::fill_pixel(int x, int y) {
  const int tile_x = x / kSide, tile_y = y / kSide;
  if (open_[static_cast<std::size_t>(tile_y * across_ + tile_x)].fetch_sub(1) != 1) return;
  for (int j = tile_y - 1; j <= tile_y + 1; ++j)
    for (int i = tile_x - 1; i <= tile_x + 1; ++i) {
      if (i < 0 || j < 0 || i >= across_ || j >= down_) continue;
      if (full_with_neighbors(i, j))
        std::atomic_ref(deep_[static_cast<std::size_t>(j * across_ + i)]).store(1, std::memory_order_relaxed);
    }
}

void StrandSums::add(const CoverageFragment& f, std::uint32_t segment) {
  for (Visit& visit : visits_)
    if (visit.pixel == f.pixel) {
      visit.area += f.area, visit.segment = segment;
      return;
    }
  visits_.push_back({f.pixel, segment, f.area});
}

void StrandSums::leave(std::uint32_t segment, FullTiles& tiles, GBuffer& out) {
  std::size_t kept = 0;
  for (const Visit& visit : visits_) {
    if (visit.segment == segment) {
      visits_[kept++] = visit;
      continue;
    }
    const float depth = -std::log1p(-std::min(visit.area, kMostArea));
    const auto units = static_cast<std::uint32_t>(depth / GBuffer::kCoverageUnit + 0.5f);
    const std::atomic_ref<std::uint32_t> sum(out.coverage[visit.pixel]);
    if (sum.load(std::memory_order_relaxed) >= kFullDepth) continue;
    const std::uint32_t before = sum.fetch_add(units, std::memory_order_relaxed);
    if (before < kFullDepth && before + units >= kFullDepth) {
      const auto width = static_cast<std::uint32_t>(out.width);
      tiles.fill_pixel(static_cast<int>(visit.pixel % width), static_cast<int>(visit.pixel / width));
    }
  }
  visits_.resize(kept);
}

void add_fragments(const ScreenBlock& block, std::size_t j, std::size_t lanes, CoverageScratch& scratch, FullTiles& tiles,
                   GBuffer& out) {
  for (std::size_t l = 0; l < lanes && j + l < block.count; ++l) {
    const auto segment = static_cast<std::uint32_t>(j + l);
    for (const CoverageFragment& f : scratch.lanes[l])
      if (!hidden(out, f.pixel, f.depth)) scratch.sums.add(f, segment);
    scratch.lanes[l].clear();
    scratch.sums.leave(block.id[j + l] == ScreenBlock::kNoSegment ? StrandSums::kEnd : segment, tiles, out);
  }
}

}  // namespace pelage
