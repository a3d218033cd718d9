// The table of mean forward attenuation: its bound, against adaptive quadrature of traced rays' shares.
#include "frame/dual_scattering_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "oracle/fiber_oracle.h"

namespace pelage {
namespace {

// Adaptive Simpson over gamma_i = asin(h) of the exact share that goes forward (Marschner's lobes, unblurred).
double forward_integrand(double gamma, double cos_theta, double eta, double sigma_a) {
  const auto exits = oracle::trace<400>(cos_theta, std::sin(gamma), eta, sigma_a);
  double sum = 0;
  for (std::size_t k = 0; k < exits.size(); ++k) {
    sum += exits[k].energy * (k > 2 ? 0.5 : std::fabs(exits[k].phi) / std::numbers::pi);
  }
  return sum * std::cos(gamma);
}
double adaptive(double a, double b, double fa, double fm, double fb, double tolerance, int depth, auto&& f) {
  const double m = 0.5 * (a + b), fl = f(0.5 * (a + m)), fr = f(0.5 * (m + b));
  const double coarse = (b - a) / 6 * (fa + 4 * fm + fb), fine = (b - a) / 12 * (fa + 4 * fl + 2 * fm + 4 * fr + fb);
  if (depth == 0 || std::fabs(fine - coarse) < 15 * tolerance) return fine;
  return adaptive(a, m, fa, fl, fm, tolerance / 2, depth - 1, f) + adaptive(m, b, fm, fr, fb, tolerance / 2, depth - 1, f);
}
double exact_forward(double cos_theta, double eta, double sigma_a) {
  const auto f = [&](double gamma) { return forward_integrand(gamma, cos_theta, eta, sigma_a); };
  const double a = 1e-9, b = std::numbers::pi / 2 - 1e-9;
  return adaptive(a, b, f(a), f(0.5 * (a + b)), f(b), 1e-6, 12, f);
}

TEST(ForwardAttenuationTable, WithinItsBoundOfAdaptiveQuadrature) {
  HairMaterial m;
  m.beta_azimuthal = 1e-4f;
  const ForwardAttenuationTable table = forward_attenuation_table(m);
  double worst = 0;
  for (const double cos_theta : {0.02, 0.05, 0.11, 0.28, 0.5, 0.71, 0.93, 1.0}) {
    for (const double sigma_a : {0.0, 0.04, 0.15, 0.5, 1.3, 4.0, 11.0}) {
      const double exact = exact_forward(cos_theta, m.eta, sigma_a);
      const double error = table.lookup(static_cast<float>(cos_theta), static_cast<float>(sigma_a)) - exact;
      EXPECT_LE(std::fabs(error), kernel::kScatterTableMaxAbsError) << cos_theta << " " << sigma_a;
      EXPECT_NEAR(forward_attenuation(m, cos_theta, sigma_a), exact, 3e-4) << cos_theta << " " << sigma_a;
      worst = std::max(worst, std::fabs(error));
    }
  }
  std::printf("table of a_f: worst error %.2e\n", worst);
}

// Between the nodes and with the blur, for every model: bilinear interpolation against the quadrature itself.
TEST(ForwardAttenuationTable, InterpolatesWithinItsBoundForEveryModel) {
  for (const auto model : {HairMaterial::Model::kMarschner, HairMaterial::Model::kZhu, HairMaterial::Model::kChiang}) {
    for (const float beta_n : {0.05f, 0.26f, 0.9f}) {
      HairMaterial m;
      m.model = model, m.beta_azimuthal = beta_n;
      const ForwardAttenuationTable table = forward_attenuation_table(m);
      for (double cos_theta = 0.02; cos_theta <= 1; cos_theta += 0.0531) {
        for (double x = 0.02; x <= 1; x += 0.0473) {
          const double sigma_a = -2 * std::log(x);
          EXPECT_NEAR(table.lookup(static_cast<float>(cos_theta), static_cast<float>(sigma_a)),
                      forward_attenuation(m, cos_theta, sigma_a), kernel::kScatterTableMaxAbsError)
              << static_cast<int>(model) << " " << beta_n << " " << cos_theta << " " << sigma_a;
        }
      }
    }
  }
}

// The lobes that are shaded with and the table agree: one fiber.
TEST(ForwardAttenuationTable, AgreesWithTheLobesOfTheKernel) {
  for (const auto model : {HairMaterial::Model::kMarschner, HairMaterial::Model::kZhu, HairMaterial::Model::kChiang}) {
    HairMaterial m;
    m.model = model;
    const ForwardAttenuationTable table = forward_attenuation_table(m);
    for (float theta = 0; theta < 1.5f; theta += 0.1f) {
      const kernel::ScatterFiber f =
          kernel::scatter_fiber(m.eta, m.beta_longitudinal, m.beta_azimuthal, m.cuticle_tilt, 1, {0.1f, 0.5f, 1.5f});
      const float s = std::sin(theta), c = std::cos(theta);
      const kernel::ScatterLobes l = model == HairMaterial::Model::kZhu      ? kernel::scatter_prepare_zhu(f, s, c)
                                     : model == HairMaterial::Model::kChiang ? kernel::scatter_prepare_chiang_far(f, s, c)
                                                                             : kernel::scatter_prepare_marschner(f, s, c);
      const kernel::ScatterAverages a = kernel::scatter_averages(l);
      const float bound = kernel::kDualAverageMaxAbsError + kernel::kScatterTableMaxAbsError;
      EXPECT_NEAR(table.lookup(c, 0.1f), a.a_f.x, bound) << theta;
      EXPECT_NEAR(table.lookup(c, 0.5f), a.a_f.y, bound) << theta;
      EXPECT_NEAR(table.lookup(c, 1.5f), a.a_f.z, bound) << theta;
    }
  }
}

TEST(ForwardAttenuationTable, EndsOfItsDomain) {
  HairMaterial m;
  const ForwardAttenuationTable table = forward_attenuation_table(m);
  for (const float c : {0.f, 1.f, -1.f, 2.f}) {
    for (const float sigma : {0.f, 1e30f, -1.f}) {
      EXPECT_GE(table.lookup(c, sigma), 0);
      EXPECT_LE(table.lookup(c, sigma), 1);
    }
  }
}

}  // namespace
}  // namespace pelage
