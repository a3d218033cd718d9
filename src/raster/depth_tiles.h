// How deep the hair of a part of the picture is at most, so that what lies behind need not be drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// The farthest depth among the keys of each square of kSide × kSide pixels, as it was at the last update. Keys only come nearer, so
/// what lies behind all of a square then is hidden from then on.
class DepthTiles {
 public:
  static constexpr int kSide = 16;

  /// Hides nothing before the first update.
  DepthTiles(int width, int height);

  /// Looks at the keys, [height · width · samples], which nobody may write meanwhile. O(keys), in parallel.
  void update(const Buffer<PixelKey>& keys, std::size_t samples);

  /// Whether strands that stay within low … high (pixels, any) and are nowhere nearer than `level` (24 bits) change no key.
  /// O(squares that they meet).
  bool hides(Vec2 low, Vec2 high, std::uint32_t level) const;

 private:
  int width_, height_;
  std::size_t across_, down_;
  std::vector<std::uint32_t> farthest_;  // [down · across] levels
};

}  // namespace pelage
