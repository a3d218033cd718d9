// FXAA on pictures whose right answer is known.
#include "filter/fxaa.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include "filter/edge_pictures.h"
#include "filter/resample.h"

namespace pelage {
namespace {

using namespace test;

Image filtered(const Image& image) { return resample(image, fxaa_offsets(image), AlphaKind::kStraight); }

TEST(Fxaa, ConstantPicturesStay) {
  Image image(33, 17, {"R", "G", "B", "A"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i % 4 == 3 ? 1.f : 0.3f;
  EXPECT_EQ(filtered(image).pixels, image.pixels);
}

TEST(Fxaa, FaintEdgesStay) {
  const Image image = shape(20, 20, 1, [](float x, float) { return x < 10; });
  Image faint = image;
  for (std::size_t i = 0; i < faint.pixels.size(); ++i)
    if (i % 4 != 3) faint.pixels[i] = 0.5f + 0.03f * faint.pixels[i];
  EXPECT_EQ(filtered(faint).pixels, faint.pixels);
  EXPECT_NE(filtered(image).pixels, image.pixels);
}

TEST(Fxaa, AStraightEdgeAlongTheGridIsHardlyTouched) {
  const Image image = shape(80, 20, 1, [](float, float y) { return y < 10; });
  EXPECT_LT(rms_inside(filtered(image), image, 0), 0.02);
}

// Edges of many slopes come closer to what they really cover.
TEST(Fxaa, SlantedEdgesComeCloserToTheirCoverage) {
  for (const float slope : {0.05f, 0.11f, 0.2f, 0.3f, 0.43f, 0.7f, 0.93f}) {
    const auto below = [&](float x, float y) { return y > 20 + slope * (x - 32.3f); };
    const auto beside = [&](float x, float y) { return below(y, x); };
    const Image flat = shape(64, 40, 1, below), flat_truth = shape(64, 40, 16, below);
    EXPECT_LT(rms_inside(filtered(flat), flat_truth, 4), 0.7 * rms_inside(flat, flat_truth, 4)) << slope;
    const Image steep = shape(40, 64, 1, beside), steep_truth = shape(40, 64, 16, beside);
    EXPECT_LT(rms_inside(filtered(steep), steep_truth, 4), 0.7 * rms_inside(steep, steep_truth, 4)) << slope;
  }
}

TEST(Fxaa, RowsAndColumnsAreTreatedAlike) {
  const Image noise = noise_picture(41, 29);
  const Buffer<Vec2> a = fxaa_offsets(noise), b = fxaa_offsets(transposed(noise));
  int moved = 0, different = 0;
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 41; ++x) {
      const Vec2 p = a[static_cast<std::size_t>(y * 41 + x)], q = b[static_cast<std::size_t>(x * 29 + y)];
      different += std::fabs(p.x - q.y) > 1e-4f || std::fabs(p.y - q.x) > 1e-4f;
      ASSERT_LE(std::fabs(p.x) + std::fabs(p.y), 0.75f);
      moved += !(p == Vec2());
    }
  EXPECT_GT(moved, 300);
  EXPECT_LT(different, moved / 20) << "where an edge is as much a row's as a column's, rounding decides";
}

TEST(Fxaa, ColorsBesideTransparencyDoNotDarken) {
  Image image = shape(20, 20, 1, [](float x, float y) { return y > 0.3f * x + 5; });
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) image.pixels[i + 3] = image.pixels[i];  // transparent black
  const Image result = filtered(image);
  bool mixed = false;
  for (std::size_t i = 0; i < result.pixels.size(); i += 4) {
    const float alpha = result.pixels[i + 3];
    mixed |= alpha > 0.1f && alpha < 0.9f;
    if (alpha > 0) {
      ASSERT_NEAR(result.pixels[i], 1, 1e-6f);
    }
  }
  EXPECT_TRUE(mixed);
}

TEST(Fxaa, HasTheSameBitsForAnyThreads) { EXPECT_TRUE(same_bits_for_any_threads(filtered)); }

}  // namespace
}  // namespace pelage
