// Draws what the scattering kernels say beside what tracing through a cylinder says, as SVG:
//   scatter_plots FOLDER        writes scatter_energies.svg, scatter_azimuth.svg and scatter_rough.svg there
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/scalar.h"
#include "oracle/diagram.h"
#include "oracle/fiber_oracle.h"
#include "oracle/rough_fiber.h"

namespace pelage {
namespace {

using namespace kernel;
using namespace plots;
constexpr double kPiD = std::numbers::pi;

float degrees(double radians) { return static_cast<float>(radians * 180 / kPiD); }
ScatterFiber fiber(float sigma_a, float beta_n) { return scatter_fiber(1.55f, 0.13f, beta_n, 0, 1, v_splat(sigma_a)); }

// Energies of R, TT, TRT and the rest over the inclination: lines from the kernel, dots traced.
Diagram energies(double left, float sigma_a) {
  Diagram d(left, 30, 90, 1, fmt::format("energies, absorption {:g} per radius", sigma_a), "inclination, degrees");
  const char* const names[] = {"R", "TT", "TRT", "later paths"};
  for (int lobe = 0; lobe < 4; ++lobe) {
    std::vector<Vec2> kernel_line, traced;
    for (double theta = 0; theta < 1.55; theta += 0.025) {
      const ScatterLobes l = scatter_prepare_marschner(fiber(sigma_a, 0.26f), static_cast<float>(std::sin(theta)),
                                                       static_cast<float>(std::cos(theta)));
      const float energy[] = {l.a_r, l.a_tt.x, l.a_trt.x, l.a_rest.x};
      kernel_line.push_back({degrees(theta), energy[lobe]});
    }
    for (double theta = 0; theta < 1.5; theta += 0.1) {
      const auto exact = oracle::fiber<200>(std::cos(theta), 1.55, sigma_a, 400);
      double rest = 0;
      for (std::size_t k = 3; k < exact.energy.size(); ++k) rest += exact.energy[k];
      traced.push_back({degrees(theta), static_cast<float>(lobe < 3 ? exact.energy[static_cast<std::size_t>(lobe)] : rest)});
    }
    d.line(kernel_line, kColors[lobe]), d.dots(traced, kColors[lobe]);
    d.label(lobe + 4, names[lobe], kColors[lobe], true);
  }
  return d;
}

// N of an order at |phi|, of unit energy: traced exits, blurred by a Gaussian of deviation beta_n.
double traced_profile(double phi, double theta, double sigma_a, double beta_n, std::size_t order) {
  constexpr int kRays = 1500;
  double sum = 0, energy = 0;
  for (int i = 0; i < kRays; ++i) {
    const double gamma = (i + 0.5) / kRays * kPiD / 2;
    const oracle::Exit e = oracle::trace<3>(std::cos(theta), std::sin(gamma), 1.55, sigma_a)[order];
    const double w = std::cos(gamma) * e.energy;
    energy += w;
    for (const double center : {e.phi, -e.phi}) {
      const double x = std::remainder(phi - center, 2 * kPiD) / beta_n;
      sum += 0.5 * w * std::exp(-0.5 * x * x) / (beta_n * std::sqrt(2 * kPiD));
    }
  }
  return sum / energy;
}
float pair_profile(float phi, float theta, float sigma_a, float beta_n, std::size_t order) {
  const ScatterLobes l = scatter_prepare_marschner(fiber(sigma_a, beta_n), m_sin(theta), m_cos(theta));
  const float c = m_cos(phi);
  return order == 1 ? scatter_pair_value(l.n_tt, -c, scatter_sin_phi(c), 0)
                    : scatter_pair_value(l.n_trt, c, scatter_sin_phi(c), 0);
}
float chiang_profile(float phi, float theta, float sigma_a, float beta_n, std::size_t order) {
  constexpr int kNodes = 400;
  float sum = 0, energy = 0;
  for (int i = 0; i < kNodes; ++i) {
    const ScatterNear n =
        scatter_prepare_chiang(fiber(sigma_a, beta_n), m_sin(theta), m_cos(theta), 2 * (i + 0.5f) / kNodes - 1);
    const float a = order == 1 ? n.a_tt.x : n.a_trt.x, center = order == 1 ? n.phi_tt : n.phi_trt;
    energy += a, sum += a * scatter_logistic(scatter_wrap(phi - center), n.rate);
  }
  return sum / energy;
}

std::vector<Vec2> over_azimuth(const std::function<double(double)>& value) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 120; ++i)
    points.push_back({180.f * static_cast<float>(i) / 120, static_cast<float>(value(i * kPiD / 120))});
  return points;
}

