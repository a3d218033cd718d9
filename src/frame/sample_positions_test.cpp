// Places of samples: how evenly they stand, against the exact area of bands across the pixel.
#include "frame/sample_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "core/rng.h"

namespace pelage {
namespace {

struct BandOfPixel {
  Vec2 normal;  // unit
  float offset, width;
};

BandOfPixel random_band(Rng& rng) {
  const float angle = 6.2831853f * rng.uniform();
  const float width = 0.02f + 0.58f * rng.uniform(), offset = 1.4f * rng.uniform() - 0.7f;
  return {{std::cos(angle), std::sin(angle)}, offset, width};
}

bool covers(const BandOfPixel& b, Vec2 p) {
  return std::fabs(b.normal.x * (p.x - 0.5f) + b.normal.y * (p.y - 0.5f) - b.offset) < b.width / 2;
}

float covered_share(const BandOfPixel& b, const std::vector<Vec2>& positions) {
  int count = 0;
  for (const Vec2 p : positions) count += covers(b, p);
  return static_cast<float>(count) / static_cast<float>(positions.size());
}

double rms_error(const std::vector<Vec2>& positions) {
  std::vector<Vec2> grid;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) grid.emplace_back((static_cast<float>(x) + 0.5f) / 100, (static_cast<float>(y) + 0.5f) / 100);
  Rng rng(1, 0);
  double sum = 0;
  constexpr int kBands = 1000;
  for (int i = 0; i < kBands; ++i) {
    const BandOfPixel band = random_band(rng);
    const double error = static_cast<double>(covered_share(band, positions) - covered_share(band, grid));
    sum += error * error;
  }
  return std::sqrt(sum / kBands);
}

TEST(SamplePositions, StandInsideThePixelOneByOne) {
  for (const int n : {1, 2, 3, 4, 5, 8, 16, 17, 64, 100, 255, 256, 1000, 4096}) {
    const std::vector<Vec2> positions = pixel_sample_positions(n);
    ASSERT_EQ(positions.size(), static_cast<std::size_t>(n));
    std::set<std::pair<float, float>> distinct;
    for (const Vec2 p : positions) {
      EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1) << n << ": " << p.x << ", " << p.y;
      distinct.insert({p.x, p.y});
    }
    EXPECT_EQ(distinct.size(), positions.size()) << n;
  }
}

TEST(SamplePositions, TheStandardPatternsAreTheMultisamplers) {
  for (const int n : {1, 2, 4, 8, 16}) {
    const std::vector<Vec2> positions = pixel_sample_positions(n);
    const auto standard = sample_positions(n);
    for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(positions[i], standard[i]) << n;
  }
  EXPECT_EQ(pixel_sample_positions(1)[0], Vec2(0.5f, 0.5f));
}

// Every cell of every cut of the pixel into 64 equal boxes, 1×64 to 64×1, holds exactly one of 64 samples.
TEST(SamplePositions, SixtyFourAreANet) {
  const std::vector<Vec2> positions = pixel_sample_positions(64);
  for (int columns = 1; columns <= 64; columns *= 2) {
    std::set<int> cells;
    for (const Vec2 p : positions)
      cells.insert(static_cast<int>(p.y * static_cast<float>(64 / columns)) * columns +
                   static_cast<int>(p.x * static_cast<float>(columns)));
    EXPECT_EQ(cells.size(), 64u) << columns << " columns";
  }
}

TEST(SamplePositions, MeasureBandsBetterThanChance) {
  EXPECT_LT(rms_error(pixel_sample_positions(64)), 0.019);
  EXPECT_LT(rms_error(pixel_sample_positions(100)), 0.014);
  std::vector<Vec2> chance;
  Rng rng(2, 0);
  for (int i = 0; i < 64; ++i) chance.push_back(rng.uniform2());
  EXPECT_GT(rms_error(chance), 0.03);
}

TEST(SamplePositions, RadicalInverseMirrorsDigits) {
  EXPECT_EQ(radical_inverse(0, 2), 0);
  EXPECT_EQ(radical_inverse(1, 2), 0.5f);
  EXPECT_EQ(radical_inverse(6, 2), 0.375f) << "110 becomes .011";
  EXPECT_FLOAT_EQ(radical_inverse(5, 3), 7.f / 9) << "12 becomes .21";
}

// Any run of 16 frames of the jitter fills the pixel about evenly.
TEST(SamplePositions, JitterIsEvenInEveryRun) {
  for (std::uint32_t first = 0; first < 200; first += 7) {
    Vec2 sum;
    std::vector<Vec2> run;
    for (std::uint32_t i = 0; i < 16; ++i) {
      run.push_back(jitter_position(first + i));
      sum = sum + run.back();
    }
    EXPECT_NEAR(sum.x / 16, 0.5f, 0.05f) << first;
    EXPECT_NEAR(sum.y / 16, 0.5f, 0.07f) << first;
    EXPECT_LT(rms_error(run), 0.075) << first;
  }
}

}  // namespace
}  // namespace pelage
