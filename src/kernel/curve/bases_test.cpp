// Curve bases against what defines them: interpolation, partition of unity, matching derivatives, and independent
// constructions in double precision (de Casteljau, Cox–de Boor, the cubic Hermite form).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "kernel/scalar.h"

namespace pelage::kernel {
namespace {

using Points = std::array<double, 4>;
constexpr Points kPoints{0.3, -1.2, 2.5, 0.9};
constexpr int kSteps = 1000;

struct Basis {
  const char* name;
  Vec4 (*weights)(Float);
  Vec4 (*derivative)(Float);
  double (*reference)(const Points&, double);
};

double linear(const Points& p, double t) { return p[1] + (p[2] - p[1]) * t; }

double de_casteljau(const Points& points, double t) {
  Points p = points;
  for (int level = 3; level > 0; --level)
    for (int i = 0; i < level; ++i) p[i] += (p[i + 1] - p[i]) * t;
  return p[0];
}

/// Hermite form with the tangents (p2 − p0)/2 and (p3 − p1)/2.
double hermite(const Points& p, double t) {
  const double m1 = (p[2] - p[0]) / 2, m2 = (p[3] - p[1]) / 2;
  return p[1] * (2 * t * t * t - 3 * t * t + 1) + m1 * (t * t * t - 2 * t * t + t) + p[2] * (3 * t * t - 2 * t * t * t) +
         m2 * (t * t * t - t * t);
}

/// Cox–de Boor recursion on the knots −3, …, 4; the span is [0, 1).
double cox_de_boor(const Points& p, double t) {
  const std::function<double(int, int)> n = [&](int i, int degree) -> double {
    const double knot = i - 3;
    if (degree == 0) return t >= knot && t < knot + 1 ? 1 : 0;
    return (t - knot) / degree * n(i, degree - 1) + (knot + degree + 1 - t) / degree * n(i + 1, degree - 1);
  };
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += p[i] * n(i, 3);
  return sum;
}

constexpr std::array<Basis, 4> kBases{{
    {"linear", curve_linear_weights, curve_linear_derivative, linear},
    {"Catmull-Rom", curve_catmull_rom_weights, curve_catmull_rom_derivative, hermite},
    {"B-spline", curve_bspline_weights, curve_bspline_derivative, cox_de_boor},
    {"Bezier", curve_bezier_weights, curve_bezier_derivative, de_casteljau},
}};

double apply(Vec4 w, const Points& p) {
  return static_cast<double>(w.x) * p[0] + static_cast<double>(w.y) * p[1] + static_cast<double>(w.z) * p[2] +
         static_cast<double>(w.w) * p[3];
}

TEST(CurveBases, EqualTheirReference) {
  for (const Basis& basis : kBases)
    for (int i = 0; i < kSteps; ++i) {
      const double t = static_cast<double>(static_cast<float>(i) / kSteps);
      ASSERT_NEAR(apply(basis.weights(static_cast<float>(t)), kPoints), basis.reference(kPoints, t), 2e-6)
          << basis.name << " " << t;
    }
}

TEST(CurveBases, WeightsSumToOneAndDerivativesToZero) {
  constexpr Points ones{1, 1, 1, 1};
  for (const Basis& basis : kBases)
    for (int i = 0; i <= kSteps; ++i) {
      const float t = static_cast<float>(i) / kSteps;
      ASSERT_NEAR(apply(basis.weights(t), ones), 1, 4e-7) << basis.name << " " << t;
      ASSERT_NEAR(apply(basis.derivative(t), ones), 0, 2e-6) << basis.name << " " << t;
    }
}

TEST(CurveBases, DerivativesAreThoseOfTheReference) {
  constexpr double h = 1e-5;
  for (const Basis& basis : kBases)
    for (int i = 1; i < kSteps; ++i) {
      const double t = static_cast<double>(static_cast<float>(i) / kSteps);
      const double slope = (basis.reference(kPoints, t + h) - basis.reference(kPoints, t - h)) / (2 * h);
      ASSERT_NEAR(apply(basis.derivative(static_cast<float>(t)), kPoints), slope, 2e-5) << basis.name << " " << t;
    }
}

TEST(CurveBases, CombineWeighsThePoints) {
  const Vec3 p = curve_combine(Vec4(0.1f, 0.2f, 0.3f, 0.4f), Vec3(10, 0, 0), Vec3(0, 10, 0), Vec3(0, 0, 10), Vec3(10, 10, 0));
  EXPECT_FLOAT_EQ(p.x, 5);
  EXPECT_FLOAT_EQ(p.y, 6);
  EXPECT_FLOAT_EQ(p.z, 3);
}

}  // namespace
}  // namespace pelage::kernel