Diagram azimuth(double left, std::size_t order, float theta) {
  Diagram d(left, 30, 180, order == 1 ? 0.8 : 2,
            fmt::format("{} around the fiber, inclination {:.0f}°, blur 15°", order == 1 ? "TT" : "TRT", degrees(theta)),
            "azimuth from the light, degrees");
  d.dots(over_azimuth([&](double phi) { return traced_profile(phi, theta, 0.3, 0.26, order); }), kColors[1]);
  d.line(over_azimuth([&](double phi) { return pair_profile(static_cast<float>(phi), theta, 0.3f, 0.26f, order); }),
         kColors[0]);
  d.line(over_azimuth([&](double phi) { return chiang_profile(static_cast<float>(phi), theta, 0.3f, 0.26f, order); }),
         kColors[2], "4 3");
  d.label(0, "traced, blurred", kColors[1], order == 1), d.label(1, "pair of lobes", kColors[0], order == 1);
  d.label(2, "Chiang, mean over h", kColors[2], order == 1);
  return d;
}

// A cylinder whose surface is rough, against the pair whose blur fits best.
Diagram rough(double left, std::size_t order, float theta, const std::array<oracle::RoughOrder, 4>& traced) {
  constexpr std::size_t kBins = oracle::RoughOrder::kBins;
  std::vector<Vec2> bins;
  for (std::size_t b = 0; b < kBins; b += 2) {
    const double n = (traced[order].around[b] + traced[order].around[b + 1]) / 2 * kBins / (2 * kPiD * traced[order].energy);
    bins.push_back({(static_cast<float>(b) + 1) * 180.f / kBins, static_cast<float>(n)});
  }
  double least = 1;
  float best = 0;
  for (float beta = 0.02f; beta < 1; beta += 0.01f) {
    double distance = 0;
    for (const Vec2& p : bins)
      distance += std::fabs(p.y - pair_profile(p.x * 3.14159265f / 180, theta, 0.3f, beta, order)) * 2 * kPiD / kBins;
    if (distance < least) least = distance, best = beta;
  }
  const char* const name = order == 1 ? "TT" : "TRT";
  std::printf("rough cylinder, %s at %.0f degrees: best blur %.0f degrees, %.3f of the energy elsewhere\n", name,
              degrees(theta), degrees(best), least);
  Diagram d(left, 30, 180, order == 1 ? 0.8 : 2, fmt::format("{}, rough surface, inclination {:.0f}°", name, degrees(theta)),
            "azimuth from the light, degrees");
  d.dots(bins, kColors[1]);
  d.line(over_azimuth([&](double phi) { return pair_profile(static_cast<float>(phi), theta, 0.3f, best, order); }), kColors[0]);
  d.label(0, "traced, slopes 0.1", kColors[1], order == 1);
  d.label(1, fmt::format("pair, blur {:.0f}°", degrees(best)), kColors[0], order == 1);
  return d;
}

int draw(const std::string& folder) {
  write(folder + "/scatter_energies.svg", {energies(40, 0), energies(490, 0.3f)});
  write(folder + "/scatter_azimuth.svg", {azimuth(40, 1, 0), azimuth(490, 2, 0), azimuth(940, 2, 0.8f)});
  const auto traced = oracle::RoughTracer({1.55, 0.3, 0.1, 0}, 0, 5).run(400000);
  write(folder + "/scatter_rough.svg", {rough(40, 1, 0, traced), rough(490, 2, 0, traced)});
  return 0;
}

}  // namespace
}  // namespace pelage

int main(int argc, char** argv) {
  if (argc == 2) return pelage::draw(argv[1]);
  std::fprintf(stderr, "usage: scatter_plots FOLDER\n");
  return 2;
}
