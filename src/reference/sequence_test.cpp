#include "reference/sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace pelage {
namespace {

// 256 samples: one in every 256th of each dimension, and one in every box of the four first pairs' grids of 16 × 16, in the
// dimensions that are Sobol's first two.
TEST(Sequence, FirstDimensionsAreStratified) {
  for (const std::uint32_t pixel : {0u, 77u, 123456u}) {
    std::array<std::set<int>, 12> seen;
    std::set<int> boxes;
    for (std::uint32_t i = 0; i < 256; ++i) {
      Sequence s(3, pixel, i);
      for (std::size_t block = 0; block < 3; ++block) {
        const std::array<float, 4> u = s.next();
        for (std::size_t d = 0; d < 4; ++d) seen[4 * block + d].insert(static_cast<int>(u[d] * 256));
        if (block == 1) boxes.insert(static_cast<int>(u[0] * 16) * 16 + static_cast<int>(u[1] * 16));
      }
    }
    for (const std::set<int>& s : seen) EXPECT_EQ(s.size(), 256u);
    EXPECT_EQ(boxes.size(), 256u);
  }
}

// Every sample by itself is uniform over seeds; blocks, pixels and seeds do not go together.
TEST(Sequence, UniformAndUncorrelated) {
  constexpr int kCount = 20000;
  for (const std::uint32_t index : {0u, 5u}) {
    double sum[12] = {}, product[11] = {};
    for (std::uint32_t seed = 0; seed < kCount; ++seed) {
      Sequence s(seed, 9, index);
      double u[12];
      for (std::size_t block = 0; block < 3; ++block) {
        const std::array<float, 4> v = s.next();
        for (std::size_t d = 0; d < 4; ++d) u[4 * block + d] = static_cast<double>(v[d]) - 0.5;
      }
      for (std::size_t d = 0; d < 12; ++d) {
        sum[d] += u[d];
        if (d > 0) product[d - 1] += u[d] * u[d - 1];
      }
    }
    const double deviation = std::sqrt(1. / 12 / kCount);
    for (const double s : sum) EXPECT_LT(std::fabs(s / kCount), 4 * deviation);
    for (const double p : product) EXPECT_LT(std::fabs(p / kCount), 4 * deviation / std::sqrt(12.));
  }
}

/// Bit k of the index adds row k of the generator matrix: Sobol's sequence as it is defined.
detail::SobolRow by_definition(std::uint32_t index) {
  constexpr std::array<detail::SobolRow, 32> rows = detail::sobol_rows();
  detail::SobolRow v{};
  for (std::size_t k = 0; k < 32; ++k)
    for (std::size_t d = 0; d < 4; ++d)
      if (index >> k & 1) v[d] ^= rows[k][d];
  return v;
}

TEST(Sequence, TheTableIsSobols) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const std::uint32_t index = i < 100 ? i : pcg4d(i, 1, 2, 3).x, reversed = detail::reverse_bits(index);
    const detail::SobolRow expected = by_definition(index);
    detail::SobolRow v{};
    for (std::size_t nibble = 0; nibble < 8; ++nibble)
      for (std::size_t d = 0; d < 4; ++d) v[d] ^= detail::kSobolTable[nibble][reversed >> (4 * nibble) & 15][d];
    for (std::size_t d = 0; d < 4; ++d) ASSERT_EQ(detail::reverse_bits(v[d]), expected[d]) << index << " dimension " << d;
  }
}

TEST(Sequence, SkippedNumbersAreNumbersToo) {
  Sequence a(1, 2, 3), b(1, 2, 3);
  for (int i = 0; i < 12; ++i) {
    const auto expected = a.next();
    if (i % 3 == 1) b.skip();
    else EXPECT_EQ(b.next(), expected);
  }
}

TEST(Sequence, PureFunction) {
  Sequence a(1, 2, 3), b(1, 2, 3), c(1, 2, 4), d(2, 2, 3), e(1, 3, 3);
  for (int i = 0; i < 12; ++i) {
    const auto u = a.next();
    EXPECT_EQ(u, b.next());
    EXPECT_NE(u, c.next());
    EXPECT_NE(u, d.next());
    EXPECT_NE(u, e.next());
    for (const float v : u) EXPECT_TRUE(v >= 0 && v < 1);
  }
}

}  // namespace
}  // namespace pelage
