// The vector helpers against their definitions.
#include <gtest/gtest.h>

#include "kernel/scalar.h"

namespace pelage::kernel {
namespace {

TEST(Vector, ClampSquareSplat) {
  EXPECT_EQ(v_clamp(-2, -1, 1), -1);
  EXPECT_EQ(v_clamp(0.5f, -1, 1), 0.5f);
  EXPECT_EQ(v_clamp(7, -1, 1), 1);
  EXPECT_EQ(v_square(-3), 9);
  const Vec3 v = v_splat(4);
  EXPECT_TRUE(v.x == 4 && v.y == 4 && v.z == 4);
}

TEST(Vector, LengthAndNormalize) {
  EXPECT_EQ(v_length(Vec3(2, -3, 6)), 7);
  const Vec3 unit = v_normalize(Vec3(2, -3, 6));
  EXPECT_NEAR(unit.x, 2.0f / 7, 1e-7f);
  EXPECT_NEAR(unit.y, -3.0f / 7, 1e-7f);
  EXPECT_NEAR(unit.z, 6.0f / 7, 1e-7f);
  const Vec3 zero = v_normalize(Vec3(0, 0, 0));
  EXPECT_TRUE(zero.x == 0 && zero.y == 0 && zero.z == 0);
}

TEST(Vector, LerpMeetsBothEnds) {
  const Vec3 a(1, 2, 3), b(5, 0, -1);
  const Vec3 start = v_lerp(a, b, 0), quarter = v_lerp(a, b, 0.25f), end = v_lerp(a, b, 1);
  EXPECT_TRUE(start.x == 1 && start.y == 2 && start.z == 3);
  EXPECT_TRUE(quarter.x == 2 && quarter.y == 1.5f && quarter.z == 2);
  EXPECT_TRUE(end.x == 5 && end.y == 0 && end.z == -1);
}

TEST(Vector, ExponentialByChannel) {
  const Vec3 e = v_exp(Vec3(0, 1, -1));
  EXPECT_EQ(e.x, 1);
  EXPECT_NEAR(e.y, 2.7182818f, 1e-6f);
  EXPECT_NEAR(e.z, 0.36787944f, 1e-7f);
}

TEST(Vector, LuminanceIsThatOfRec709) {
  EXPECT_NEAR(v_luminance(Vec3(1, 1, 1)), 1, 1e-6f);
  EXPECT_EQ(v_luminance(Vec3(1, 0, 0)), 0.2126f);
  EXPECT_EQ(v_luminance(Vec3(0, 1, 0)), 0.7152f);
  EXPECT_EQ(v_luminance(Vec3(0, 0, 1)), 0.0722f);
}

}  // namespace
}  // namespace pelage::kernel
