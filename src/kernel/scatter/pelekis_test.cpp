// The fitted lobes against what they are fitted to, and their own promises.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "kernel/scalar.h"
#include "kit/sphere_kit.h"

namespace pelage::kernel {
namespace {

constexpr int kOffsets = 64;

/// Chiang's near field at evenly spaced offsets: its mean is the truth.
std::vector<ScatterNear> near_field(const ScatterFiber& f, float theta) {
  std::vector<ScatterNear> nodes;
  for (int i = 0; i < kOffsets; ++i)
    nodes.push_back(
        scatter_prepare_chiang(f, std::sin(theta), std::cos(theta), 2 * (static_cast<float>(i) + 0.5f) / kOffsets - 1));
  return nodes;
}
ScatterPelekis fitted(const ScatterFiber& f, float theta) {
  return scatter_prepare_pelekis(f, std::sin(theta), std::cos(theta));
}

/// Share of the energy of the mean of `nodes` that `f` has elsewhere on the sphere.
template <class Value>
double misplaced(const std::vector<ScatterNear>& nodes, const Value& value) {
  double energy = 0, distance = 0;
  constexpr int kThetas = 60, kPhis = 36;
  for (int i = 0; i < kThetas; ++i) {
    const float s = 2 * (static_cast<float>(i) + 0.5f) / kThetas - 1, c = std::sqrt(1 - s * s);  // even in solid angle
    for (int j = 0; j < kPhis; ++j) {
      const float phi = (static_cast<float>(j) + 0.5f) / kPhis * kPi;  // the mean over both signs of h is even
      double mean = 0;
      for (const ScatterNear& n : nodes) mean += static_cast<double>(scatter_chiang(n, s, c, phi).y);
      mean /= kOffsets;
      energy += mean, distance += std::fabs(mean - static_cast<double>(value(s, c, std::cos(phi))));
    }
  }
  return 0.5 * distance / energy;
}

TEST(Pelekis, WithinItsBoundOfTheMeanOverTheFiber) {
  double worst = 0, sum = 0, worst_far = 0;
  int cases = 0;
  for (const float eta : {1.45f, 1.55f, 1.65f}) {
    for (const float beta_m : {0.06f, 0.25f}) {
      for (const float beta_n : {0.175f, 0.26f, 0.6f}) {
        for (const float sigma_a : {0.f, 0.3f, 2.f}) {
          for (const float theta : {-1.2f, 0.f, 0.8f}) {
            const ScatterFiber f = scatter_fiber(eta, beta_m, beta_n, 0.05f, 1, v_splat(sigma_a));
            const std::vector<ScatterNear> nodes = near_field(f, theta);
            const ScatterPelekis l = fitted(f, theta);
            const double share =
                misplaced(nodes, [&](float s, float, float cos_phi) { return scatter_pelekis(l, s, cos_phi).y; });
            const ScatterLobes far = scatter_prepare_chiang_far(f, std::sin(theta), std::cos(theta));
            worst_far = std::max(worst_far, misplaced(nodes, [&](float s, float c, float cos_phi) {
                                   return scatter_marschner(far, s, c, cos_phi).y;
                                 }));
            EXPECT_LE(share, static_cast<double>(kPelekisMaxMisplaced))
                << "eta " << eta << " beta_m " << beta_m << " beta_n " << beta_n << " sigma_a " << sigma_a << " theta "
                << theta;
            worst = std::max(worst, share), sum += share, ++cases;
          }
        }
      }
    }
  }
  std::printf("Pelekis' lobes: %.3f of the energy misplaced on average, at most %.3f; Chiang's far field at most %.3f\n",
              sum / cases, worst, worst_far);
}

TEST(Pelekis, EnergiesWithinTheirBound) {
  double worst = 0;
  for (const float eta : {1.3f, 1.45f, 1.55f, 1.7f, 1.8f}) {
    for (float c = 0.05f; c <= 1; c += 0.05f) {
      for (const float sigma_a : {0.f, 0.1f, 0.4f, 1.3f, 5.f}) {
        const float theta = std::acos(std::min(c, 1.f));
        const ScatterFiber f = scatter_fiber(eta, 0.13f, 0.26f, 0, 1, v_splat(sigma_a));
        const ScatterPelekis l = fitted(f, theta);
        double r = 0, tt = 0, trt = 0, rest = 0;
        for (const ScatterNear& n : near_field(f, theta))
          r += static_cast<double>(n.a_r), tt += static_cast<double>(n.a_tt.x), trt += static_cast<double>(n.a_trt.x),
              rest += static_cast<double>(n.a_rest.x);
        const double errors[] = {l.a_r - r / kOffsets, l.a_tt.x - tt / kOffsets, l.a_trt.x - trt / kOffsets,
                                 l.a_rest.x - rest / kOffsets};
        for (const double e : errors) worst = std::max(worst, std::fabs(e));
      }
    }
  }
  EXPECT_LE(worst, static_cast<double>(kPelekisEnergyMaxAbsError));
  std::printf("energies of Pelekis' lobes: worst error %.4f\n", worst);
}

TEST(Pelekis, ClearFibersLoseNothing) {
  for (const float eta : {1.1f, 1.55f, 2.5f}) {
    for (float theta = -1.57f; theta < 1.57f; theta += 0.05f) {
      const ScatterPelekis l = fitted(scatter_fiber(eta, 0.13f, 0.26f, 0.05f, 1, v_splat(0)), theta);
      EXPECT_NEAR(l.a_r + l.a_tt.x + l.a_trt.x + l.a_rest.x, 1, 1e-6f) << eta << " " << theta;
      const ScatterPelekis dark = fitted(scatter_fiber(eta, 0.13f, 0.26f, 0.05f, 1, {0.1f, 1, 50}), theta);
      for (const auto lobe : {&ScatterPelekis::a_tt, &ScatterPelekis::a_trt, &ScatterPelekis::a_rest}) {
        EXPECT_LE((dark.*lobe).x, (l.*lobe).x);
        EXPECT_LE((dark.*lobe).y, (dark.*lobe).x);
        EXPECT_LE((dark.*lobe).z, (dark.*lobe).y);
        EXPECT_GE((dark.*lobe).z, 0);
      }
    }
  }
}

// Every longitudinal lobe and every pair is a distribution, at the ends of their parameters too.
TEST(Pelekis, LobesIntegrateToOne) {
  double worst = 0;
  for (const float v : {1e-3f, 0.02f, 0.3f, 2.f, 18.f}) {
    for (const float theta : {-1.57f, -1.3f, -0.4f, 0.f, 1.f, 1.5f}) {
      for (const float shift : {-0.2f, 0.f, 0.5f}) {
        const ScatterBand b = scatter_band(std::sin(theta), std::cos(theta), shift, std::sin(shift), std::cos(shift), v);
        double sum = 0;
        constexpr int kSteps = 20000;
        for (int i = 0; i < kSteps; ++i)
          sum += static_cast<double>(scatter_band_value(b, 2 * (static_cast<float>(i) + 0.5f) / kSteps - 1));
        worst = std::max(worst, std::fabs(sum * 2 / kSteps - 1));
      }
    }
  }
  for (const float w2 : {4e-4f, 0.01f, 0.3f, 2.f, 7.f, 100.f}) {
    for (const float tan2 : {0.f, 0.05f, 1.f}) {
      const ScatterFringe n = scatter_fringe(w2, tan2);
      double sum = 0, density = 0;
      constexpr int kSteps = 20000;
      for (int i = 0; i < kSteps; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) / kSteps * kPi;
        sum += static_cast<double>(scatter_fringe_value(n, std::cos(x), std::sin(x)));
        density += static_cast<double>(scatter_pdf_fringe(n, x));
      }
      const double step = 2 * std::numbers::pi / kSteps;
      worst = std::max({worst, std::fabs(sum * step - 1), std::fabs(density * step - 1)});
    }
  }
  EXPECT_LE(worst, 2e-3);
  std::printf("integrals of bands, pairs and their densities: worst error %.1e\n", worst);
}

TEST(Pelekis, PairsAreDrawnWithSmallWeights) {
  float worst = 0;
  for (const float w2 : {4e-4f, 0.01f, 0.1f, 0.3f, 1.f, 2.f, 7.f}) {
    const ScatterFringe n = scatter_fringe(w2, 0);
    for (float x = 0; x < 3.14f; x += 0.001f)
      worst = std::max(worst, scatter_fringe_value(n, std::cos(x), std::sin(x)) / scatter_pdf_fringe(n, x));
  }
  EXPECT_LE(worst, kPelekisPairMaxWeight);
  EXPECT_GE(worst, 1);
  std::printf("pairs: largest weight %.3f\n", static_cast<double>(worst));
}

// Dual scattering's averages against the integrals of the lobes: light that comes from phi_i leaves forward where
// |phi| > pi/2 from it, averaged over the eye's azimuth: a share |phi|/pi of what turns by phi.
TEST(Pelekis, FrontSharesAreThoseOfTheLobes) {
  double worst = 0;
  for (const float theta : {0.f, 0.4f, 0.9f, 1.3f}) {
    for (const float beta_n : {0.175f, 0.26f, 0.8f}) {
      const ScatterPelekis l = fitted(scatter_fiber(1.55f, 0.13f, beta_n, 0, 1, {0, 0.3f, 2}), theta);
      double r = 0, tt = 0, trt = 0;
      constexpr int kSteps = 4000;
      for (int i = 0; i < kSteps; ++i) {
        const float phi = (static_cast<float>(i) + 0.5f) / kSteps * kPi, c = std::cos(phi), s = std::sin(phi);
        const double weight = 2 * static_cast<double>(phi) / kSteps;
        r += weight * static_cast<double>(scatter_pelekis_reflection(l, c));
        tt += weight * static_cast<double>(scatter_fringe_value(l.n_tt, -c, s));
        trt += weight * static_cast<double>(scatter_fringe_value(l.n_trt, c, s));
      }
      const ScatterAverages a = scatter_averages_pelekis(l);
      const double expected = l.a_r * r + l.a_tt.y * tt + l.a_trt.y * trt + 0.5 * static_cast<double>(l.a_rest.y);
      EXPECT_NEAR(static_cast<double>(a.a_f.y), expected, static_cast<double>(kPelekisFrontMaxAbsError));
      EXPECT_NEAR(a.a_f.x + a.a_b.x, 1, 1e-5f);
      worst = std::max({worst, std::fabs(static_cast<double>(scatter_fringe_near(l.n_tt)) - tt),
                        std::fabs(1 - static_cast<double>(scatter_fringe_near(l.n_trt)) - trt)});
    }
  }
  EXPECT_LE(worst, static_cast<double>(kPelekisFrontMaxAbsError));
  std::printf("shares that go forward: worst error %.4f\n", worst);
}

}  // namespace
}  // namespace pelage::kernel
