#include "reference/aggregate_models.h"

#include <cstddef>

namespace pelage::fiber_models {
namespace {

constexpr int kAround = 16, kPerPair = 8;  ///< azimuths of what is wide, and of a pair of lobes
constexpr float kKept = 0.99f;             ///< of the backward lobe, for what the quadrature is off

using Place = std::optional<BundlePlace>;

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
WideMeans means_around(const ScatterAggregate& a, const Place& place) {
  WideMeans m;
  for (int k = 0; k < kAround; ++k) {
    const float x = (static_cast<float>(k) + 0.5f) / kAround, phi = kPi * x * x;
    for (const float toward : {phi, -phi}) {
      const ScatterShares s = shares_toward(a, place, toward);
      m.even.add(s, x), m.reflection.add(s, x * scatter_reflection(a.near, m_cos(phi)));
    }
  }
  return {m.reflection.weight > 0 ? m.reflection.normalized() : m.even.normalized(), m.even.normalized()};
}

/// Over a pair of lobes around `center`, 0 or π.
WayMeans means_over(const ScatterAggregate& a, const Place& place, const ScatterPair& pair, float center) {
  const PairDensity around(pair);
  WayMeans m;
  for (int k = 0; k < kPerPair; ++k) {
    const float x = around.sample(0.5f * (static_cast<float>(k) + 0.5f) / kPerPair), cos_x = m_cos(x);
    const float weight = scatter_pair_value(pair, cos_x, scatter_sin_phi(cos_x), 0) / around.density(x);
    m.add(shares_toward(a, place, center + x), weight), m.add(shares_toward(a, place, center - x), weight);
  }
  return m.weight > 0 ? m.normalized() : m;
}

/// The share of light that meets none of x fibers, or keeps something at each: `joint` of it comes the way that the eye's ray goes.
float passing(float x, float loss, float joint) {
  const float alone = m_exp(-loss * x);
  return alone + (1 - alone) * joint;
}

}  // namespace

ScatterLobes spread_lobes(ScatterLobes l, float spread) {
  if (!(spread > 0)) return l;
  const auto wider = [&](const ScatterCone& c, float v) { return scatter_cone(l.sin_o, l.cos_o, c.shift, c.v + v); };
  l.r = wider(l.r, 2 * spread);
  l.tt = wider(l.tt, spread * (2 - 2 * l.n_tt.cos_mu));
  l.trt = wider(l.trt, spread * (2 + 2 * l.n_trt.cos_mu));
  return l;
}

ScatterShares shares_toward(const ScatterAggregate& a, const Place& place, float phi) {
  const float cos_phi = m_cos(phi);
  if (!place) return scatter_shares(a, cos_phi);
  const Vec2 d = place->across * cos_phi + place->side * m_sin(phi);
  const float d2 = d.x * d.x + d.y * d.y, along = place->at.x * d.x + place->at.y * d.y,
              inside = max(1 - place->at.x * place->at.x - place->at.y * place->at.y, 0.f);
  const float way = (sqrt(along * along + d2 * inside) - along) / d2;  // metres across the bundle, to its hull
  const float x = place->rate * way, joint = scatter_bundle_way(a.bundle, cos_phi).joint * (0.5f + 0.5f * cos_phi);
  const float direct = passing(x, 1, joint);
  const Vec3 all(passing(x, 1 - a.a_f.x, joint), passing(x, 1 - a.a_f.y, joint), passing(x, 1 - a.a_f.z, joint));
  return {v_splat(direct), v_positive(all - v_splat(direct)),
          a.back_norm * sqrt(a.bundle.wide2 * cos_phi * cos_phi + a.bundle.deep2 * (1 - cos_phi * cos_phi)), v_splat(1)};
}

void balance(ScatterAggregate& a, const Place& place) {
  const WideMeans wide = means_around(a, place);
  a.first = {wide.reflection.near * a.near.a_r, means_over(a, place, a.near.n_tt, kPi).near * a.near.a_tt,
             means_over(a, place, a.near.n_trt, 0).near * a.near.a_trt, wide.even.near * a.near.a_rest};
  a.straight = {wide.reflection.through * a.through.a_r, means_over(a, place, a.through.n_tt, kPi).through * a.through.a_tt,
                means_over(a, place, a.through.n_trt, 0).through * a.through.a_trt, wide.even.through * a.through.a_rest};
  const Vec3 all = scatter_total_energy(a.near), first = scatter_energies_sum(a.first),
             straight = scatter_energies_sum(a.straight);
  const float escape = scatter_bundle_escape(a.bundle);
  a.a_back = {scatter_left_over(all.x, first.x, straight.x, escape, kKept),
              scatter_left_over(all.y, first.y, straight.y, escape, kKept),
              scatter_left_over(all.z, first.z, straight.z, escape, kKept)};
}

}  // namespace pelage::fiber_models
