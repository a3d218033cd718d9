// Bundles of fibers: what rays meet in them against quadrature, and the aggregated models: energy, domain, limits, sums.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/rng.h"
#include "kernel/scalar.h"
#include "kit/sphere_kit.h"
#include "oracle/fiber_oracle.h"

namespace pelage::kernel {
namespace {

constexpr double kPiD = std::numbers::pi;

ScatterFiber fiber_of(Vec3 sigma_a, float beta_n = 0.26f, float beta_m = 0.13f, float tilt = 0.05f) {
  return scatter_fiber(1.55f, beta_m, beta_n, tilt, 1, sigma_a);
}
ScatterLobes lobes_of(bool zhu, const ScatterFiber& f, double theta) {
  const auto s = static_cast<float>(std::sin(theta)), c = static_cast<float>(std::cos(theta));
  return zhu ? scatter_prepare_zhu(f, s, c) : scatter_prepare_marschner(f, s, c);
}
Vec3 value_of(bool zhu, const ScatterAggregate& a, const ScatterShares& s, float sin_i, float cos_i, float cos_phi) {
  return zhu ? scatter_aggregate_zhu(a, s, sin_i, cos_i, cos_phi) : scatter_aggregate_marschner(a, s, sin_i, cos_i, cos_phi);
}
ScatterShares shares_of(bool ours, const ScatterAggregate& a, float cos_phi) {
  return ours ? scatter_shares(a, cos_phi) : scatter_shares_huang(a, scatter_terms_huang(), cos_phi);
}
ScatterAggregate aggregate_of(bool ours, const ScatterLobes& l, const ScatterBundle& b) {
  return ours ? scatter_prepare_aggregate(l, b) : scatter_prepare_huang(l, b, scatter_terms_huang());
}

/// Integral over the sphere of value(sin θ_i, cos θ_i, cos φ).
template <class Value>
Vec3 integrate(const Value& value, int thetas = 90, int phis = 60) {
  Vec3 sum(0, 0, 0);
  for (int j = 0; j < phis; ++j) {
    const auto cos_phi = static_cast<float>(std::cos(kPiD * (j + 0.5) / phis));
    for (int i = 0; i < thetas; ++i) {
      const double theta = kPiD * ((i + 0.5) / thetas - 0.5);
      const auto c = static_cast<float>(std::cos(theta));
      sum = sum + value(static_cast<float>(std::sin(theta)), c, cos_phi) * c;
    }
  }
  return sum * static_cast<float>(kPiD / thetas * 2 * kPiD / phis);
}
Vec3 energy_of(bool zhu, bool ours, const ScatterLobes& l, const ScatterBundle& b) {
  const ScatterAggregate a = aggregate_of(ours, l, b);
  return integrate([&](float s, float c, float p) { return value_of(zhu, a, shares_of(ours, a, p), s, c, p); });
}

TEST(Bundle, GapsWithinTheirBoundOfQuadrature) {
  double worst = 0;
  for (double c = 0; c < 400; c = 1.1 * c + 0.01) {
    double sum = 0;
    constexpr int kSteps = 4000;  // offsets h = sin t
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps * kPiD / 2;
      sum += std::exp(-c * std::cos(t)) * std::cos(t) * kPiD / 2 / kSteps;
    }
    worst = std::max(worst, std::fabs(static_cast<double>(scatter_bundle_gaps(static_cast<float>(c))) / sum - 1));
  }
  EXPECT_LE(worst, kGapsMaxRelError);
  std::printf("gaps: worst relative error %.1e\n", worst);
}

// Mean of e^-(loss x) over what the eye sees in an ellipse: eye toward +y, light at phi.
double visible_by_quadrature(const ScatterBundle& b, double phi, double loss) {
  const double wide = b.wide, deep = std::sqrt(static_cast<double>(b.deep2)), dx = std::sin(phi), dy = std::cos(phi);
  const double per_length = 2 * b.reach / (kPiD * wide * deep);  // mean crossings: reach/wide over the mean chord
  double sum = 0, weight = 0;
  constexpr int kCells = 300;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const double x = 2 * (i + 0.5) / kCells - 1, y = 2 * (j + 0.5) / kCells - 1;
      if (x * x + y * y >= 1) continue;
      const auto way = [&](double ex, double ey) {  // to the ellipse's edge
        const double ux = ex / wide, uy = ey / deep, a = ux * ux + uy * uy, h = x * ux + y * uy;
        return (-h + std::sqrt(h * h + a * (1 - x * x - y * y))) / a;
      };
      const double w = std::exp(-per_length * way(0, 1));
      sum += w * std::exp(-loss * per_length * way(dx, dy)), weight += w;
    }
  }
  return sum / weight;
}

