#include "reference/aggregate_models.h"

#include <cstddef>

namespace pelage::fiber_models {
namespace {

constexpr int kAround = 16, kPerPair = 8;  ///< azimuths of what is wide, and of a pair of lobes
constexpr float kKept = 0.99f;             ///< of the backward lobe, for what the quadrature is off

/// Means over azimuths of what comes by each way.
struct WayMeans {
  Vec3 near, through;
  float weight = 0;

  void add(const ScatterShares& s, float w) { near += s.near * w, through += s.through * w, weight += w; }
  WayMeans normalized() const { return {near / weight, through / weight, 1}; }
};

/// Over R's and over all azimuths. Azimuths are dense around 0, where a bundle shows what is lit.
struct WideMeans {
  WayMeans reflection, even;
};
WideMeans means_around(const ScatterAggregate& a) {
  WideMeans m;
  for (int k = 0; k < kAround; ++k) {
    const float x = (static_cast<float>(k) + 0.5f) / kAround, cos_phi = m_cos(kPi * x * x);
    const ScatterShares s = scatter_shares(a, cos_phi);
    m.even.add(s, x), m.reflection.add(s, x * scatter_reflection(a.near, cos_phi));
  }
  return {m.reflection.weight > 0 ? m.reflection.normalized() : m.even.normalized(), m.even.normalized()};
}

/// Over a pair of lobes around `center`, 0 or π. Both of the pair see the same.
WayMeans means_over(const ScatterAggregate& a, const ScatterPair& pair, float center) {
  const PairDensity around(pair);
  WayMeans m;
  for (int k = 0; k < kPerPair; ++k) {
    const float x = around.sample(0.5f * (static_cast<float>(k) + 0.5f) / kPerPair), cos_x = m_cos(x);
    const float weight = scatter_pair_value(pair, cos_x, scatter_sin_phi(cos_x), 0) / around.density(x);
    m.add(scatter_shares(a, center == 0 ? cos_x : -cos_x), weight);
  }
  return m.weight > 0 ? m.normalized() : m;
}

}  // namespace

void balance(ScatterAggregate& a) {
  const WideMeans wide = means_around(a);
  a.first = {wide.reflection.near * a.near.a_r, means_over(a, a.near.n_tt, kPi).near * a.near.a_tt,
             means_over(a, a.near.n_trt, 0).near * a.near.a_trt, wide.even.near * a.near.a_rest};
  a.straight = {wide.reflection.through * a.through.a_r, means_over(a, a.through.n_tt, kPi).through * a.through.a_tt,
                means_over(a, a.through.n_trt, 0).through * a.through.a_trt, wide.even.through * a.through.a_rest};
  const Vec3 all = scatter_total_energy(a.near), first = scatter_energies_sum(a.first),
             straight = scatter_energies_sum(a.straight);
  const float escape = scatter_bundle_escape(a.bundle);
  a.a_back = {scatter_left_over(all.x, first.x, straight.x, escape, kKept),
              scatter_left_over(all.y, first.y, straight.y, escape, kKept),
              scatter_left_over(all.z, first.z, straight.z, escape, kKept)};
}

}  // namespace pelage::fiber_models
