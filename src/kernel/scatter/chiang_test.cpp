// Chiang's near-field model against pbrt-v4's records, and its mean over the fiber against the far field.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/scalar.h"
#include "kit/io_kit.h"
#include "kit/sphere_kit.h"
#include "oracle/fiber_oracle.h"

namespace pelage::kernel {
namespace {

constexpr float kRadian = 3.14159265f / 180;

struct Record {
  float h, eta, sigma_a, beta_m, beta_n, alpha_degrees;
  Vec3 wo, wi;  // x along the fiber
  float value, pdf;
};

std::vector<Record> read_records(const std::string& path) {
  const std::string bytes = kit::slurp(path);
  std::vector<Record> records;
  for (std::size_t at = 0; at + 14 * sizeof(float) <= bytes.size(); at += 14 * sizeof(float)) {
    float x[14];
    std::memcpy(x, bytes.data() + at, sizeof x);
    records.push_back({x[0], x[1], x[2], x[3], x[4], x[5], {x[6], x[7], x[8]}, {x[9], x[10], x[11]}, x[12], x[13]});
  }
  return records;
}

// pbrt's tilt moves R by +2 alpha of theta_i + theta_o along x: its x axis is our direction from tip to root.
ScatterNear prepared(const Record& r) {
  const ScatterFiber f = scatter_fiber(r.eta, scatter_chiang_beta_m(r.beta_m), scatter_chiang_beta_n(r.beta_n),
                                       -r.alpha_degrees * kRadian, 1, v_splat(r.sigma_a));
  return scatter_prepare_chiang(f, r.wo.x, std::sqrt(std::max(0.f, 1 - r.wo.x * r.wo.x)), r.h);
}
ScatterNear isolated(ScatterNear n, int lobe) {
  const Vec3 none(0, 0, 0);
  if (lobe != 0) n.a_r = 0;
  if (lobe != 1) n.a_tt = none;
  if (lobe != 2) n.a_trt = none;
  if (lobe != 3) n.a_rest = none;
  return n;
}

// I0 as pbrt-v4 has it: ten terms of the series, above 12 an asymptote with half of its first correction. It is up to 2 %
// away from I0.
double pbrt_log_i0(double x) {
  if (x > 12) return x + 0.5 * (-std::log(2 * std::numbers::pi) + std::log(1 / x) + 1 / (8 * x));
  double sum = 0, term = 1;
  for (int i = 0; i < 10; ++i) sum += term, term *= x * x / (4. * (i + 1) * (i + 1));
  return std::log(sum);
}
double log_i0(double x) {
  if (x > 500) return x - 0.5 * std::log(2 * std::numbers::pi * x) + 1 / (8 * x);
  return std::log(std::cyl_bessel_i(0, x));
}

TEST(Chiang, AgreesWithPbrt) {
  PELAGE_NEEDS(path, "../oracles/chiang2016_pbrt-v4_20k.f32");
  double worst_value = 0, worst_pdf = 0, worst_exact = 0;
  int compared = 0, exact_within = 0;
  const std::vector<Record> records = read_records(path);
  for (const Record& r : records) {
    if (r.value <= 1e-4f) continue;
    const ScatterNear n = prepared(r);
    const ScatterChoice choice = scatter_choice_chiang(n);
    const float sin_i = r.wi.x, cos_i = std::sqrt(std::max(0.f, 1 - sin_i * sin_i));
    const float phi = std::atan2(r.wi.z, r.wi.y) - std::atan2(r.wo.z, r.wo.y);
    const ScatterCone* const cones[] = {&n.r, &n.tt, &n.trt, &n.rest};
    const float energies[] = {n.a_r, n.a_tt.x, n.a_trt.x, n.a_rest.x},
                chances[] = {choice.r, choice.tt, choice.trt, choice.rest};
    double value = 0, pdf = 0;
    for (int lobe = 0; lobe < 4; ++lobe) {
      if (!(energies[lobe] > 0)) continue;
      const double x = cos_i * cones[lobe]->cos_o * cones[lobe]->inv_v;
      const double as_pbrt = scatter_chiang(isolated(n, lobe), sin_i, cos_i, phi).x * std::exp(pbrt_log_i0(x) - log_i0(x));
      value += as_pbrt, pdf += as_pbrt * chances[lobe] / energies[lobe];
    }
    const double exact = scatter_chiang(n, sin_i, cos_i, phi).x;
    ++compared;
    worst_value = std::max(worst_value, std::fabs(value / r.value - 1));
    worst_pdf = std::max(worst_pdf, std::fabs(pdf / r.pdf - 1));
    worst_exact = std::max(worst_exact, std::fabs(exact / r.value - 1));
    exact_within += std::fabs(exact / r.value - 1) < 1e-3;
    ASSERT_NEAR(value / r.value, 1, 1e-3) << "record " << &r - records.data();
    ASSERT_NEAR(pdf / r.pdf, 1, 1e-3) << "record " << &r - records.data();
    ASSERT_NEAR(scatter_pdf_chiang(n, choice, sin_i, cos_i, phi) * (n.a_r + n.a_tt.x + n.a_trt.x + n.a_rest.x), exact,
                1e-4 * exact);
  }
  EXPECT_GT(compared, 1000);
  EXPECT_LT(worst_exact, 0.025);
  std::printf(
      "%d records: with pbrt's Bessel function value within %.1e and pdf within %.1e; with the exact one %.1f %% within "
      "1e-3, the worst %.1e\n",
      compared, worst_value, worst_pdf, 100. * exact_within / compared, worst_exact);
}

TEST(Chiang, LobesIntegrateToTheirEnergies) {
  double worst = 0;
  for (const float beta : {0.1f, 0.3f, 0.9f}) {
    for (const float h : {-0.95f, 0.f, 0.6f}) {
      for (const float theta : {-1.4f, -0.3f, 0.8f}) {
        const ScatterFiber f =
            scatter_fiber(1.55f, scatter_chiang_beta_m(beta), scatter_chiang_beta_n(beta), 0.07f, 1, {0, 0.3f, 2});
        const ScatterNear n = scatter_prepare_chiang(f, std::sin(theta), std::cos(theta), h);
        EXPECT_NEAR(n.a_r + n.a_tt.x + n.a_trt.x + n.a_rest.x, 1, 1e-5) << "nothing is absorbed";
        const float energies[] = {n.a_r, n.a_tt.y, n.a_trt.y, n.a_rest.y};
        for (int lobe = 0; lobe < 4; ++lobe) {
          const ScatterNear only = isolated(n, lobe);
          const double got = kit::sphere_integral(
              [&](double t, double p) {
                return scatter_chiang(only, static_cast<float>(std::sin(t)), static_cast<float>(std::cos(t)),
                                      static_cast<float>(p))
                    .y;
              },
              400, 400);
          const float energy = energies[lobe];
          EXPECT_NEAR(got, energy, 2e-3 * energy + 1e-7)
              << "lobe " << lobe << " beta " << beta << " h " << h << " theta " << theta;
          worst = std::max(worst, std::fabs(got / energy - 1));
        }
      }
    }
  }
  std::printf("integrals of Chiang's lobes: worst relative error %.1e\n", worst);
}

// Rays that the oracle traces from the eye's direction leave where and as bright as the lobes say; its offset has the other
// sign.
TEST(Chiang, LeavesWhereTracedRaysLeave) {
  for (const float theta : {0.f, 0.7f, 1.3f}) {
    for (const float h : {-0.9f, -0.3f, 0.1f, 0.8f}) {
      const ScatterFiber f = scatter_fiber(1.55f, 0.1f, 0.2f, 0, 1, v_splat(0.4f));
      const ScatterNear n = scatter_prepare_chiang(f, std::sin(theta), std::cos(theta), h);
      const auto exits = oracle::trace<200>(std::cos(theta), -h, 1.55, 0.4f);
      const float phi[] = {n.phi_r, n.phi_tt, n.phi_trt}, energy[] = {n.a_r, n.a_tt.x, n.a_trt.x, n.a_rest.x};
      double rest = 0;
      for (std::size_t p = 3; p < exits.size(); ++p) rest += exits[p].energy;
      for (std::size_t p = 0; p < 3; ++p) {
        EXPECT_NEAR(std::remainder(phi[p] - exits[p].phi, 2 * std::numbers::pi), 0, 1e-4) << "order " << p << " h " << h;
        EXPECT_NEAR(energy[p], exits[p].energy, 1e-5) << "order " << p << " h " << h;
      }
      EXPECT_NEAR(energy[3], rest, 1e-5) << h;
    }
  }
}

TEST(Chiang, TurningTheOffsetOverMirrorsTheAzimuth) {
  const ScatterFiber f = scatter_fiber(1.55f, 0.1f, 0.2f, 0.05f, 1, {0.1f, 0.2f, 0.4f});
  const ScatterNear a = scatter_prepare_chiang(f, 0.3f, std::sqrt(0.91f), 0.7f),
                    b = scatter_prepare_chiang(f, 0.3f, std::sqrt(0.91f), -0.7f);
  for (float phi = -3; phi < 3; phi += 0.1f)
    EXPECT_NEAR(scatter_chiang(a, -0.2f, std::sqrt(0.96f), phi).y, scatter_chiang(b, -0.2f, std::sqrt(0.96f), -phi).y, 1e-5f);
}

// What raster shades with: the share of the energy that the mean over the fiber has elsewhere.
TEST(Chiang, FarFieldWithinItsBoundOfTheMeanOverTheFiber) {
  double worst = 0;
  for (const float beta_n : {0.17f, 0.26f, 0.6f}) {
    for (const float sigma_a : {0.f, 0.3f, 2.f}) {
      for (const float theta : {-1.2f, -0.5f, 0.f}) {
        const ScatterFiber f = scatter_fiber(1.55f, 0.13f, beta_n, 0.05f, 1, v_splat(sigma_a));
        const float sin_o = std::sin(theta), cos_o = std::cos(theta);
        const ScatterLobes far = scatter_prepare_chiang_far(f, sin_o, cos_o);
        std::vector<ScatterNear> nodes;
        constexpr int kNodes = 120;
        for (int i = 0; i < kNodes; ++i) nodes.push_back(scatter_prepare_chiang(f, sin_o, cos_o, 2 * (i + 0.5f) / kNodes - 1));
        double energy = 0;
        const double distance = kit::sphere_integral(
            [&](double t, double p) {
              const float s = static_cast<float>(std::sin(t)), c = static_cast<float>(std::cos(t));
              double mean = 0;
              for (const ScatterNear& n : nodes) mean += scatter_chiang(n, s, c, static_cast<float>(p)).x / kNodes;
              energy += mean * c;
              return std::fabs(mean - scatter_marschner(far, s, c, static_cast<float>(std::cos(p))).x);
            },
            60, 72);
        energy *= 2 * std::numbers::pi * std::numbers::pi / (60 * 72);
        const double misplaced = 0.5 * distance / energy;
        EXPECT_LE(misplaced, kFarChiangMaxMisplaced) << "beta_n " << beta_n << " sigma_a " << sigma_a << " theta " << theta;
        worst = std::max(worst, misplaced);
      }
    }
  }
  std::printf("far field of Chiang's model: at most %.3f of the energy misplaced\n", worst);
}

// Chiang 2016, eq. 7 and 8, in double.
TEST(Chiang, RoughnessesAreThePapers) {
  for (double b = 0.01; b <= 1; b += 0.01) {
    const double v = std::pow(0.726 * b + 0.812 * b * b + 3.7 * std::pow(b, 20), 2);
    const double s = 0.626657069 * (0.265 * b + 1.194 * b * b + 5.372 * std::pow(b, 22));
    const float x = static_cast<float>(b);
    EXPECT_NEAR(4 * v_square(scatter_chiang_beta_m(x)), v, 1e-5 * v) << b;
    EXPECT_NEAR(scatter_chiang_beta_n(x), s * std::numbers::pi / std::sqrt(3.), 1e-5 * s) << b;
  }
}

}  // namespace
}  // namespace pelage::kernel
