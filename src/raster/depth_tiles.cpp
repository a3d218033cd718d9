#include "raster/depth_tiles.h"

#include <algorithm>

#include "core/parallel.h"
#include "frame/deferred.h"

namespace pelage {
namespace {

std::size_t tiles_of(int pixels) {
  return (static_cast<std::size_t>(std::max(pixels, 1)) + DepthTiles::kSide - 1) / DepthTiles::kSide;
}

}  // namespace

DepthTiles::DepthTiles(int width, int height)
    : width_(width), height_(height), across_(tiles_of(width)), down_(tiles_of(height)),
      farthest_(across_ * down_, deferred::depth_level(kEmptyPixel)) {}

void DepthTiles::update(const Buffer<PixelKey>& keys, std::size_t samples) {
  parallel_for(down_, 1, [&](std::size_t begin, std::size_t end) {
    const std::size_t row_keys = static_cast<std::size_t>(width_) * samples, tile_keys = kSide * samples;
    std::vector<PixelKey> farthest(across_);
    for (std::size_t tile_row = begin; tile_row < end; ++tile_row) {
      std::fill(farthest.begin(), farthest.end(), 0);
      const std::size_t last = std::min((tile_row + 1) * kSide, static_cast<std::size_t>(height_));
      for (std::size_t y = tile_row * kSide; y < last; ++y)
        for (std::size_t tile = 0; tile < across_; ++tile) {
          const PixelKey* key = &keys[y * row_keys + tile * tile_keys];
          const std::size_t count = std::min(tile_keys, row_keys - tile * tile_keys);
          farthest[tile] = std::max(farthest[tile], *std::max_element(key, key + count));
        }
      for (std::size_t tile = 0; tile < across_; ++tile)
        farthest_[tile_row * across_ + tile] = deferred::depth_level(farthest[tile]);
    }
  });
}

bool DepthTiles::hides(Vec2 low, Vec2 high, std::uint32_t level) const {
  const auto tile = [](float pixel, int pixels) {
    return static_cast<std::size_t>(std::clamp(pixel, 0.f, static_cast<float>(std::max(pixels, 1) - 1))) / kSide;
  };
  const std::size_t left = tile(low.x, width_), right = tile(high.x, width_);
  for (std::size_t y = tile(low.y, height_); y <= tile(high.y, height_); ++y)
    for (std::size_t x = left; x <= right; ++x)
      if (farthest_[y * across_ + x] >= level) return false;
  return true;
}

}  // namespace pelage
