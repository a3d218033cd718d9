// SMAA: its areas against brute force, its pictures against what shapes really cover.
#include "filter/smaa.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include "core/srgb.h"
#include "filter/edge_pictures.h"

namespace pelage {
namespace {

using namespace test;

Image filtered(const Image& image) { return smaa_blend(image, smaa_shares(image), AlphaKind::kPremultiplied); }

// Height of the line over the edge at x, told point by point: the definition that smaa_area() integrates.
double height_of_line(double x, double length, double start, double end) {
  if (start * end < 0) return start + (end - start) * x / length;
  const double from_middle = std::fabs(x - length / 2) / (length / 2);
  return (x < length / 2 ? start : end) * from_middle;
}

TEST(SmaaArea, EqualsBruteForce) {
  constexpr int kSteps = 2000;
  for (const float start : {-0.5f, 0.f, 0.5f})
    for (const float end : {-0.5f, 0.f, 0.5f})
      for (int left = 0; left < 9; ++left)
        for (int right = 0; right < 9; ++right) {
          double above = 0, below = 0;
          for (int i = 0; i < kSteps; ++i) {
            const double h = height_of_line(left + (i + 0.5) / kSteps, left + 1 + right, static_cast<double>(start),
                                            static_cast<double>(end));
            (h < 0 ? below : above) += std::fabs(h) / kSteps;
          }
          const EdgeArea area = smaa_area(left, right, start, end);
          ASSERT_NEAR(area.above, above, 1e-4) << left << " " << right << " " << start << " " << end;
          ASSERT_NEAR(area.below, below, 1e-4) << left << " " << right << " " << start << " " << end;
        }
}

TEST(SmaaArea, AStepOfASlopeCutsOffTwoTriangles) {
  float above = 0, below = 0;
  for (int i = 0; i < 12; ++i) {
    const EdgeArea area = smaa_area(i, 11 - i, 0.5f, -0.5f);
    above += area.above, below += area.below;
  }
  EXPECT_NEAR(above, 12 / 8.f, 1e-5f);
  EXPECT_NEAR(below, 12 / 8.f, 1e-5f);
}

TEST(Smaa, ConstantPicturesAndGridEdgesStay) {
  Image image(33, 17, {"R", "G", "B", "A"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i % 4 == 3 ? 1.f : 0.3f;
  EXPECT_EQ(filtered(image).pixels, image.pixels);
  const Image edge = shape(80, 20, 1, [](float, float y) { return y < 10; });
  EXPECT_EQ(filtered(edge).pixels, edge.pixels);
}

// A slope of one in n is made of steps that are exactly what the lines assume.
TEST(Smaa, ShallowSlopesBecomeTheirCoverage) {
  for (const int n : {4, 6, 8, 12}) {
    const auto below = [&](float x, float y) { return y > 20 + (x - 32) / static_cast<float>(n); };
    const Image image = shape(64, 40, 1, below), truth = shape(64, 40, 16, below);
    EXPECT_LT(rms_inside(filtered(image), truth, 12), 0.1 * rms_inside(image, truth, 12)) << n;
  }
}

TEST(Smaa, SlantedEdgesComeCloserToTheirCoverage) {
  for (const float slope : {0.05f, 0.11f, 0.2f, 0.3f, 0.43f}) {
    const auto below = [&](float x, float y) { return y > 20 + slope * (x - 32.3f); };
    const auto beside = [&](float x, float y) { return below(y, x); };
    const Image flat = shape(64, 40, 1, below), flat_truth = shape(64, 40, 16, below);
    EXPECT_LT(rms_inside(filtered(flat), flat_truth, 4), 0.4 * rms_inside(flat, flat_truth, 4)) << slope;
    const Image steep = shape(40, 64, 1, beside), steep_truth = shape(40, 64, 16, beside);
    EXPECT_LT(rms_inside(filtered(steep), steep_truth, 4), 0.4 * rms_inside(steep, steep_truth, 4)) << slope;
  }
}

TEST(Smaa, DisplayedPicturesAreMixedInLinearLight) {
  const Image image = shape(64, 40, 1, [](float x, float y) { return y > 20 + x / 8; });  // black and white: the same in both
  const Buffer<SmaaShares> shares = smaa_shares(image);
  const Image linear = smaa_blend(image, shares, AlphaKind::kPremultiplied);
  const Image display = smaa_blend(image, shares, AlphaKind::kStraight);
  for (std::size_t i = 0; i < linear.pixels.size(); i += 4)
    ASSERT_NEAR(srgb_to_linear(display.pixels[i]), linear.pixels[i], 1e-5f);
}

TEST(Smaa, TrueCornersAreKept) {
  const Image square = shape(40, 40, 1, [](float x, float y) { return x > 10 && x < 30 && y > 10 && y < 30; });
  const Image result = filtered(square);
  EXPECT_GT(result.at(10, 10)[0], 0.85f);
  const SmaaSettings round{.corner_rounding = 1};
  EXPECT_LT(smaa_blend(square, smaa_shares(square, round), AlphaKind::kPremultiplied).at(10, 10)[0], result.at(10, 10)[0]);
}

TEST(Smaa, AnEdgeBesideAStrongerOneDoesNotCount) {
  // 0, 0.1, 1: the small step stands beside the large one.
  Image image = shape(30, 30, 1, [](float x, float y) { return y > 15 + 0.2f * x; });
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x)
      if (y + 1 < 30 && image.at(x, y)[0] == 0 && image.at(x, y + 1)[0] == 1)
        for (int c = 0; c < 3; ++c) image.at(x, y)[c] = 0.1f;
  const Buffer<SmaaShares> shares = smaa_shares(image);
  for (int y = 1; y < 29; ++y)
    for (int x = 6; x < 24; ++x)
      if (image.at(x, y)[0] == 0.1f) {
        EXPECT_EQ(shares[static_cast<std::size_t>(y * 30 + x)].up, 0) << x << ", " << y;
      }
}

TEST(Smaa, RowsAndColumnsAreTreatedAlike) {
  const Image noise = noise_picture(41, 29);
  const Buffer<SmaaShares> a = smaa_shares(noise), b = smaa_shares(transposed(noise));
  int mixed = 0;
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 41; ++x) {
      const SmaaShares p = a[static_cast<std::size_t>(y * 41 + x)], q = b[static_cast<std::size_t>(x * 29 + y)];
      ASSERT_EQ(p.left, q.up) << x << ", " << y;
      ASSERT_EQ(p.right, q.down) << x << ", " << y;
      mixed += p.left > 0 || p.down > 0;
    }
  EXPECT_GT(mixed, 100);
}

TEST(Smaa, HasTheSameBitsForAnyThreads) { EXPECT_TRUE(same_bits_for_any_threads(filtered)); }

}  // namespace
}  // namespace pelage
