// Noise of light, told apart from the change of strands.
#include "filter/sample_noise.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>

#include "core/rng.h"

namespace pelage {
namespace {

/// Upright strands, a column each, every fourth column empty: `own` is how much of a color is its strand's, the rest is its sample's.
HairSamples columns(int width, int height, float own) {
  HairSamples s;
  s.width = width, s.height = height;
  const auto n = static_cast<std::size_t>(width * height);
  s.strand.resize(n), s.color.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const auto column = static_cast<std::uint32_t>(p % static_cast<std::size_t>(width));
    s.strand[p] = column % 4 == 3 ? 0 : static_cast<float>(column + 1);
    Rng strand(1, column), sample(2, static_cast<std::uint32_t>(p));
    const float c = own * strand.uniform() + (1 - own) * sample.uniform();
    s.color[p] = Vec3(c, c, c);
  }
  return s;
}

TEST(ColorNoise, IsTheShareOfTheSamplesVariance) {
  EXPECT_EQ(color_noise(columns(64, 50, 1)), 0);
  EXPECT_NEAR(color_noise(columns(400, 300, 0)), 1, 0.02f);
  // Two samples differ by twice the variance of what is random in them: by (1 − own)² on one strand, and own² more on two.
  EXPECT_NEAR(color_noise(columns(4000, 40, 0.5f)), 0.5f, 0.03f);
}

TEST(ColorNoise, WithoutNeighborsThereIsNone) {
  EXPECT_EQ(color_noise(columns(1, 1, 0)), 0);
  HairSamples bald = columns(8, 8, 0);
  bald.strand.fill(0);
  EXPECT_EQ(color_noise(bald), 0);
  EXPECT_EQ(color_noise(columns(1, 30, 0)), 1);  // one strand, and nothing else
}

TEST(ColorNoise, SameBitsForAnyThreads) {
  const HairSamples s = columns(300, 200, 0.5f);
  set_thread_count(1);
  const float one = color_noise(s);
  set_thread_count(4);
  EXPECT_EQ(color_noise(s), one);
  set_thread_count(0);
}

TEST(RadiusForNoise, GrowsWithNoiseAndShrinksWithSamples) {
  EXPECT_EQ(kernel_scale_for_noise(0), 1);
  EXPECT_NEAR(kernel_scale_for_noise(1), 2.1, 1e-6);
}

}  // namespace
}  // namespace pelage