TEST(Bundle, VisibleShareWithinItsBoundOfQuadrature) {
  double worst = 0, mean = 0;
  int count = 0;
  for (const float hairs : {2.f, 20.f, 60.f, 200.f}) {
    for (const auto& [wide, deep] : {std::pair(10.f, 10.f), std::pair(20.f, 5.f), std::pair(5.f, 20.f)}) {
      for (const double loss : {0.15, 0.5, 1.0}) {
        for (double phi = 0; phi <= kPiD; phi += kPiD / 8) {
          const ScatterBundle b = scatter_bundle_buffon(hairs, 1, wide, deep);
          ScatterWay w = scatter_bundle_way(b, static_cast<float>(std::cos(phi)));
          w.joint = 0;  // no two ways are one where hairs have no width
          const double exact = visible_by_quadrature(b, phi, loss);
          const double error = std::fabs(scatter_bundle_visible(b, w, static_cast<float>(loss)) - exact);
          EXPECT_LE(error, kVisibleMaxAbsError) << hairs << " " << wide << " " << loss << " " << phi << " exact " << exact;
          worst = std::max(worst, error), mean += error, ++count;
        }
      }
    }
  }
  std::printf("visible share: worst error %.3f, mean %.4f\n", worst, mean / count);
}

// Of light whose hairs each take `loss`, rays over a circle of hairs keep the mean of e^(-loss x), x the hairs on each.
TEST(Bundle, ClumpingIsWhatBundlesTakeOverWhatTheirHairsTake) {
  constexpr int kRays = 100000;
  for (const float hairs : {1.f, 20.f, 100.f}) {
    const ScatterBundle b = scatter_bundle_buffon(hairs, 1, 15, 15);
    for (const float loss : {0.05f, 0.3f, 1.f}) {
      double kept = 0;
      for (int i = 0; i < kRays; ++i) {
        const double h = (i + 0.5) / kRays;
        kept += std::exp(static_cast<double>(-loss * b.longest) * std::sqrt(1 - h * h)) / kRays;
      }
      const float crossings = scatter_bundle_crossings(b, -1);
      EXPECT_NEAR(1 - loss * crossings * scatter_bundle_clumping(b, loss), kept, static_cast<double>(kGapsMaxRelError) * kept)
          << hairs << " " << loss;
    }
  }
}

// Seen where the light stands, everything is lit.
TEST(Bundle, NothingIsShadedWhereTheLightStandsBehindTheEye) {
  for (const float hairs : {1.f, 10.f, 100.f}) {
    const ScatterBundle b = scatter_bundle_buffon(hairs, 1, 12, 20);
    EXPECT_NEAR(scatter_bundle_visible(b, scatter_bundle_way(b, 1), 1), 1, 2e-3f) << hairs;
  }
}

// The formulas as printed: rho = N r^2/(r_A r_B), n = rho l sqrt(N/(pi r_A r_B)), Buffon n = 2 r l N/(pi r_A r_B).
TEST(Bundle, CrossingsAreTheirFormulas) {
  const float hairs = 80, r = 0.5f, wide = 20, deep = 6;
  const double area = kPiD * wide * deep, rho = hairs * r * r / (wide * deep);
  const double chord = area / (2 * wide), side = area / (2 * deep);
  const ScatterBundle h = scatter_bundle_huang(hairs, r, wide, deep), b = scatter_bundle_buffon(hairs, r, wide, deep);
  EXPECT_NEAR(h.density, rho, 1e-6);
  EXPECT_NEAR(scatter_bundle_crossings(h, -1), rho * chord * std::sqrt(hairs / area), 1e-5);
  EXPECT_NEAR(scatter_bundle_crossings(b, -1), 2 * r * chord * hairs / area, 1e-5);
  // Light from phi = 0 and eye there too: the way between them runs across.
  EXPECT_NEAR(scatter_bundle_crossings(b, 1), 2 * r * side * hairs / area, 1e-5);
}

