// Sets of pixels against sets of pairs.
#include "core/pixel_mask.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "core/rng.h"

namespace pelage {
namespace {

using Pixels = std::set<std::pair<int, int>>;  // y, x

Pixels pixels_of(const PixelMask& mask) {
  Pixels found;
  mask.for_each(0, static_cast<std::size_t>(mask.height()), [&](int x, int y) {
    EXPECT_TRUE(mask.contains(x, y));
    EXPECT_TRUE(found.insert({y, x}).second);
  });
  EXPECT_EQ(found.size(), mask.count());
  return found;
}

PixelMask random_mask(int width, int height, float share, std::uint32_t seed) {
  Rng rng(6, seed);
  PixelMask mask(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (rng.uniform() < share) mask.add(x, y);
  return mask;
}

TEST(PixelMask, HoldsWhatIsIn) {
  for (const int width : {0, 1, 63, 64, 65, 200}) {
    const PixelMask thirds(width, 5, [](std::size_t p) { return p % 3 == 0; });
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < width; ++x) EXPECT_EQ(thirds.contains(x, y), (y * width + x) % 3 == 0);
    for (const auto& [x, y] : {std::pair{-1, 0}, std::pair{width, 0}, std::pair{0, -1}, std::pair{0, 5}})
      EXPECT_FALSE(thirds.contains(x, y));
    pixels_of(thirds);
  }
}

TEST(PixelMask, GivesBitsOfARow) {
  PixelMask mask = random_mask(150, 3, 0.5f, 9);
  mask.remove(77, 1), mask.add(78, 1);
  EXPECT_TRUE(!mask.contains(77, 1) && mask.contains(78, 1));
  for (int y = -1; y <= 3; ++y)
    for (int x = -70; x < 160; ++x)
      for (const int count : {1, 5, 63, 64}) {
        const std::uint64_t bits = mask.bits(x, y, count);
        for (int i = 0; i < 64; ++i)
          ASSERT_EQ(bits >> i & 1, i < count && mask.contains(x + i, y)) << x << " " << y << " " << i;
      }
}

TEST(PixelMask, ShrinksToPixelsThatHaveAllAroundThem) {
  for (const int width : {1, 63, 64, 65, 130, 140})
    for (const int reach : {0, 1, 2, 5, 11}) {
      const PixelMask mask = random_mask(width, 19, 0.98f, static_cast<std::uint32_t>(width));
      Pixels expected;
      for (const auto& [y, x] : pixels_of(mask)) {
        bool all = true;
        for (int j = y - reach; j <= y + reach; ++j)
          for (int i = x - reach; i <= x + reach; ++i) all = all && mask.contains(i, j);
        if (all) expected.insert({y, x});
      }
      EXPECT_EQ(pixels_of(mask.shrunk(reach)), expected) << width << " " << reach;
    }
}

TEST(PixelMask, GrowsByPixelsInXAndY) {
  for (const int width : {1, 63, 64, 65, 130})
    for (const int reach : {0, 1, 2, 5}) {
      const PixelMask mask = random_mask(width, 19, 0.01f, static_cast<std::uint32_t>(width));
      Pixels expected;
      for (const auto& [y, x] : pixels_of(mask))
        for (int j = y - reach; j <= y + reach; ++j)
          for (int i = x - reach; i <= x + reach; ++i)
            if (i >= 0 && j >= 0 && i < width && j < 19) expected.insert({j, i});
      EXPECT_EQ(pixels_of(mask.grown(reach)), expected) << width << " " << reach;
    }
}

TEST(PixelMask, CombinesAsSetsDo) {
  const PixelMask a = random_mask(100, 7, 0.5f, 1), b = random_mask(100, 7, 0.5f, 2);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 100; ++x) {
      EXPECT_EQ(a.without(b).contains(x, y), a.contains(x, y) && !b.contains(x, y));
      EXPECT_EQ(a.united(b).contains(x, y), a.contains(x, y) || b.contains(x, y));
      EXPECT_EQ(a.intersected(b).contains(x, y), a.contains(x, y) && b.contains(x, y));
    }
}

TEST(PixelMask, HasTheBoxAroundItsPixels) {
  PixelMask mask(300, 20);
  const PixelBox none = mask.box();
  EXPECT_EQ(none.width(), 0);
  EXPECT_EQ(none.height(), 0);
  mask.add(70, 3), mask.add(191, 15), mask.add(64, 9);
  const PixelBox box = mask.box();
  EXPECT_EQ(box.left, 64);
  EXPECT_EQ(box.right, 192);
  EXPECT_EQ(box.top, 3);
  EXPECT_EQ(box.bottom, 16);
}

}  // namespace
}  // namespace pelage
