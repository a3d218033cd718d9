// Bundles of fibers as one thick hair, in the form of fiber_models.h.
#pragma once

#include "reference/fiber_models.h"

namespace pelage::fiber_models {

/// Largest difference of Aggregate::albedo() from the integral of value().
inline constexpr float kAggregateAlbedoMaxError = 8e-3f;
/// The same within 0.1 rad of the hair's end, where the sums miss narrow lobes: bundles send less than albedo() there.
inline constexpr float kAggregateEndOnMaxError = 0.075f;
/// Value over density of a direction that is drawn; luminance. Largest where lobes are narrowest.
inline constexpr float kBalancedMaxWeight = 6.2f;

/// scatter_shares() toward azimuth phi, or the same at a place.
kernel::ScatterShares shares_toward(const kernel::ScatterAggregate& a, const std::optional<BundlePlace>& place, float phi);

/// What all lobes of `a` send through its bundle, by quadrature over the azimuth, and a backward lobe that gives back the rest. The kernel's sums of
/// five cosines leave out 6 to 21 % of the backward lobe, so that they never make light; along a path that meets many bundles
/// this adds up. docs/derivations/aggregated_scattering.md, "In the path tracer".
void balance(kernel::ScatterAggregate& a, const std::optional<BundlePlace>& place);

/// Lobes of fibers whose directions vary by `spread` along each axis across the bundle. That moves θ_i + θ_o by |n_i + n_o|² times as much,
/// 2 + 2 cos φ, which each lobe has at its center; R has the mean of all azimuths.
kernel::ScatterLobes spread_lobes(kernel::ScatterLobes lobes, float spread);

/// The fibers of a bundle: which lobes they have.
struct MarschnerFibers {
  static ScatterLobes lobes(const FiberView& v) {
    return spread_lobes(scatter_prepare_marschner(v.fiber(), v.sin_o, v.cos_o), v.spread);
  }
  static Vec3 value(const ScatterAggregate& a, const ScatterShares& s, FiberAngles to, float cos_phi) {
    return scatter_aggregate_marschner(a, s, to.sin_i, to.cos_i, cos_phi);
  }
  static float density(const ScatterAggregate& a, const ScatterAggregateChoice& c, FiberAngles to) {
    return scatter_pdf_aggregate_marschner(a, c, to.sin_i, to.cos_i, to.phi);
  }
  static ScatterDirection sample(const ScatterAggregate& a, const ScatterAggregateChoice& c, Vec4 u) {
    return scatter_sample_aggregate_marschner(a, c, u);
  }
};
struct ZhuFibers {
  static ScatterLobes lobes(const FiberView& v) {
    return spread_lobes(scatter_prepare_zhu(v.fiber(), v.sin_o, v.cos_o), v.spread);
  }
  static Vec3 value(const ScatterAggregate& a, const ScatterShares& s, FiberAngles to, float cos_phi) {
    return scatter_aggregate_zhu(a, s, to.sin_i, to.cos_i, cos_phi);
  }
  static float density(const ScatterAggregate& a, const ScatterAggregateChoice& c, FiberAngles to) {
    return scatter_pdf_aggregate_zhu(a, c, to.sin_i, to.cos_i, to.phi);
  }
  static ScatterDirection sample(const ScatterAggregate& a, const ScatterAggregateChoice& c, Vec4 u) {
    return scatter_sample_aggregate_zhu(a, c, u);
  }
};

/// kernel/scatter/aggregated.h. What comes back from between the fibers counts as what remains.
template <class Fibers>
struct Aggregate {
  explicit Aggregate(const FiberView& v) : bundle(scatter_prepare_aggregate(Fibers::lobes(v), *v.bundle)), place(v.place) {
    balance(bundle, place);
    choice = scatter_choice_aggregate(bundle);
  }

  Vec3 value(FiberAngles a) const { return Fibers::value(bundle, shares_toward(bundle, place, a.phi), a, m_cos(a.phi)); }
  float density(FiberAngles a) const { return Fibers::density(bundle, choice, a); }
  FiberWeight weigh(FiberAngles a) const { return {value(a), density(a)}; }
  ScatterDirection sample(Vec4 u) const { return Fibers::sample(bundle, choice, u); }
  DrawnDirection draw(Vec4 u) const { return draw_weighed(*this, u); }
  Vec3 albedo() const { return scatter_energies_sum(bundle.first) + scatter_energies_sum(bundle.straight) + bundle.a_back; }
  void keep(int lobe) {
    keep(bundle.near, lobe), keep(bundle.through, lobe);
    if (lobe != 3) bundle.a_back = kNone;
  }

  ScatterAggregate bundle;
  std::optional<BundlePlace> place;
  ScatterAggregateChoice choice;

 private:
  static void keep(ScatterLobes& lobes, int lobe) {
    if (lobe != 0) lobes.gain_r = lobes.a_r = 0;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 2) lobes.a_trt = kNone;
    if (lobe != 3) lobes.a_rest = kNone;
  }
};

}  // namespace pelage::fiber_models
