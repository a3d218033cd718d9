// The single-fiber models against brute force: energies, shapes, normalization, extremes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/rng.h"
#include "kernel/scalar.h"
#include "oracle/fiber_oracle.h"

namespace pelage::kernel {
namespace {

constexpr double kPiD = std::numbers::pi;
using Lobe = std::function<float(float sin_i, float cos_i, float cos_phi)>;

// Integral over the sphere of directions omega_i: midpoints in phi (periodic) and in a window of theta_i that holds the
// cone around theta_i = center; a center beyond a pole comes back on its other side.
double sphere_integral(const Lobe& lobe, double center, double deviation, int thetas = 96, int phis = 400) {
  if (std::fabs(center) > kPiD / 2) center = std::copysign(kPiD, center) - center;
  const double lo = std::max(-kPiD / 2, center - 12 * deviation), hi = std::min(kPiD / 2, center + 12 * deviation);
  double sum = 0;
  for (int i = 0; i < thetas; ++i) {
    const double theta = lo + (hi - lo) * (i + 0.5) / thetas;
    const float s = static_cast<float>(std::sin(theta)), c = static_cast<float>(std::cos(theta));
    double ring = 0;
    for (int j = 0; j < phis / 2; ++j) ring += 2 * lobe(s, c, static_cast<float>(std::cos(2 * kPiD * (j + 0.5) / phis)));
    sum += ring * std::cos(theta);
  }
  return sum * (hi - lo) / thetas * 2 * kPiD / phis;
}

struct Parameters {
  float eta, beta_m, beta_n, tilt, sigma_a, theta_o;
  ScatterFiber fiber() const { return scatter_fiber(eta, beta_m, beta_n, tilt, 1, {sigma_a, sigma_a, sigma_a}); }
  std::string name() const {
    return "eta " + std::to_string(eta) + " beta_m " + std::to_string(beta_m) + " beta_n " + std::to_string(beta_n) + " tilt " +
           std::to_string(tilt) + " sigma_a " + std::to_string(sigma_a) + " theta_o " + std::to_string(theta_o);
  }
};

std::vector<Parameters> parameter_grid() {
  std::vector<Parameters> grid;
  for (const float beta_m : {1e-3f, 0.05f, 0.13f, 0.5f}) {
    for (const float beta_n : {1e-3f, 0.26f, 1.f}) {
      for (const float tilt : {-0.0873f, 0.0524f}) {
        for (const float sigma_a : {0.f, 0.5f, 5.f}) {
          for (const float theta_o : {-1.55f, -0.9f, 0.f, 0.4f, 1.3f}) {
            grid.push_back({1.55f, beta_m, beta_n, tilt, sigma_a, theta_o});
          }
        }
      }
    }
  }
  return grid;
}

TEST(Scatter, BesselWithinItsBound) {
  for (double x = 0; x < 600; x += x < 10 ? 1e-3 : 0.5) {
    const double exact = std::cyl_bessel_i(0, x) * std::exp(-x);
    ASSERT_LE(std::fabs(scatter_i0e(static_cast<float>(x)) / exact - 1), kI0eMaxRelError) << x;
  }
  for (const double x : {1e4, 1e6}) {
    const double exact = (1 + 1 / (8 * x)) / std::sqrt(2 * kPiD * x);
    EXPECT_LE(std::fabs(scatter_i0e(static_cast<float>(x)) / exact - 1), kI0eMaxRelError) << x;
  }
}

TEST(Scatter, FresnelAtNormalAndGrazingIncidence) {
  EXPECT_NEAR(scatter_fresnel(1, 1.55f), 0.55 * 0.55 / (2.55 * 2.55), 1e-6);
  EXPECT_FLOAT_EQ(scatter_fresnel(0, 1.55f), 1);
  for (float c = 0; c <= 1; c += 0.01f) EXPECT_NEAR(scatter_fresnel(c, 1.55f), oracle::reflectance(c, 1.55), 2e-6) << c;
}

// Five nodes in the kernel against thousands of traced rays.
TEST(Scatter, LobeEnergiesWithinTheirBoundOfTracedRays) {
  double worst = 0;
  for (const float eta : {1.3f, 1.55f, 1.8f}) {
    for (const float sigma_a : {0.f, 0.5f, 8.f}) {
      for (const float cos_o : {1.f, 0.9f, 0.7f, 0.5f, 0.3f, 0.1f, 0.03f, 0.01f}) {
        const ScatterFiber f = scatter_fiber(eta, 0.13f, 0.26f, 0.05f, 1, {sigma_a, sigma_a, sigma_a});
        const ScatterLobes l = scatter_prepare_marschner(f, std::sqrt(1 - cos_o * cos_o), cos_o);
        const auto exact = oracle::fiber<600>(cos_o, eta, sigma_a, 300);
        double rest = 0;
        for (std::size_t k = 3; k < exact.energy.size(); ++k) rest += exact.energy[k];
        const double errors[] = {l.a_r - exact.energy[0], l.a_tt.y - exact.energy[1], l.a_trt.x - exact.energy[2],
                                 l.a_rest.z - rest};
        for (const double e : errors) {
          ASSERT_LE(std::fabs(e), kLobeEnergyMaxAbsError) << eta << " " << sigma_a << " " << cos_o;
          worst = std::max(worst, std::fabs(e));
        }
      }
    }
  }
  std::printf("worst lobe energy: %.2e\n", worst);
}

// Every lobe, isolated, integrates to the energy that ScatterLobes states: within 1 % over the whole grid.
TEST(Scatter, EveryLobeIntegratesToItsEnergy) {
  double worst = 0;
  for (const Parameters& s : parameter_grid()) {
    const ScatterLobes l = scatter_prepare_marschner(s.fiber(), std::sin(s.theta_o), std::cos(s.theta_o));
    const ScatterLobes z = scatter_prepare_zhu(s.fiber(), std::sin(s.theta_o), std::cos(s.theta_o));
    ScatterLobes none = l;
    none.gain_r = none.a_r = 0;
    none.a_tt = none.a_trt = none.a_rest = Vec3(0, 0, 0);
    const auto check = [&](const char* name, const ScatterLobes& only, const ScatterCone& cone, double energy, auto&& model) {
      const Lobe lobe = [&](float si, float ci, float cp) { return model(only, si, ci, cp).y; };
      const double got = sphere_integral(lobe, cone.shift - s.theta_o, std::sqrt(cone.v));
      ASSERT_NEAR(got, energy, 0.01 * energy + 1e-7) << name << ": " << s.name();
      if (energy > 1e-6) worst = std::max(worst, std::fabs(got / energy - 1));
    };
    ScatterLobes only = none;
    only.gain_r = l.gain_r, only.a_r = l.a_r;
    check("R", only, l.r, l.a_r, scatter_marschner);
    only = none, only.a_tt = l.a_tt;
    check("TT", only, l.tt, l.a_tt.y, scatter_marschner);
    only = none, only.a_trt = l.a_trt;
    check("TRT", only, l.trt, l.a_trt.y, scatter_marschner);
    only = none, only.a_rest = l.a_rest;
    check("rest", only, l.trt, l.a_rest.y, scatter_marschner);
    only = none, only.n_tt = z.n_tt, only.a_tt = z.a_tt;
    check("Zhu TT", only, z.tt, z.a_tt.y, scatter_zhu);
    only = none, only.a_r = z.a_r;
    check("Zhu R", only, z.r, z.a_r, scatter_zhu);
    const auto kajiya = [](const ScatterLobes& k, float si, float ci, float) {
      return scatter_kajiya_kay(k, Vec3(0, 0, 0), si, ci);
    };
    check("Kajiya-Kay highlight", only, z.r, z.a_r, kajiya);
  }
  const double diffuse = sphere_integral([](float, float ci, float) { return scatter_diffuse(ci); }, 0, 1);
  EXPECT_NEAR(diffuse, 1, 1e-3);
  std::printf("worst relative error of a lobe's integral: %.2e\n", worst);
}

// The white furnace of one fiber: without absorption everything comes out again; R + TT + TRT alone lose the rest.
TEST(Scatter, WhiteFurnaceOfOneFiber) {
  double least = 1;
  for (float theta = 0; theta < 1.57f; theta += 0.01f) {
    const ScatterFiber f = scatter_fiber(1.55f, 0.13f, 0.26f, 0.05f, 1, {0, 0, 0});
    const ScatterLobes l = scatter_prepare_marschner(f, std::sin(theta), std::cos(theta));
    EXPECT_NEAR(l.a_r + l.a_tt.x + l.a_trt.x + l.a_rest.x, 1, 1e-4) << theta;
    const ScatterLobes z = scatter_prepare_zhu(f, std::sin(theta), std::cos(theta));
    EXPECT_NEAR(z.a_r + z.a_tt.x + z.a_trt.x + z.a_rest.x, 1, 1e-4) << theta;
    if (theta < 1) least = std::min(least, static_cast<double>(l.a_r + l.a_tt.x + l.a_trt.x));
  }
  std::printf("R + TT + TRT without absorption, |theta| < 1: at least %.4f\n", least);
  EXPECT_GT(least, 0.97);
  for (const Parameters& s : parameter_grid()) {
    const ScatterLobes l = scatter_prepare_marschner(s.fiber(), std::sin(s.theta_o), std::cos(s.theta_o));
    EXPECT_LE(l.a_r + l.a_tt.x + l.a_trt.x + l.a_rest.x, 1.0001f) << s.name();
  }
}

// Azimuthal shape: the pair of von Mises lobes against the traced exits, blurred by a Gaussian of deviation beta_n.
double shape_distance(float eta, float theta, float sigma_a, float beta_n, std::size_t order) {
  const ScatterLobes l = scatter_prepare_marschner(scatter_fiber(eta, 0.13f, beta_n, 0, 1, {sigma_a, sigma_a, sigma_a}),
                                                   std::sin(theta), std::cos(theta));
  constexpr int kBins = 360, kRays = 3000;
  std::vector<double> exact(kBins);
  double energy = 0;
  for (int i = 0; i < kRays; ++i) {
    const double gamma = (i + 0.5) / kRays * kPiD / 2;
    const oracle::Exit e = oracle::trace<3>(std::cos(theta), std::sin(gamma), eta, sigma_a)[order];
    const double w = std::cos(gamma) * e.energy;
    energy += w;
    for (int b = 0; b < kBins; ++b) {
      const double phi = (b + 0.5) * kPiD / kBins;
      for (const double center : {e.phi, -e.phi}) {
        const double x = std::remainder(phi - center, 2 * kPiD) / beta_n;
        exact[static_cast<std::size_t>(b)] += 0.5 * w * std::exp(-0.5 * x * x) / (beta_n * std::sqrt(2 * kPiD));
      }
    }
  }
  double distance = 0;
  for (int b = 0; b < kBins; ++b) {
    const float c = static_cast<float>(std::cos((b + 0.5) * kPiD / kBins));
    const float n = order == 1 ? scatter_pair_value(l.n_tt, -c, scatter_sin_phi(c), 0)
                               : scatter_pair_value(l.n_trt, c, scatter_sin_phi(c), 0);
    distance += std::fabs(n - exact[static_cast<std::size_t>(b)] / energy) * kPiD / kBins;
  }
  return distance;  // half of the L1 distance over the whole circle: the share of energy that sits elsewhere
}

TEST(Scatter, AzimuthalShapeWithinItsBound) {
  double worst = 0;
  for (const float theta : {0.f, 0.4f, 0.8f, 1.2f}) {
    for (const float sigma_a : {0.f, 0.3f, 2.f}) {
      for (const float beta_n : {0.17f, 0.26f, 0.6f}) {
        for (const std::size_t order : {1u, 2u}) {
          const double d = shape_distance(1.55f, theta, sigma_a, beta_n, order);
          EXPECT_LE(d, kPairMaxMisplaced) << "theta " << theta << " sigma_a " << sigma_a << " beta_n " << beta_n << " order "
                                          << order;
          worst = std::max(worst, d);
        }
      }
    }
  }
  std::printf("azimuthal shape: at most %.3f of the energy misplaced\n", worst);
}

// Tilt: the highlight R moves toward the root (negative theta), TRT toward the tip.
TEST(Scatter, TiltMovesRTowardTheRootAndTrtTowardTheTip) {
  const float tilt = 0.0524f;
  const ScatterLobes l = scatter_prepare_marschner(scatter_fiber(1.55f, 0.02f, 0.26f, tilt, 1, {0, 0, 0}), 0, 1);
  const auto peak = [](const ScatterCone& c) {
    float best = 0, at = 0;
    for (float theta = -0.5f; theta < 0.5f; theta += 0.001f) {
      const float m = scatter_cone_value(c, std::sin(theta), std::cos(theta));
      if (m > best) best = m, at = theta;
    }
    return at;
  };
  EXPECT_NEAR(peak(l.r), -2 * tilt, 2e-3);
  EXPECT_NEAR(peak(l.tt), tilt, 2e-3);
  EXPECT_NEAR(peak(l.trt), 3 * tilt, 2e-3);
}

// The whole domain, its ends more often than the rest: finite and not negative.
TEST(Scatter, FiniteAndNotNegativeEverywhere) {
  for (std::uint32_t i = 0; i < 300000; ++i) {
    Rng rng(11, i);
    const auto draw = [&](float lo, float hi) {
      const float which = rng.uniform(), u = rng.uniform();
      return which < 0.15f ? lo : which < 0.3f ? hi : lo + (hi - lo) * u;
    };
    const float half_pi = 1.57079633f;
    const Vec3 sigma(draw(0, 50), draw(0, 5), draw(0, 1));
    const ScatterFiber f =
        scatter_fiber(draw(1.05f, 2.5f), draw(0, 1), draw(0, 1.5f), draw(-0.0873f, 0.0873f), draw(0, 3), sigma);
    const float theta_o = draw(-half_pi, half_pi), theta_i = draw(-half_pi, half_pi), cos_phi = draw(-1, 1);
    const float si = std::sin(theta_i), ci = std::fabs(std::cos(theta_i));
    const ScatterLobes l = scatter_prepare_marschner(f, std::sin(theta_o), std::cos(theta_o));
    const ScatterLobes z = scatter_prepare_zhu(f, std::sin(theta_o), std::cos(theta_o));
    const ScatterAverages a = scatter_averages(l);
    const ScatterBack b = scatter_back(a, l.sin_o, l.cos_o);
    const float n = draw(0, 100), v = scatter_dual_variance(n, a.v_f);
    const Vec3 all[] = {scatter_marschner(l, si, ci, cos_phi),
                        scatter_zhu(z, si, ci, cos_phi),
                        scatter_kajiya_kay(l, scatter_tuft_color(sigma, 0.3f), si, ci),
                        scatter_dual_forward_marschner(l, v, si, ci, cos_phi),
                        scatter_dual_forward_zhu(z, v, si, ci, cos_phi),
                        scatter_dual_local(b, v, si, ci, cos_phi),
                        scatter_dual_transmittance(n, a.a_f),
                        a.a_f,
                        a.a_b,
                        b.a};
    for (const Vec3& x : all) {
      ASSERT_TRUE(is_finite(x)) << "case " << i << " value " << (&x - all);
      ASSERT_GE(std::min(x.x, std::min(x.y, x.z)), 0) << "case " << i << " value " << (&x - all);
    }
  }
}

TEST(Scatter, CrossingAFiberLeavesTheMeanOverItsOffsets) {
  for (float sigma = 0; sigma < 8; sigma += 0.05f) {
    double mean = 0;
    for (int i = 0; i < 400; ++i) {
      const double h = (i + 0.5) / 400;
      mean += std::exp(-2 * static_cast<double>(sigma) * std::sqrt(1 - h * h / (1.55 * 1.55))) / 400;
    }
    EXPECT_NEAR(scatter_crossing_color({sigma, 0, 0}).x, mean, kCrossingColorMaxAbsError) << sigma;
  }
}

TEST(Scatter, ColorsInvertAndDarkenWithMelanin) {
  for (const float beta_n : {0.05f, 0.26f, 0.8f}) {
    for (float c = 0.01f; c < 0.99f; c += 0.01f) {
      const Vec3 back = scatter_tuft_color(scatter_absorption({c, c * c, 0.5f}, beta_n), beta_n);
      EXPECT_NEAR(back.x, c, 1e-4);
      EXPECT_NEAR(back.y, c * c, 1e-4);
      EXPECT_NEAR(back.z, 0.5f, 1e-4);
    }
  }
  const Vec3 black = scatter_tuft_color(scatter_melanin(8, 0), 0.26f),
             blond = scatter_tuft_color(scatter_melanin(0.1f, 0), 0.26f);
  EXPECT_LT(black.x, 0.1f);
  EXPECT_GT(blond.x, 0.25f);
  EXPECT_GT(blond.x, blond.y);
  EXPECT_GT(blond.y, blond.z);
  EXPECT_EQ(scatter_melanin(0, 0), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace pelage::kernel