// A_1, A_3 of Zinke 2008 and A_1+ of eq. 10 as sums written out.
TEST(Aggregate, BackwardPathsAreTheirSums) {
  ScatterAggregateTerms t = scatter_terms_huang();
  for (const float a_f : {0.05f, 0.4f, 0.8f}) {
    for (const float a_b : {0.02f, 0.2f}) {
      double one = 0, side = 0, three = 0;
      for (int i = 1; i < 200; ++i) {
        one += a_b * std::pow(a_f, 2 * i);
        for (int j = 0; j < i; ++j) {
          for (int k = j + 1; k < 200; ++k) three += std::pow(a_b, 3) * std::pow(static_cast<double>(a_f), 2 * (i - j - 1 + k));
        }
      }
      for (int i = 1; i <= 5; ++i) side += 0.6 * a_b * std::pow(static_cast<double>(a_f), 2 * i - 1);
      const ScatterBackPaths p = scatter_back_paths(a_f, a_b, 5, t);
      EXPECT_NEAR(p.one, one, 1e-5 * one);
      EXPECT_NEAR(p.three, three, 1e-4 * three);
      EXPECT_NEAR(p.side, side, 1e-5 * side);
    }
  }
}

// a_F and a_B of the kernel are five-point sums; here what their error makes of A_1, A_3 and A_1+ (n = 4), against adaptive quadrature of
// traced rays. Largest in white hair, whose sums hardly converge.
constexpr double kPathsMaxAbsError = 1e-3;
TEST(Aggregate, PathsWithinTheirBoundOfAdaptiveQuadrature) {
  double worst = 0;
  for (const float sigma_a : {0.f, 0.05f, 0.3f, 2.f}) {
    for (const double theta : {0.0, 0.5, 1.0, 1.4}) {
      const auto forward_and_all = [&](double gamma) {
        const auto exits = oracle::trace<200>(std::cos(theta), std::sin(gamma), 1.55, static_cast<double>(sigma_a));
        Vec2 sum(0, 0);
        for (std::size_t k = 0; k < exits.size(); ++k) {
          const double share = k > 2 ? 0.5 : std::fabs(exits[k].phi) / kPiD;
          sum.x += static_cast<float>(exits[k].energy * share), sum.y += static_cast<float>(exits[k].energy);
        }
        return sum * static_cast<float>(std::cos(gamma));
      };
      const auto simpson = [](Vec2 a, Vec2 m, Vec2 b, float h) { return (a + m * 4.f + b) * (h / 6); };
      const auto adaptive = [&](auto&& self, double a, double b, Vec2 fa, Vec2 fm, Vec2 fb, int depth) -> Vec2 {
        const double m = 0.5 * (a + b);
        const Vec2 l = forward_and_all(0.5 * (a + m)), r = forward_and_all(0.5 * (m + b));
        const auto h = static_cast<float>(b - a);
        const Vec2 coarse = simpson(fa, fm, fb, h), fine = simpson(fa, l, fm, h / 2) + simpson(fm, r, fb, h / 2);
        if (depth == 0 || std::fabs(fine.x - coarse.x) + std::fabs(fine.y - coarse.y) < 1e-6f) return fine;
        return self(self, a, m, fa, l, fm, depth - 1) + self(self, m, b, fm, r, fb, depth - 1);
      };
      const double end = kPiD / 2 - 1e-9;
      const Vec2 exact = adaptive(adaptive, 0, end, forward_and_all(1e-9), forward_and_all(end / 2), forward_and_all(end), 12);
      const ScatterAverages m = scatter_averages(lobes_of(false, fiber_of({sigma_a, sigma_a, sigma_a}, 1e-3f), theta));
      const ScatterAggregateTerms t = scatter_terms_huang();
      const ScatterBackPaths ours = scatter_back_paths(m.a_f.x, m.a_b.x, 4, t),
                             truth = scatter_back_paths(exact.x, exact.y - exact.x, 4, t);
      for (const float error : {ours.one - truth.one, ours.three - truth.three, ours.side - truth.side}) {
        EXPECT_LE(std::fabs(error), kPathsMaxAbsError) << sigma_a << " " << theta;
        worst = std::max(worst, std::fabs(static_cast<double>(error)));
      }
    }
  }
  std::printf("energies of backward paths: worst error %.1e\n", worst);
}

