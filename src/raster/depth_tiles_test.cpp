#include "raster/depth_tiles.h"

#include <gtest/gtest.h>

#include "frame/deferred.h"

namespace pelage {
namespace {

constexpr int kWidth = 40, kHeight = 20;  // 3 × 2 squares, the last ones cut

PixelKey key_at(std::uint32_t level) { return static_cast<PixelKey>(level) << 40; }

Buffer<PixelKey> keys_at(std::uint32_t level, std::size_t samples) {
  Buffer<PixelKey> keys(static_cast<std::size_t>(kWidth) * kHeight * samples);
  keys.fill(key_at(level));
  return keys;
}

TEST(DepthTiles, HideNothingBeforeTheyHaveSeenKeys) {
  const DepthTiles tiles(kWidth, kHeight);
  EXPECT_FALSE(tiles.hides({0, 0}, {1, 1}, 0xfffffe));
}

// One key that is farther than the rest keeps its square open as far as it is, and no other square.
TEST(DepthTiles, AreAsDeepAsTheirFarthestKey) {
  for (const std::size_t samples : {1u, 4u})
    for (const int x : {0, 15, 16, 39})
      for (const int y : {0, 15, 16, 19}) {
        Buffer<PixelKey> keys = keys_at(100, samples);
        keys[(static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)) * samples + samples - 1] = key_at(200);
        DepthTiles tiles(kWidth, kHeight);
        tiles.update(keys, samples);
        for (int column = 0; column < 3; ++column)
          for (int row = 0; row < 2; ++row) {
            const bool open = column == x / DepthTiles::kSide && row == y / DepthTiles::kSide;
            const Vec2 at(static_cast<float>(column * DepthTiles::kSide + 3), static_cast<float>(row * DepthTiles::kSide + 2));
            EXPECT_EQ(tiles.hides(at, at, 101), !open);
            EXPECT_EQ(tiles.hides(at, at, 200), !open) << "as deep as the farthest may win by its other bits";
            EXPECT_TRUE(tiles.hides(at, at, 201));
            EXPECT_FALSE(tiles.hides(at, at, 100));
          }
      }
}

// A box is hidden when all squares that it meets hide it; what lies beside the picture counts as its border.
TEST(DepthTiles, LookAtEverySquareOfABox) {
  Buffer<PixelKey> keys = keys_at(100, 1);
  keys[18 * kWidth + 35] = kEmptyPixel;
  DepthTiles tiles(kWidth, kHeight);
  tiles.update(keys, 1);
  EXPECT_TRUE(tiles.hides({0, 0}, {31.9f, 19}, 150));
  EXPECT_FALSE(tiles.hides({0, 0}, {32, 16}, 150));
  EXPECT_TRUE(tiles.hides({0, 0}, {32, 15.9f}, 150));
  EXPECT_FALSE(tiles.hides({-1e9f, -1e9f}, {1e9f, 1e9f}, 150));
  EXPECT_TRUE(tiles.hides({-1e9f, -1e9f}, {-5, -5}, 150));
  EXPECT_FALSE(tiles.hides({100, 100}, {200, 200}, 150));
}

}  // namespace
}  // namespace pelage
