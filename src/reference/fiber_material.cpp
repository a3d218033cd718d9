#include "reference/fiber_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelage {

using namespace kernel;

namespace {

constexpr float kLeastCosine = 1e-4f;  ///< as scatter_prepare_marschner() has it

/// 1/(4π e^−κ I₀(κ)): I₀ is a mean over the circle, which evenly spaced points give to all digits once they resolve its peak.
float exact_norm(float kappa) {
  const int points = 32 + static_cast<int>(8 * std::sqrt(kappa));
  double sum = 0;
  for (int i = 0; i < points; ++i)
    sum += std::exp(static_cast<double>(kappa) * (std::cos(std::numbers::pi * (i + 0.5) / points) - 1));
  return static_cast<float>(points / (4 * std::numbers::pi * sum));
}

}  // namespace

ScatterPair completed(const ScatterPair& p) {
  return {p.kappa, p.cos_mu, std::sqrt(std::max(1 - p.cos_mu * p.cos_mu, 0.f)), p.norm};
}

MarschnerTable::MarschnerTable(const ScatterFiber& f)
    : fixed_(scatter_prepare_marschner(f, 0, 1)), r_(-2 * f.tilt, f.v_r), tt_(f.tilt, f.v_tt), trt_(3 * f.tilt, f.v_trt) {
  rows_.reserve(kCells + 1);
  for (std::size_t i = 0; i <= kCells; ++i) {
    const float cos_o = kLeastCosine + (1 - kLeastCosine) * (static_cast<float>(i) / kCells);
    const ScatterLobes l = scatter_prepare_marschner(f, std::sqrt(1 - cos_o * cos_o), cos_o);
    rows_.push_back({l.a_r, l.a_tt.x, l.a_tt.y, l.a_tt.z, l.a_trt.x, l.a_trt.y, l.a_trt.z, l.a_rest.x, l.a_rest.y, l.a_rest.z,
                     l.n_tt.kappa, l.n_tt.cos_mu, l.n_trt.kappa, l.n_trt.cos_mu, exact_norm(l.n_tt.kappa),
                     exact_norm(l.n_trt.kappa)});
  }
}

ScatterLobes MarschnerTable::lobes(float sin_o, float cos_o_raw) const {
  const float cos_o = std::max(cos_o_raw, kLeastCosine);
  const float at = (std::min(cos_o, 1.f) - kLeastCosine) / (1 - kLeastCosine) * kCells;
  const std::size_t cell = std::min(static_cast<std::size_t>(at), kCells - 1);
  const float next = at - static_cast<float>(cell);
  const Row &a = rows_[cell], &b = rows_[cell + 1];
  Row v;
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = a[k] + (b[k] - a[k]) * next;
  ScatterLobes l = fixed_;
  l.sin_o = sin_o, l.cos_o = cos_o;
  l.r = r_.seen_from(sin_o, cos_o), l.tt = tt_.seen_from(sin_o, cos_o), l.trt = trt_.seen_from(sin_o, cos_o);
  l.a_r = v[0], l.a_tt = {v[1], v[2], v[3]}, l.a_trt = {v[4], v[5], v[6]}, l.a_rest = {v[7], v[8], v[9]};
  l.n_tt.kappa = v[10], l.n_tt.cos_mu = v[11], l.n_trt.kappa = v[12], l.n_trt.cos_mu = v[13];
  l.n_tt.norm = v[14], l.n_trt.norm = v[15];
  return l;
}

FiberMaterial::FiberMaterial(const HairMaterial& material, Tables tables)
    : material_(material), fiber_(make_fiber(material, {})), near_r_(-2 * fiber_.tilt, fiber_.v_r),
      near_tt_(fiber_.tilt, fiber_.v_tt), near_trt_(4 * fiber_.tilt, fiber_.v_trt), near_rest_(0, fiber_.v_trt) {
  if (tables == Tables::kWherePossible && one_color() && material.model == HairMaterial::Model::kMarschner)
    table_ = MarschnerTable(fiber_);
}

ScatterLobes FiberMaterial::marschner(Vec3 strand_color, float sin_o, float cos_o) const {
  return table_.empty() ? scatter_prepare_marschner(fiber(strand_color), sin_o, cos_o) : table_.lobes(sin_o, cos_o);
}

ScatterNear FiberMaterial::chiang(Vec3 strand_color, float sin_o, float cos_o_raw, float h) const {
  const float cos_o = std::max(cos_o_raw, kLeastCosine);
  ScatterNear n = scatter_prepare_chiang(fiber(strand_color), sin_o, cos_o, h);
  n.r = near_r_.seen_from(sin_o, cos_o), n.tt = near_tt_.seen_from(sin_o, cos_o);
  n.trt = near_trt_.seen_from(sin_o, cos_o), n.rest = near_rest_.seen_from(sin_o, cos_o);
  return n;
}

}  // namespace pelage