// Eq. 14 as printed is negative below rho = 1/6 near 90 degrees. Ours are probabilities everywhere and the paper's where those are.
TEST(Aggregate, ShadowChancesAreProbabilities) {
  bool negative = false;
  for (float rho = 0; rho <= 1; rho += 0.02f) {
    for (float c = -1; c <= 1; c += 0.05f) {
      const Vec2 p = scatter_shadow_chances(rho, 0.2f, c);
      EXPECT_GE(std::min(p.x, p.y), 0);
      EXPECT_LE(p.x + p.y, 1 + 1e-6f);
      if (c < 0) continue;
      const float single = (1 - rho) * (1 - c), many = (1 - rho) * 0.2f, none = 1 - single - many;
      negative = negative || none < 0;
      if (none >= 0) {
        EXPECT_NEAR(p.x, single, 1e-6f);
        EXPECT_NEAR(p.y, none, 1e-6f);
      } else {
        EXPECT_EQ(p.y, 0);
        EXPECT_NEAR(p.x, single / (single + many), 1e-6f);
      }
    }
  }
  EXPECT_TRUE(negative);
}

struct Drawn {
  bool zhu, ours;
  ScatterFiber fiber;
  float theta;
  ScatterBundle bundle;
};
Drawn draw(std::uint32_t i, bool extremes) {
  Rng rng(31, i);
  const auto in = [&](float lo, float hi) {
    const float which = rng.uniform(), u = rng.uniform();
    return extremes && which < 0.2f ? lo : extremes && which < 0.4f ? hi : lo + (hi - lo) * u;
  };
  Drawn d;
  d.zhu = i % 2 == 0, d.ours = i / 2 % 2 == 0;
  const float dark = in(0, 1);
  const Vec3 sigma(in(0, 0.2f), in(0, 1), dark * dark * in(0, 20));
  d.fiber = scatter_fiber(extremes ? in(1.01f, 3) : 1.55f, in(extremes ? 0.002f : 0.05f, 0.6f),
                          in(extremes ? 0.009f : 0.1f, 1.5f), in(0, 0.2f), extremes ? in(0, 1) : 1, sigma);
  d.theta = in(extremes ? -1.5707963f : -1.2f, extremes ? 1.5707963f : 1.2f);
  const float hairs = std::exp(in(0, 9)), rho = std::exp(in(-9, -0.3f)), aspect = std::exp(in(-2, 2));
  const float scale = std::sqrt(hairs / rho) * 4e-5f;
  const auto make = in(0, 1) < 0.5f ? scatter_bundle_huang : scatter_bundle_buffon;
  d.bundle = make(hairs, 4e-5f, scale * std::sqrt(aspect), scale / std::sqrt(aspect));
  return d;
}

// White furnace: no bundle scatters more light than it gets.
TEST(Aggregate, NeverMakesLight) {
  float most[2] = {};
  for (std::uint32_t i = 0; i < 1500; ++i) {
    const Drawn d = draw(i, false);
    const Vec3 e = energy_of(d.zhu, d.ours, lobes_of(d.zhu, d.fiber, d.theta), d.bundle);
    EXPECT_LE(std::max({e.x, e.y, e.z}), 1)
        << i << (d.ours ? " ours" : " paper") << " n " << scatter_bundle_crossings(d.bundle, -1) << " theta " << d.theta;
    most[d.ours] = std::max({most[d.ours], e.x, e.y, e.z});
  }
  std::printf("furnace: most energy of ours %.4f, of the paper's %.4f\n", static_cast<double>(most[1]),
              static_cast<double>(most[0]));
}

