// The stated error bounds of the elementary functions, over their ranges, against double precision.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/scalar.h"

namespace pelage::kernel {
namespace {

constexpr int kSteps = 200000;

template <class Function>
void sweep(double from, double to, Function&& check) {
  for (int i = 0; i <= kSteps; ++i) check(static_cast<float>(from + (to - from) * i / kSteps));
}

TEST(Elementary, ExpWithinItsBound) {
  sweep(-87, 88, [](float x) {
    const double exact = std::exp(static_cast<double>(x));
    ASSERT_LE(std::fabs(m_exp(x) - exact) / exact, kExpMaxRelError) << x;
  });
}

TEST(Elementary, LogWithinItsBound) {
  sweep(-86, 88, [](float e) {
    const float x = std::exp(e);
    const double exact = std::log(static_cast<double>(x));
    ASSERT_LE(std::fabs(m_log(x) - exact), kLogMaxAbsError * std::max(1.0, std::fabs(exact))) << x;
  });
}

TEST(Elementary, PowerWithinItsBound) {
  for (const float y : {-4.5f, -1.0f, 0.0f, 0.25f, 1.0f, 2.2f, 5.0f})
    sweep(-6, 6, [y](float e) {
      const float x = std::pow(10.0f, e);
      const double exact = std::pow(static_cast<double>(x), static_cast<double>(y));
      const double scale = std::max(1.0, std::fabs(y * std::log(static_cast<double>(x))));
      if (exact < 1e-30 || exact > 1e30) return;
      ASSERT_LE(std::fabs(m_pow(x, y) - exact) / exact, kPowMaxRelError * scale) << x << " " << y;
    });
  EXPECT_EQ(m_pow(0, 2), 0);
  EXPECT_EQ(m_pow(-3, 2), 0);
}

TEST(Elementary, ExtremesStayFinite) {
  EXPECT_EQ(m_exp(1000), m_exp(88));
  EXPECT_EQ(m_exp(-1000), m_exp(-87));
  EXPECT_GT(m_exp(-1000), 0);
  EXPECT_EQ(m_log(0), m_log(1.17549435e-38f));
  EXPECT_EQ(m_asin(1.5f), m_asin(1));
  EXPECT_EQ(m_asin(-1.5f), m_asin(-1));
}

TEST(Elementary, SineAndCosineWithinTheirBound) {
  sweep(-100, 100, [](float x) {
    ASSERT_LE(std::fabs(m_sin(x) - std::sin(static_cast<double>(x))), kSinCosMaxAbsError) << x;
    ASSERT_LE(std::fabs(m_cos(x) - std::cos(static_cast<double>(x))), kSinCosMaxAbsError) << x;
  });
}

TEST(Elementary, ArcSineAndCosineWithinTheirBound) {
  sweep(-1, 1, [](float x) {
    ASSERT_LE(std::fabs(m_asin(x) - std::asin(static_cast<double>(x))), kAsinMaxAbsError) << x;
    ASSERT_LE(std::fabs(m_acos(x) - std::acos(static_cast<double>(x))), kAsinMaxAbsError) << x;
  });
}

TEST(Elementary, ArcTangentWithinItsBound) {
  sweep(-3.1415, 3.1415, [](float a) {
    for (const float r : {1e-6f, 1.f, 1e6f}) {
      const float y = r * std::sin(a), x = r * std::cos(a);
      ASSERT_LE(std::fabs(m_atan2(y, x) - std::atan2(static_cast<double>(y), static_cast<double>(x))), kAtan2MaxAbsError)
          << y << " " << x;
    }
  });
  EXPECT_EQ(m_atan2(0, 0), 0);
}

}  // namespace
}  // namespace pelage::kernel
