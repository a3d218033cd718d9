// Roots against the math library in double.
#include "core/roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

template <class Fast, class Exact>
double worst_relative_error(double lowest, double highest, const Fast& fast, const Exact& exact) {
  double worst = 0;
  for (double exponent = lowest; exponent <= highest; exponent += 1e-4) {
    const auto x = static_cast<float>(std::pow(10.0, exponent));
    worst = std::max(worst, std::fabs(static_cast<double>(fast(x)) / exact(static_cast<double>(x)) - 1));
  }
  return worst;
}

TEST(Roots, WithinTheirBounds) {
  const auto cube = [](float x) { return cube_root(x); };
  EXPECT_LT(worst_relative_error(-30, 30, cube, [](double x) { return std::cbrt(x); }),
            static_cast<double>(kRootMaxRelativeError));
  EXPECT_LT(worst_relative_error(-30, 30, fifth_root, [](double x) { return std::pow(x, 0.2); }),
            static_cast<double>(kRootMaxRelativeError));
  EXPECT_LT(worst_relative_error(-30, 30, power_7_10, [](double x) { return std::pow(x, 0.7); }),
            static_cast<double>(kPowerMaxRelativeError));
  EXPECT_LT(worst_relative_error(-12, 12, power_12_5, [](double x) { return std::pow(x, 2.4); }),
            static_cast<double>(kPowerMaxRelativeError));
}

TEST(Roots, OfZeroAreZero) {
  EXPECT_EQ(cube_root(0.f), 0);
  EXPECT_EQ(fifth_root(0.f), 0);
  EXPECT_EQ(power_7_10(0.f), 0);
  EXPECT_EQ(power_12_5(0.f), 0);
}

}  // namespace
}  // namespace pelage
