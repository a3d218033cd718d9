// The tone curve is monotone and keeps neutral neutral; the sRGB encoding stays within its stated error.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/scalar.h"

namespace pelage::kernel {
namespace {

TEST(ToneMap, SrgbWithinItsBound) {
  for (int i = 0; i <= 100000; ++i) {
    const float x = static_cast<float>(i) / 100000.f;
    const double d = x;
    const double exact = d <= 0.0031308 ? 12.92 * d : 1.055 * std::pow(d, 1 / 2.4) - 0.055;
    ASSERT_LE(std::fabs(composite_srgb_encode(x) - exact), kSrgbMaxAbsError) << x;
  }
  EXPECT_EQ(composite_srgb_encode(-1), 0);
  EXPECT_NEAR(composite_srgb_encode(2), 1, kSrgbMaxAbsError);
}

TEST(ToneMap, AcesKeepsNeutralNeutralAndGrows) {
  float before = -1;
  for (float e = -12; e < 12; e += 0.01f) {
    const float x = std::exp2(e);
    const Vec3 c = composite_tone_map_aces({x, x, x});
    ASSERT_NEAR(c.x, c.y, 1e-4f) << x;
    ASSERT_NEAR(c.x, c.z, 1e-4f) << x;
    ASSERT_GE(c.x, before) << x;
    ASSERT_LE(c.x, 1);
    before = c.x;
  }
  EXPECT_EQ(before, 1);
}

TEST(ToneMap, AcesAtTheEnds) {
  EXPECT_EQ(composite_tone_map_aces({0, 0, 0}), Vec3(0, 0, 0));
  EXPECT_EQ(composite_tone_map_aces({-5, -5, -5}), Vec3(0, 0, 0));
  const Vec3 c = composite_tone_map_aces({INFINITY, 1e30f, 3e38f});
  EXPECT_NEAR(c.x + c.y + c.z, 3, 1e-3f);
}

// Mid gray of the reference: 0.18 shows as 10 % of white on the display of the sRGB output transform.
TEST(ToneMap, AcesPutsMiddleGrayAtATenth) { EXPECT_NEAR(composite_tone_map_aces({0.18f, 0.18f, 0.18f}).y, 0.1f, 0.01f); }

}  // namespace
}  // namespace pelage::kernel
