#include "frame/dual_scattering_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>
#include <utility>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr int kOffsets = 96;  // midpoints in gamma_i = asin(h)

// Mean of |x + noise|, the noise normal with deviation s: the folded normal distribution.
double folded_mean(double x, double s) {
  return s * std::sqrt(2 / std::numbers::pi) * std::exp(-0.5 * x * x / (s * s)) + x * std::erf(x / (s * std::numbers::sqrt2));
}

// Mean of |x|/pi, x wrapped to [-pi, pi], after a Gaussian blur of variance v. Narrow: folded at 0 or at pi, whichever
// is near. Wide: the triangle wave's Fourier series, whose fifth harmonic is down to e^(-81 v/2).
double blurred_triangle(double x, double v) {
  const double a = std::fabs(std::remainder(x, 2 * std::numbers::pi)), s = std::sqrt(std::max(v, 1e-12));
  if (s < 0.5) {
    const double near = std::min(a, std::numbers::pi - a), mean = folded_mean(near, s) / std::numbers::pi;
    return a < 0.5 * std::numbers::pi ? mean : 1 - mean;
  }
  double sum = 0.5;
  for (const double n : {1., 3., 5., 7.}) {
    sum -= 4 / (std::numbers::pi * std::numbers::pi) * std::exp(-0.5 * n * n * v) * std::cos(n * a) / (n * n);
  }
  return sum;
}

double fresnel(double cosine, double eta) {
  const double cos_t = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double parallel = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  const double perpendicular = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// What one offset across the fiber contributes, before absorption.
struct Offset {
  double weight;  // dh
  double fresnel;
  double path;              // length of one crossing, in fiber radii
  double r, tt, trt, rest;  // share of each order that goes forward
};

std::array<Offset, kOffsets> offsets(const HairMaterial& m, double cos_theta) {
  const bool marschner = m.model != HairMaterial::Model::kZhu;
  const double c = std::max(cos_theta, 1e-4), sin2 = 1 - c * c, eta = m.eta;
  const double v = static_cast<double>(m.beta_azimuthal) * m.beta_azimuthal;
  const double inv_eta = c / std::sqrt(eta * eta - sin2), cos_theta_t = std::sqrt(1 - sin2 / (eta * eta));
  std::array<Offset, kOffsets> result{};
  for (int i = 0; i < kOffsets; ++i) {
    const double step = 0.5 * std::numbers::pi / kOffsets, gamma = (i + 0.5) * step, h = std::sin(gamma);
    const double gamma_t = std::asin(h * inv_eta);
    Offset& o = result[static_cast<std::size_t>(i)];
    o.weight = std::cos(gamma) * step;
    o.fresnel = fresnel(c * std::cos(gamma), eta);
    o.path = 2 * std::cos(gamma_t) / cos_theta_t;
    o.r = marschner ? 2 * gamma / std::numbers::pi : 0.5;
    o.tt = blurred_triangle(std::numbers::pi + (marschner ? 2 * (gamma_t - gamma) : 0), v);
    o.trt = marschner ? blurred_triangle(4 * gamma_t - 2 * gamma, v) : 0.5;
    o.rest = 0.5;
  }
  return result;
}

double sum_orders(const std::array<Offset, kOffsets>& all, const HairMaterial& m, double sigma_a) {
  double forward = 0;
  for (const Offset& o : all) {
    const double t = std::exp(-sigma_a * o.path), pass = (1 - o.fresnel) * (1 - o.fresnel) * t, bounce = o.fresnel * t;
    forward +=
        o.weight * (m.specular_gain * o.fresnel * o.r + pass * (o.tt + bounce * (o.trt + o.rest * bounce / (1 - bounce))));
  }
  return forward;
}

ForwardAttenuationTable make_forward_attenuation_table(const HairMaterial& material) {
  const auto rows = static_cast<std::size_t>(kernel::kScatterTableRows),
             columns = static_cast<std::size_t>(kernel::kScatterTableColumns);
  ForwardAttenuationTable table;
  table.a_f.resize(rows * columns);
  parallel_for(rows, 1, [&](std::size_t row, std::size_t) {
    const auto all = offsets(material, static_cast<double>(row) / (rows - 1));
    for (std::size_t column = 0; column < columns; ++column) {
      // e^(-sigma_a/2) = 0 is sigma_a = infinity: 60 leaves nothing that a float could tell.
      const double x = static_cast<double>(column) / (columns - 1);
      table.a_f[row * columns + column] = static_cast<float>(sum_orders(all, material, column == 0 ? 60 : -2 * std::log(x)));
    }
  });
  return table;
}

/// What the table depends on.
struct TableKey {
  bool zhu;
  float eta, beta_azimuthal, specular_gain;
  bool operator==(const TableKey&) const = default;
};

TableKey table_key(const HairMaterial& m) {
  return {m.model == HairMaterial::Model::kZhu, m.eta, m.beta_azimuthal, m.specular_gain};
}

}  // namespace

double forward_attenuation(const HairMaterial& material, double cos_theta, double sigma_a) {
  return sum_orders(offsets(material, cos_theta), material, sigma_a);
}

ForwardAttenuationTable forward_attenuation_table(const HairMaterial& material) {
  constexpr std::size_t kKept = 64;
  static std::mutex mutex;
  static std::deque<std::pair<TableKey, ForwardAttenuationTable>> kept;  // the latest in front
  const TableKey key = table_key(material);
  {
    const std::lock_guard lock(mutex);
    for (const auto& [known, table] : kept)
      if (known == key) return table;
  }
  ForwardAttenuationTable table = make_forward_attenuation_table(material);
  const std::lock_guard lock(mutex);
  kept.emplace_front(key, table);
  if (kept.size() > kKept) kept.pop_back();
  return table;
}

}  // namespace pelage
