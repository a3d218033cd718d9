// Dual scattering against sums written out, traced rays, and the two-flux solution of a half-space of hair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/rng.h"
#include "kernel/scalar.h"
#include "oracle/fiber_oracle.h"

namespace pelage::kernel {
namespace {

constexpr double kPiD = std::numbers::pi;

ScatterFiber fiber_of(Vec3 sigma_a, float beta_n = 0.26f, float beta_m = 0.13f) {
  return scatter_fiber(1.55f, beta_m, beta_n, 0.0524f, 1, sigma_a);
}
ScatterLobes lobes_of(Vec3 sigma_a, float theta_o, float beta_n = 0.26f, float beta_m = 0.13f) {
  return scatter_prepare_marschner(fiber_of(sigma_a, beta_n, beta_m), std::sin(theta_o), std::cos(theta_o));
}

// Integral over the directions with phi in (-phi_max, phi_max).
template <class Value>
double integrate(Value&& value, double phi_max = kPiD, int thetas = 300, int phis = 300) {
  double sum = 0;
  for (int i = 0; i < thetas; ++i) {
    const double theta = kPiD * ((i + 0.5) / thetas - 0.5);
    const float s = static_cast<float>(std::sin(theta)), c = static_cast<float>(std::cos(theta));
    for (int j = 0; j < phis; ++j) {
      sum += std::cos(theta) * value(s, c, static_cast<float>(std::cos(phi_max * (j + 0.5) / phis)));
    }
  }
  return sum * kPiD / thetas * 2 * phi_max / phis;
}

// Share |x|/pi of an exit at phi after a Gaussian blur, by sampling the Gaussian.
double blurred_share(double phi, double beta) {
  double sum = 0, weight = 0;
  for (int i = -60; i <= 60; ++i) {
    const double x = i / 10.0, w = std::exp(-0.5 * x * x);
    sum += w * std::fabs(std::remainder(phi + x * beta, 2 * kPiD)) / kPiD, weight += w;
  }
  return sum / weight;
}

TEST(Dual, ForwardAndBackwardAveragesWithinTheirBoundOfTracedRays) {
  double worst = 0;
  for (const float beta_n : {0.02f, 0.26f, 0.7f}) {
    for (const float sigma_a : {0.f, 0.3f, 2.f}) {
      for (const float theta : {0.f, 0.5f, 1.f, 1.4f}) {
        double exact = 0, total = 0;
        constexpr int kRays = 400;
        for (int i = 0; i < kRays; ++i) {
          const double gamma = (i + 0.5) / kRays * kPiD / 2, w = std::cos(gamma) * kPiD / 2 / kRays;
          const auto exits = oracle::trace<200>(std::cos(theta), std::sin(gamma), 1.55, sigma_a);
          for (std::size_t k = 0; k < exits.size(); ++k) {
            total += w * exits[k].energy;
            // R is not blurred; paths after TRT leave uniformly.
            const double share = k == 0 ? std::fabs(exits[k].phi) / kPiD : k > 2 ? 0.5 : blurred_share(exits[k].phi, beta_n);
            exact += w * exits[k].energy * share;
          }
        }
        const ScatterAverages a = scatter_averages(lobes_of({sigma_a, sigma_a, sigma_a}, theta, beta_n));
        worst = std::max({worst, std::fabs(a.a_f.x - exact), std::fabs(a.a_b.x - (total - exact))});
        ASSERT_NEAR(a.a_f.x, exact, kDualAverageMaxAbsError) << beta_n << " " << sigma_a << " " << theta;
        ASSERT_NEAR(a.a_b.x, total - exact, kDualAverageMaxAbsError) << beta_n << " " << sigma_a << " " << theta;
      }
    }
  }
  std::printf("mean attenuations: worst error %.2e\n", worst);
}

// A_1 = sum over i >= 1 of a_b a_f^2i, A_3 = sum over i >= 1, j < i, k > j of a_b^3 a_f^2(i-j-1+k).
TEST(Dual, BackscatterIsTheSumOverItsPaths) {
  for (const float a_f : {0.05f, 0.4f, 0.8f}) {
    for (const float a_b : {0.02f, 0.2f}) {
      double sum = 0;
      for (int i = 1; i < 200; ++i) {
        sum += a_b * std::pow(a_f, 2 * i);
        for (int j = 0; j < i; ++j) {
          for (int k = j + 1; k < 200; ++k) sum += a_b * a_b * a_b * std::pow(static_cast<double>(a_f), 2 * (i - j - 1 + k));
        }
      }
      EXPECT_NEAR(scatter_back_energy(a_f, a_b), sum, 1e-5 * sum) << a_f << " " << a_b;
    }
  }
}

TEST(Dual, TransmittanceIsTheMeanOverPoissonCounts) {
  for (const float n : {0.f, 0.1f, 1.f, 5.f, 20.f}) {
    for (const float a_f : {0.f, 0.3f, 0.9f}) {
      double probability = std::exp(-static_cast<double>(n)), sum = 0;
      EXPECT_NEAR(scatter_dual_direct(n), probability, 1e-7);
      for (int k = 1; k < 200; ++k) probability *= n / k, sum += probability * std::pow(static_cast<double>(a_f), k);
      EXPECT_NEAR(scatter_dual_transmittance(n, {a_f, a_f, a_f}).x, kDualDensity * sum, 1e-6) << n << " " << a_f;
    }
  }
}

TEST(Dual, ForwardAndLocalLobesIntegrateToTheirEnergies) {
  for (const Vec3 sigma : {Vec3(0, 0.1f, 1), Vec3(0.5f, 2, 4)}) {
    for (const float theta : {-1.3f, -0.4f, 0.f, 0.8f}) {
      for (const float v : {0.f, 0.05f, 0.5f}) {
        const ScatterLobes l = lobes_of(sigma, theta);
        const ScatterLobes z = scatter_prepare_zhu(fiber_of(sigma), std::sin(theta), std::cos(theta));
        const ScatterBack b = scatter_back(scatter_averages(l), l.sin_o, l.cos_o);
        const double marschner = l.a_r + l.a_tt.y + l.a_trt.y + l.a_rest.y, zhu = z.a_r + z.a_tt.y + z.a_rest.y;
        EXPECT_NEAR(integrate([&](float s, float c, float p) { return scatter_dual_forward_marschner(l, v, s, c, p).y; }),
                    marschner, 0.01 * marschner);
        EXPECT_NEAR(integrate([&](float s, float c, float p) { return scatter_dual_forward_zhu(z, v, s, c, p).y; }), zhu,
                    0.01 * zhu);
        EXPECT_NEAR(integrate([&](float s, float c, float p) { return scatter_dual_local(b, v, s, c, p).y; }),
                    2 * kDualDensity * b.a.y, 0.01 * 2 * kDualDensity * b.a.y);
      }
    }
  }
}

ScatterArtist artist_of(float theta_o, float around = 0.26f, float angle = 0.6f) {
  ScatterArtistFiber f;
  f.a_r = {0.1f, 0.1f, 0.1f}, f.a_tt = {0.5f, 0.4f, 0.3f}, f.a_trt = {0.1f, 0.2f, 0.1f}, f.a_glint = {0.05f, 0.1f, 0.02f};
  f.shift_r = -0.05f, f.shift_tt = 0.025f, f.shift_trt = 0.08f;
  f.width_r = 0.13f, f.width_tt = 0.07f, f.width_trt = 0.26f;
  f.around_tt = around, f.around_glint = 0.5f * around, f.glint_angle = angle;
  return scatter_prepare_sadeghi(f, {1, 0.8f, 0.6f}, std::sin(theta_o), std::cos(theta_o));
}

// Zinke 2008, eq. 6 written out over the lobes themselves: of what leaves at phi the share |phi|/pi goes forward.
TEST(Dual, SadeghisAveragesAreTheIntegralsOfHisLobes) {
  double worst = 0;
  for (const float around : {0.1f, 0.26f, 0.8f}) {
    for (const float angle : {0.f, 0.6f, 1.4f}) {
      const ScatterArtist l = artist_of(0, around, angle);
      double forward = 0, backward = 0;
      const auto add = [&](float s, float c, float p) {
        const double value = scatter_sadeghi(l, s, c, p).y, share = std::acos(p) / kPiD;
        forward += value * share * c, backward += value * (1 - share) * c;
        return value;
      };
      integrate(add);
      const double step = kPiD / 300 * 2 * kPiD / 300;
      const ScatterAverages a = scatter_averages_sadeghi(l);
      worst = std::max({worst, std::fabs(a.a_f.y - forward * step), std::fabs(a.a_b.y - backward * step)});
      EXPECT_NEAR(a.a_f.y, forward * step, kDualAverageMaxAbsError) << around << " " << angle;
      EXPECT_NEAR(a.a_b.y, backward * step, kDualAverageMaxAbsError) << around << " " << angle;
      EXPECT_NEAR(a.a_f.x + a.a_b.x, l.a_r.x + l.a_tt.x + l.a_trt.x + l.a_glint.x, 1e-6);
    }
  }
  std::printf("mean attenuations of Sadeghi's lobes: worst error %.2e\n", worst);
}

TEST(Dual, SadeghisForwardLobesIntegrateToTheirEnergies) {
  for (const float theta : {-1.3f, 0.f, 0.8f}) {
    for (const float v : {0.f, 0.05f, 0.5f}) {
      const ScatterArtist l = artist_of(theta);
      const double energy = l.a_r.y + l.a_tt.y + l.a_trt.y + l.a_glint.y;
      EXPECT_NEAR(integrate([&](float s, float c, float p) { return scatter_dual_forward_sadeghi(l, v, s, c, p).y; }), energy,
                  0.01 * energy);
    }
  }
}

// N^G of a pair, a logistic, against the mean of the pair over the half circle of azimuths that light comes from.
TEST(Dual, AveragedAzimuthalLobesWithinTheirBound) {
  double worst = 0;
  for (const float beta_n : {0.17f, 0.26f, 0.6f}) {
    for (const float theta : {0.f, 0.8f, 1.2f}) {
      const ScatterLobes l = lobes_of({0.2f, 0.2f, 0.2f}, theta, beta_n);
      double distance = 0;
      constexpr int kSteps = 180;
      for (int i = 0; i < kSteps; ++i) {
        const double phi = (i + 0.5) * kPiD / kSteps;
        double mean = 0;
        for (int j = 0; j < kSteps; ++j) {
          const float c = static_cast<float>(std::cos(phi + ((j + 0.5) / kSteps - 0.5) * kPiD));
          mean += scatter_pair_value(l.n_tt, -c, scatter_sin_phi(c), 0) / kSteps;
        }
        const float fast = scatter_half_circle(-scatter_pair_sharpness(l.n_tt), static_cast<float>(std::cos(phi)));
        distance += std::fabs(fast - mean) * kPiD / kSteps;
      }
      worst = std::max(worst, distance);
      EXPECT_LE(distance, kAveragedPairMaxMisplaced) << beta_n << " " << theta;
    }
  }
  std::printf("averaged azimuthal lobes: at most %.3f of the energy misplaced\n", worst);
}

// A_B with at most `events` backward events, an odd number: what a stack of fibers sends back is R = a_b + a_f^2 R/(1 - a_b R)
// but for its first fiber's a_b, here by powers of a_b.
double back_energy_to_order(double a_f, double a_b, int events) {
  std::vector<double> r(static_cast<std::size_t>(events) + 1), p = r;  // of R; of R/(1 - a_b R)
  // p_n = r_n + a_b sum r_k p_(n-k) has one event more than both, and r_n = a_f^2 p_n asks for p_n: solved for r_n.
  for (std::size_t n = 1; n < r.size(); n += 2) {
    double turned = 0;
    for (std::size_t k = 1; k + 1 < n; k += 2) turned += r[k] * p[n - 1 - k];
    r[n] = (n == 1 ? a_b : a_f * a_f * a_b * turned) / (1 - a_f * a_f);
    p[n] = r[n] + a_b * turned;
  }
  return std::accumulate(r.begin(), r.end(), 0.0) - a_b;
}
// The same for any number of them: the root of a_b R^2 - (1 + a_b^2 - a_f^2) R + a_b = 0.
double back_energy_of_all(double a_f, double a_b) {
  const double half = (1 + a_b * a_b - a_f * a_f) / 2;
  return (half - std::sqrt(std::max(half * half - a_b * a_b, 0.0))) / a_b - a_b;
}

// The furnace of docs/derivations/dual_scattering.md: a half-space of hair under light of radiance 1 from the front
// half circle; a strand at depth n (mean number of hairs before it) is seen with probability e^-n. The value is the
// radiance that leaves, averaged over the front half circle (phi_i and phi_o are uniform in it: phi has the weight 1 -
// |phi|/pi); two_flux is the exact one of the same a_f and a_b in two directions.
struct Furnace {
  double dual, two_flux;
};
// back: A_B of (a_f, a_b). density: d_f and d_b.
template <class Back>
Furnace half_space(float sigma_a, Back&& back, float density) {
  const ScatterLobes l = lobes_of({sigma_a, sigma_a, sigma_a}, 0);
  const ScatterAverages a = scatter_averages(l);
  ScatterBack b = scatter_back(a, l.sin_o, l.cos_o);
  b.a = v_splat(static_cast<float>(back(a.a_f.x, a.a_b.x)) * density / kDualDensity);
  Furnace furnace{};
  constexpr int kDepths = 60;
  for (int i = 0; i < kDepths; ++i) {
    const double seen = (i + 0.5) / kDepths;  // 1 - e^-n, uniform
    const float n = static_cast<float>(-std::log1p(-seen));
    const float v = scatter_dual_variance(n, a.v_f);
    const float direct = scatter_dual_direct(n), through = scatter_dual_transmittance(n, a.a_f).x * density / kDualDensity;
    furnace.dual += integrate(
                        [&](float s, float c, float p) {
                          const float f =
                              (scatter_marschner(l, s, c, p).x + scatter_dual_local(b, 0, s, c, p).x) * direct +
                              (scatter_dual_forward_marschner(l, v, s, c, p).x + scatter_dual_local(b, v, s, c, p).x) * through;
                          return f * (1 - std::acos(p) / kPiD);
                        },
                        kPiD, 60, 120) /
                    kDepths;
  }
  const double k = 1 - a.a_f.x, s = a.a_b.x;
  furnace.two_flux = (k - std::sqrt(std::max(k * k - s * s, 0.0))) / s;
  return furnace;
}
Furnace half_space(float sigma_a) { return half_space(sigma_a, scatter_back_energy, kDualDensity); }

// Where white hair's light is lost: three backward events are Zinke's whole sum, and each further pair adds less.
TEST(Dual, BackwardEventsByOrder) {
  for (const float a_f : {0.05f, 0.4f, 0.8f})
    for (const float a_b : {0.02f, 0.15f}) {
      EXPECT_NEAR(scatter_back_energy(a_f, a_b), back_energy_to_order(a_f, a_b, 3), 1e-5 * back_energy_to_order(a_f, a_b, 3));
      EXPECT_NEAR(back_energy_of_all(a_f, a_b), back_energy_to_order(a_f, a_b, 999), 1e-9) << a_f << " " << a_b;
    }
  const struct {
    const char* name;
    float sigma_a;
    double half_space[5];  // with 1, 3, 5, 7, any number of backward events
  } hairs[] = {{"white", 0, {0.437, 0.517, 0.558, 0.583, 0.762}},
               {"blond, green", scatter_melanin(0.1f, 0).y, {0.2725, 0.2892, 0.2926, 0.2934, 0.2937}},
               {"brown, green", scatter_melanin(1.3f, 0).y, {0.0360, 0.0360, 0.0360, 0.0360, 0.0360}}};
  for (const auto& hair : hairs) {
    const ScatterAverages a = scatter_averages(lobes_of({hair.sigma_a, hair.sigma_a, hair.sigma_a}, 0));
    for (int order = 0; order < 4; ++order) {
      const auto back = [&](float a_f, float a_b) { return back_energy_to_order(a_f, a_b, 2 * order + 1); };
      const double dual = half_space(hair.sigma_a, back, kDualDensity).dual;
      std::printf("%s, up to %d backward events: A_B %.4f, half-space %.4f\n", hair.name, 2 * order + 1, back(a.a_f.x, a.a_b.x),
                  dual);
      EXPECT_NEAR(dual, hair.half_space[order], 0.002 * dual);
    }
    const double all = half_space(hair.sigma_a, back_energy_of_all, kDualDensity).dual;
    std::printf("%s, any number: A_B %.4f, half-space %.4f, with d_f = d_b = 1 %.4f\n", hair.name,
                back_energy_of_all(a.a_f.x, a.a_b.x), all, half_space(hair.sigma_a, back_energy_of_all, 1).dual);
    EXPECT_NEAR(all, hair.half_space[4], 0.002 * all);
  }
}

TEST(Dual, WhiteFurnaceOfAHalfSpace) {
  const struct {
    const char* name;
    float eumelanin;
    Vec3 dual, two_flux;  // red, green, blue
  } cases[] = {{"white", 0, {0.517f, 0.517f, 0.517f}, {1, 1, 1}},
               {"blond", 0.1f, {0.352f, 0.289f, 0.199f}, {0.441f, 0.350f, 0.234f}},
               {"brown", 1.3f, {0.0606f, 0.0360f, 0.0214f}, {0.0682f, 0.0393f, 0.0222f}},
               {"black", 8, {0.0184f, 0.0182f, 0.0182f}, {0.0188f, 0.0186f, 0.0185f}}};
  for (const auto& c : cases) {
    const Vec3 sigma = scatter_melanin(c.eumelanin, 0);
    const Furnace red = half_space(sigma.x), green = half_space(sigma.y), blue = half_space(sigma.z);
    const double dual[] = {red.dual, green.dual, blue.dual}, two[] = {red.two_flux, green.two_flux, blue.two_flux};
    const float expected[] = {c.dual.x, c.dual.y, c.dual.z}, exact[] = {c.two_flux.x, c.two_flux.y, c.two_flux.z};
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(dual[k], expected[k], 0.01 * expected[k]) << c.name << " channel " << k;
      EXPECT_NEAR(two[k], exact[k], 0.01 * exact[k]) << c.name << " channel " << k;
      EXPECT_LE(dual[k], two[k]) << c.name << ": dual scattering makes light";
    }
  }
}

// The truth of that furnace, slanting ways and inclinations included: a walk through parallel hairs from the eye until it
// leaves through the front or dies out. Depth counts hairs met on a straight way inward; free paths are exponential in the
// normal plane, whatever theta is. Azimuth 0 looks straight out.
double walked_half_space(float sigma_a, int walks) {
  double sum = 0;
  for (int w = 0; w < walks; ++w) {
    std::uint32_t draw = 0;
    const auto next = [&] {
      const RandomBits r = pcg4d(static_cast<std::uint32_t>(w), draw++, 5, 2026);
      return Vec4(uniform_from_bits(r.x), uniform_from_bits(r.y), uniform_from_bits(r.z), uniform_from_bits(r.w));
    };
    double to_eye = kPiD * ((w + 0.5) / walks - 0.5), depth = 0, weight = 1;
    float sin_o = 0;
    for (int event = 0; event < 2000 && weight > 1e-4; ++event) {
      depth -= std::log1p(-static_cast<double>(next().x)) * std::cos(to_eye);
      if (depth <= 0) {
        sum += weight;
        break;
      }
      const float cos_o = std::sqrt(1 - sin_o * sin_o);
      const ScatterLobes l = scatter_prepare_marschner(fiber_of({sigma_a, sigma_a, sigma_a}), sin_o, cos_o);
      const ScatterChoice c = scatter_choice_of(l);
      const ScatterDirection d = scatter_sample_marschner(l, c, next());
      weight *= scatter_marschner(l, d.sin_i, d.cos_i, m_cos(d.phi)).x / scatter_pdf_marschner(l, c, d.sin_i, d.cos_i, d.phi);
      // On toward the light; from the next hair, this one lies where the eye is.
      to_eye += d.phi + kPiD, sin_o = -d.sin_i;
    }
  }
  return sum / walks;
}

// White hair needs no walk: what never dies comes out, 1.
TEST(Dual, HalfSpaceOfHairAgainstAWalk) {
  const struct {
    const char* name;
    float sigma_a;
    double dual, two_flux;  // largest error relative to the walk
  } cases[] = {{"blond, red", scatter_melanin(0.1f, 0).x, 0.15, 0.15},
               {"blond, green", scatter_melanin(0.1f, 0).y, 0.1, 0.17},
               {"blond, blue", scatter_melanin(0.1f, 0).z, 0.1, 0.17},
               {"brown, green", scatter_melanin(1.3f, 0).y, 0.1, 0.1},
               {"black, green", scatter_melanin(8, 0).y, 0.1, 0.1}};
  for (const auto& c : cases) {
    const double walked = walked_half_space(c.sigma_a, 20000);
    const Furnace furnace = half_space(c.sigma_a);
    std::printf("half-space, %s: walk %.4f, dual scattering %.4f (%+.1f %%), two fluxes %.4f (%+.1f %%)\n", c.name, walked,
                furnace.dual, 100 * (furnace.dual / walked - 1), furnace.two_flux, 100 * (furnace.two_flux / walked - 1));
    EXPECT_NEAR(furnace.dual / walked, 1, c.dual) << c.name;
    EXPECT_NEAR(furnace.two_flux / walked, 1, c.two_flux) << c.name;
  }
}

}  // namespace
}  // namespace pelage::kernel
