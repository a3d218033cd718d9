// What separable lobes with smooth energies leave out: a cylinder with a rough, scaly surface, traced path by path.
// The bounds are what docs/derivations/scattering_models.md states.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "kernel/scalar.h"
#include "oracle/rough_fiber.h"

namespace pelage::kernel {
namespace {

constexpr int kPaths = 150000;

ScatterLobes lobes_of(float sigma_a, double theta) {
  const ScatterFiber f = scatter_fiber(1.55f, 0.13f, 0.2f, 0, 1, v_splat(sigma_a));
  return scatter_prepare_marschner(f, static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta)));
}
// Sum of |difference| of the four energies, halved: what went into another lobe, or was absorbed.
double moved(const ScatterLobes& l, const std::array<oracle::RoughOrder, 4>& traced) {
  const float energies[] = {l.a_r, l.a_tt.x, l.a_trt.x, l.a_rest.x};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += 0.5 * std::fabs(traced[i].energy - energies[i]);
  return sum;
}

// The two oracles agree with each other and with the kernel where nothing is rough.
TEST(RoughFiber, SmoothIsTheSmoothFiber) {
  for (const double theta : {0., 0.6, 1.2}) {
    for (const float sigma_a : {0.f, 0.5f}) {
      const auto traced = oracle::RoughTracer({1.55, sigma_a, 1e-6, 0}, theta, 3).run(kPaths);
      EXPECT_LT(moved(lobes_of(sigma_a, theta), traced), 4e-3) << theta << " " << sigma_a;
    }
  }
}

// Roughness turns light back inside at the rim: TT loses to later paths, the more the slanter the light.
TEST(RoughFiber, EnergiesMoveWithRoughness) {
  const struct {
    double theta, roughness, most;
  } cases[] = {{0, 0.05, 0.035}, {0, 0.1, 0.065}, {0.6, 0.05, 0.05}, {0.6, 0.1, 0.1}, {1, 0.05, 0.125}, {1, 0.1, 0.25}};
  for (const auto& c : cases) {
    const double share = moved(lobes_of(0, c.theta), oracle::RoughTracer({1.55, 0, c.roughness, 0}, c.theta, 3).run(kPaths));
    std::printf("theta %.1f, slopes %.2f: %.3f of the energy in another lobe\n", c.theta, c.roughness, share);
    EXPECT_LT(share, c.most) << c.theta << " " << c.roughness;
  }
  const double absorbing = moved(lobes_of(0.5f, 0), oracle::RoughTracer({1.55, 0.5, 0.1, 0}, 0, 3).run(kPaths));
  EXPECT_LT(absorbing, 0.03) << "where hair is dark, what stays inside is absorbed anyway";
}

// Deviations and shifts of theta_i + theta_o, per slope deviation and per tilt. Marschner's table has 1 : 1/2 : 2 and -2, 1, 3.
TEST(RoughFiber, WidthsAndShiftsOfTheLobes) {
  const double slopes = 0.1, tilt = 0.05;
  const auto flat = oracle::RoughTracer({1.55, 0, slopes, 0}, 0, 3).run(kPaths);
  const auto scaly = oracle::RoughTracer({1.55, 0, slopes, tilt}, 0, 3).run(kPaths);
  std::printf("deviation/slopes %.2f %.2f %.2f, shift/tilt %.2f %.2f %.2f\n", flat[0].deviation() / slopes,
              flat[1].deviation() / slopes, flat[2].deviation() / slopes, scaly[0].shift() / tilt, scaly[1].shift() / tilt,
              scaly[2].shift() / tilt);
  EXPECT_NEAR(flat[1].deviation() / flat[0].deviation(), 0.65, 0.05);
  EXPECT_NEAR(flat[2].deviation() / flat[0].deviation(), 2.05, 0.15);
  EXPECT_NEAR(scaly[0].shift() / tilt, -1.2, 0.15) << "toward the root: -2 in the plane of incidence, less around the fiber";
  EXPECT_NEAR(scaly[1].shift() / tilt, 1.2, 0.15);
  EXPECT_NEAR(scaly[2].shift() / tilt, 3.5, 0.4);
}

// Around the fiber the pair of von Mises lobes follows the rough cylinder, with a blur of the slopes' deviation for TT and of
// twice that for TRT, which meets the surface once more.
TEST(RoughFiber, AzimuthalShape) {
  const auto traced = oracle::RoughTracer({1.55, 0.3, 0.1, 0}, 0, 5).run(kPaths);
  constexpr std::size_t kBins = oracle::RoughOrder::kBins;
  const auto lobes = [](float blur) {
    return scatter_prepare_marschner(scatter_fiber(1.55f, 0.13f, blur, 0, 1, v_splat(0.3f)), 0, 1);
  };
  const ScatterPair n_tt = lobes(0.1f).n_tt, n_trt = lobes(0.2f).n_trt;
  double tt = 0, trt = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    const float c = std::cos((static_cast<float>(b) + 0.5f) * 3.14159265f / kBins);
    const double bin = 2 * std::numbers::pi / kBins;
    tt += 0.5 * std::fabs(scatter_pair_value(n_tt, -c, scatter_sin_phi(c), 0) * bin - traced[1].around[b] / traced[1].energy);
    trt += 0.5 * std::fabs(scatter_pair_value(n_trt, c, scatter_sin_phi(c), 0) * bin - traced[2].around[b] / traced[2].energy);
  }
  std::printf("rough cylinder around the fiber: TT %.3f, TRT %.3f of the energy elsewhere\n", tt, trt);
  EXPECT_LT(tt, 0.05);
  EXPECT_LT(trt, 0.08);
}

}  // namespace
}  // namespace pelage::kernel
