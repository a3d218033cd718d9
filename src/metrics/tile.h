// Filters of a picture, tile by tile: a tile and the pixels around it fit in a core's cache, and tiles are independent.
#pragma once

#include <pelage/image.h>

#include <algorithm>
#include <span>
#include <vector>

#include "core/parallel.h"

namespace pelage::metrics {

struct Tile {
  int x = 0, y = 0, width = 0, height = 0;  ///< pixels of the picture
};

constexpr int kTileWidth = 256, kTileHeight = 64;

/// Calls body(tile) for tiles that cover width × height, in parallel. The tiles are the same for any number of threads.
template <class Body>
void for_each_tile(int width, int height, const Body& body) {
  const int columns = (width + kTileWidth - 1) / kTileWidth, rows = (height + kTileHeight - 1) / kTileHeight;
  parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const int x = static_cast<int>(i) % columns * kTileWidth, y = static_cast<int>(i) / columns * kTileHeight;
      body(Tile{x, y, std::min(kTileWidth, width - x), std::min(kTileHeight, height - y)});
    }
  });
}

/// Numbers of a rectangle of pixels, row by row.
struct Block {
  int width = 0, height = 0;
  std::vector<float> values;

  Block() = default;
  Block(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};

/// Channel `channel` of the tile and of `radius` pixels around it; beyond the picture its edge goes on.
Block gather(const Image& image, std::size_t channel, const Tile& tile, int radius);

/// out(x, y) = Σ_k taps[k] in(x + k, y), and the same down columns: smaller by taps − 1 in that direction.
Block convolve_rows(const Block& in, std::span<const float> taps);
Block convolve_columns(const Block& in, std::span<const float> taps);
/// Rows by `horizontal`, then columns by `vertical`.
Block convolve(const Block& in, std::span<const float> horizontal, std::span<const float> vertical);

/// `in` without `margin` pixels on every side.
Block crop(const Block& in, int margin);

}  // namespace pelage::metrics