// White hair gives nearly all of the light back.
TEST(Aggregate, WhiteHairLosesLittle) {
  for (const bool zhu : {true, false}) {
    for (const float hairs : {4.f, 30.f, 300.f}) {
      for (const auto& [wide, deep] : {std::pair(30.f, 30.f), std::pair(60.f, 15.f), std::pair(15.f, 60.f)}) {
        const Vec3 e =
            energy_of(zhu, true, lobes_of(zhu, fiber_of({0, 0, 0}), 0.3), scatter_bundle_buffon(hairs, 1, wide, deep));
        EXPECT_GT(e.x, 0.9f) << zhu << " " << hairs << " " << wide;
      }
    }
  }
}

TEST(Aggregate, FiniteAndNotNegativeEverywhere) {
  for (std::uint32_t i = 0; i < 40000; ++i) {
    const Drawn d = draw(i, true);
    const ScatterLobes l = lobes_of(d.zhu, d.fiber, d.theta);
    const ScatterAggregate a = aggregate_of(d.ours, l, d.bundle);
    Rng rng(5, i);
    for (int k = 0; k < 4; ++k) {
      const float phi = k == 0 ? 0 : k == 1 ? 3.14159265f : 6.2831853f * rng.uniform();
      const float theta_i = k == 2 ? 1.5707963f : 3.1415927f * (rng.uniform() - 0.5f);
      const float s = m_sin(theta_i), c = abs(m_cos(theta_i)), p = v_clamp(m_cos(phi), -1, 1);
      const Vec3 v = value_of(d.zhu, a, shares_of(d.ours, a, p), s, c, p);
      ASSERT_TRUE(is_finite(v) && std::min({v.x, v.y, v.z}) >= 0) << i << " " << k << ": " << v.x << " " << v.y << " " << v.z;
      const Vec3 z = scatter_aggregate_zhu_2023(l, d.bundle, static_cast<float>(k % 2), {0, 0, 0}, s, c, p);
      ASSERT_TRUE(is_finite(z) && std::min({z.x, z.y, z.z}) >= 0) << i << " " << k;
    }
  }
}

// Bundles of next to nothing scatter as their hairs do; ones through which no light comes have no light behind them.
TEST(Aggregate, Limits) {
  for (const bool zhu : {true, false}) {
    const ScatterLobes l = lobes_of(zhu, fiber_of({0.02f, 0.2f, 1}), 0.2);
    const ScatterBundle thin = scatter_bundle_buffon(1, 1, 100, 100), dense = scatter_bundle_buffon(20000, 1, 180, 180);
    const ScatterAggregate one = scatter_prepare_aggregate(l, thin), many = scatter_prepare_aggregate(l, dense);
    EXPECT_NEAR(scatter_bundle_coverage(thin), 0.02f, 1e-3f);
    EXPECT_NEAR(scatter_bundle_coverage(dense), 1, 1e-3f);
    for (double phi = 0; phi <= kPiD; phi += 0.3) {
      const auto p = static_cast<float>(std::cos(phi));
      for (const float theta_i : {-0.5f, -0.2f, 0.1f}) {
        const float s = m_sin(theta_i), c = m_cos(theta_i);
        const Vec3 single = zhu ? scatter_zhu(l, s, c, p) : scatter_marschner(l, s, c, p);
        const Vec3 v = value_of(zhu, one, scatter_shares(one, p), s, c, p);
        EXPECT_NEAR(v.y, single.y, 0.02f * single.y + 2e-3f) << zhu << " " << phi << " " << theta_i;
      }
    }
    const Vec3 behind = value_of(zhu, many, scatter_shares(many, -1), -l.sin_o, l.cos_o, -1);
    const Vec3 single = zhu ? scatter_zhu(l, -l.sin_o, l.cos_o, -1) : scatter_marschner(l, -l.sin_o, l.cos_o, -1);
    EXPECT_LT(behind.y, 0.02f * single.y) << zhu;
  }
}

// ---- Sampling

struct Sampler {
  bool zhu;
  ScatterAggregate a;
  ScatterAggregateChoice c;

  explicit Sampler(const Drawn& d)
      : zhu(d.zhu), a(aggregate_of(d.ours, lobes_of(d.zhu, d.fiber, d.theta), d.bundle)), c(scatter_choice_aggregate(a)) {}
  ScatterDirection sample(std::uint32_t i) const {
    const RandomBits r = pcg4d(i, 7, 1, 2);
    const Vec4 u(uniform_from_bits(r.x), uniform_from_bits(r.y), uniform_from_bits(r.z), uniform_from_bits(r.w));
    return zhu ? scatter_sample_aggregate_zhu(a, c, u) : scatter_sample_aggregate_marschner(a, c, u);
  }
  float pdf(float sin_i, float cos_i, float phi) const {
    return zhu ? scatter_pdf_aggregate_zhu(a, c, sin_i, cos_i, phi) : scatter_pdf_aggregate_marschner(a, c, sin_i, cos_i, phi);
  }
};
constexpr std::uint32_t kSamplers = 60;

TEST(AggregateSampling, DensityIntegratesToOne) {
  double worst = 0;
  for (std::uint32_t i = 0; i < kSamplers; ++i) {
    const Sampler s(draw(i, false));
    const double all = kit::sphere_integral(
        [&](double theta, double phi) {
          return s.pdf(static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta)), static_cast<float>(phi));
        },
        240, 120);
    EXPECT_NEAR(all, 1, 3e-3) << i;
    worst = std::max(worst, std::fabs(all - 1));
  }
  std::printf("integral of the density: worst error %.1e\n", worst);
}

TEST(AggregateSampling, DirectionsFollowTheirDensity) {
  double least = 1;
  for (std::uint32_t i = 0; i < kSamplers; ++i) {
    const Sampler s(draw(i, false));
    kit::SphereHistogram histogram(40, 40);
    for (std::uint32_t k = 0; k < 40000; ++k) {
      const ScatterDirection d = s.sample(k);
      histogram.add(std::asin(static_cast<double>(d.sin_i)), d.phi);
    }
    const double p = histogram.p_value(
        [&](double theta, double phi) {
          return s.pdf(static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta)), static_cast<float>(phi));
        },
        4);
    EXPECT_GT(p, 1e-4 / kSamplers) << i;
    least = std::min(least, p);
  }
  std::printf("chi-square: least p of %u cases %.2g\n", kSamplers, least);
}

// White furnace, sampled: the mean weight is the energy; ours has no large ones.
TEST(AggregateSampling, MeanWeightIsTheEnergy) {
  double largest = 0;
  for (std::uint32_t i = 0; i < kSamplers; ++i) {
    const Drawn d = draw(i, false);
    const Sampler s(d);
    const float energy = v_luminance(energy_of(d.zhu, d.ours, lobes_of(d.zhu, d.fiber, d.theta), d.bundle));
    constexpr int kSamples = 20000;
    double sum = 0, sum2 = 0;
    for (std::uint32_t k = 0; k < kSamples; ++k) {
      const ScatterDirection w = s.sample(k);
      const float p = m_cos(w.phi), pdf = s.pdf(w.sin_i, w.cos_i, w.phi);
      ASSERT_GT(pdf, 0);
      const double weight = v_luminance(value_of(d.zhu, s.a, shares_of(d.ours, s.a, p), w.sin_i, w.cos_i, p)) / pdf;
      sum += weight, sum2 += weight * weight;
      if (d.ours) largest = std::max(largest, weight);
    }
    const double mean = sum / kSamples, deviation = std::sqrt(std::max(sum2 / kSamples - mean * mean, 0.0) / kSamples);
    EXPECT_NEAR(mean, energy, 4.5 * deviation + 2e-3) << i;
  }
  EXPECT_LE(largest, kAggregateMaxWeight);
  std::printf("largest weight %.2f\n", largest);
}

}  // namespace
}  // namespace pelage::kernel
