// The models of kernel/scatter behind one face: what each scatters from one direction, lobe by lobe.
//
// Every struct here is made for one θ_o and has
//   value(a)    f·cos θ_i of all lobes            density(a)  of sample(), per solid angle, all lobes together
//   weigh(a)    both at once                      sample(u)   a direction
//   draw(u)     a direction with the weight value/density of its lobe alone: the mean over u is that of value(a)/density(a),
//               and most of a lobe need not be computed, because it is drawn exactly
//   albedo()    integral of value over the sphere
//   keep(lobe)  switches all other lobes off: 0 R, 1 TT, 2 TRT, 3 what remains
#pragma once

#include <pelage/scene.h>

#include <optional>

#include "reference/fiber_material.h"

namespace pelage {

/// A direction of light about the fiber; φ = φ_i − φ_o, radians.
struct FiberAngles {
  float sin_i, cos_i, phi;
};

/// Where in its bundle the fiber stands that a ray met. Without it, a bundle scatters as the mean of all fibers that are seen from outside.
///
/// Where bundles stand in each other, what others hide of one is its far side: of what is left more is lit from here and less from there. So
/// what the kernel means over the bundle (scatter_bundle_visible) is taken at the place: docs/derivations/aggregated_scattering.md.
struct BundlePlace {
  Vec2 at;            ///< in the coordinates of the section in which its hull is the unit circle
  Vec2 across, side;  ///< in these, what FiberBsdf's directions φ = 0 and φ = π/2 are, per metre
  float rate = 0;     ///< mean number of other fibers on a metre across the bundle
};

/// What all models are made from. h: see FiberBsdf.
struct FiberView {
  const FiberMaterial& material;
  Vec3 strand_color;
  float sin_o, cos_o, h;
  std::optional<kernel::ScatterBundle> bundle = {};  ///< of the fibers around the one that is seen
  std::optional<BundlePlace> place = {};             ///< of that one among them
  float spread = 0;                                  ///< radians², variance of their directions along each axis

  kernel::ScatterFiber fiber() const { return material.fiber(strand_color); }
};

/// What a direction scatters and how often it is drawn.
struct FiberWeight {
  Vec3 value;
  float density;
};

/// A direction drawn from one lobe, and what the lobe scatters there over how often both are drawn.
struct DrawnDirection {
  kernel::ScatterDirection to;
  Vec3 weight;
};

namespace fiber_models {

using namespace kernel;
inline constexpr Vec3 kNone{0, 0, 0};

/// The direction of azimuth phi whose θ is drawn from a lobe's cone.
inline ScatterDirection in_cone(const ScatterCone& cone, Vec4 u, float phi, float lobe) {
  return scatter_direction(scatter_sample_cone(cone, u.y, u.z), phi, lobe);
}

/// `energy` spread over how often it is drawn: 0 for what never is.
inline Vec3 over_chance(Vec3 energy, float chance) { return chance > 0 ? energy / chance : kNone; }

/// A pair of azimuthal lobes as sampling.h draws it: scatter_sample_pair() and scatter_pdf_pair() with what all directions share.
struct PairDensity {
  explicit PairDensity(const ScatterPair& n)
      : mu(scatter_pair_mu(n)), rate(scatter_pair_rate(n.kappa)), mass(scatter_logistic_mass(rate)) {}

  float density(float x) const { return 0.5f * rate / mass * (shape(scatter_wrap(x - mu)) + shape(scatter_wrap(x + mu))); }
  float sample(float u) const {
    return u < 0.5f ? scatter_sample_logistic(u + u, rate) - mu : scatter_sample_logistic(u + u - 1, rate) + mu;
  }

  float mu, rate, mass;

 private:
  /// scatter_logistic() but for its factors.
  float shape(float x) const {
    const float e = m_exp(-(abs(x) * rate));
    return e / ((1 + e) * (1 + e));
  }
};

/// R, TT, TRT and what remains, each a cone times an azimuthal lobe. Azimuthal pairs are completed where they are asked for:
/// a drawn direction needs one of them, R and what remains none.
struct Marschner {
  explicit Marschner(const FiberView& v) : lobes(v.material.marschner(v.strand_color, v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const {
    ScatterLobes all = lobes;
    all.n_tt = completed(lobes.n_tt), all.n_trt = completed(lobes.n_trt);
    return scatter_marschner(all, a.sin_i, a.cos_i, m_cos(a.phi));
  }
  float density(FiberAngles a) const { return weigh(a).density; }
  /// scatter_marschner() and scatter_pdf_marschner(), whose cones are the same.
  FiberWeight weigh(FiberAngles a) const {
    const float cos_phi = m_cos(a.phi), sin_phi = scatter_sin_phi(cos_phi);
    const ScatterPair n_tt = completed(lobes.n_tt), n_trt = completed(lobes.n_trt);
    const float r = scatter_cone_value(lobes.r, a.sin_i, a.cos_i), tt = scatter_cone_value(lobes.tt, a.sin_i, a.cos_i),
                trt = scatter_cone_value(lobes.trt, a.sin_i, a.cos_i), rest = trt * kInvTwoPi;
    return {v_splat(r * scatter_reflection(lobes, cos_phi)) +
                lobes.a_tt * (tt * scatter_pair_value(n_tt, -cos_phi, sin_phi, 0)) +
                lobes.a_trt * (trt * scatter_pair_value(n_trt, cos_phi, sin_phi, 0)) + lobes.a_rest * rest,
            choice.r * r * scatter_pdf_reflection(lobes, a.phi) + choice.tt * tt * PairDensity(n_tt).density(a.phi - kPi) +
                choice.trt * trt * PairDensity(n_trt).density(a.phi) + choice.rest * rest};
  }
  /// scatter_sample_marschner(), which draws from every lobe, drawing from the chosen one alone.
  ScatterDirection sample(Vec4 u) const { return draw(u).to; }
  /// Cones are drawn exactly: what is left of a lobe's weight is azimuthal.
  DrawnDirection draw(Vec4 u) const {
    const float lobe = scatter_chosen(choice, u.x);
    if (lobe == 0) {
      const float phi = scatter_sample_reflection(lobes, u.w);
      const float share = choice.r * scatter_pdf_reflection(lobes, phi);
      return {in_cone(lobes.r, u, phi, lobe), over_chance(v_splat(scatter_reflection(lobes, m_cos(phi))), share)};
    }
    if (lobe == 3) return {in_cone(lobes.trt, u, kTwoPi * u.w, lobe), over_chance(lobes.a_rest, choice.rest)};
    const bool tt = lobe == 1;
    const ScatterPair pair = completed(tt ? lobes.n_tt : lobes.n_trt);
    const PairDensity around(pair);
    const float x = around.sample(u.w), cos_x = m_cos(x);  // from the pair's center
    return {in_cone(tt ? lobes.tt : lobes.trt, u, tt ? kPi + x : x, lobe),
            over_chance((tt ? lobes.a_tt : lobes.a_trt) * scatter_pair_value(pair, cos_x, scatter_sin_phi(cos_x), 0),
                        (tt ? choice.tt : choice.trt) * around.density(x))};
  }
  Vec3 albedo() const { return v_splat(lobes.a_r) + lobes.a_tt + lobes.a_trt + lobes.a_rest; }
  void keep(int lobe) {
    if (lobe != 0) lobes.gain_r = lobes.a_r = 0;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 2) lobes.a_trt = kNone;
    if (lobe != 3) lobes.a_rest = kNone;
  }
  ScatterLobes lobes;  ///< of the pairs kappa, cos_mu and norm
  ScatterChoice choice = scatter_choice_of(lobes);
};

/// draw() of models whose lobes are weighed together.
template <class Model>
DrawnDirection draw_weighed(const Model& model, Vec4 u) {
  const ScatterDirection d = model.sample(u);
  const FiberWeight w = model.weigh({d.sin_i, d.cos_i, d.phi});
  return {d, over_chance(w.value, w.density)};
}

/// R, TT and a diffuse lobe that holds what remains.
struct Zhu {
  explicit Zhu(const FiberView& v) : lobes(scatter_prepare_zhu(v.fiber(), v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_zhu(lobes, a.sin_i, a.cos_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_zhu(lobes, choice, a.sin_i, a.cos_i, a.phi); }
  FiberWeight weigh(FiberAngles a) const { return {value(a), density(a)}; }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_zhu(lobes, choice, u); }
  DrawnDirection draw(Vec4 u) const { return draw_weighed(*this, u); }
  Vec3 albedo() const { return v_splat(lobes.a_r) + lobes.a_tt + lobes.a_rest; }
  void keep(int lobe) {
    if (lobe != 0) lobes.a_r = 0;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 3) lobes.a_rest = kNone;
  }

  ScatterLobes lobes;
  ScatterChoice choice = scatter_choice_of(lobes);
};

/// A highlight, which counts as R, and a diffuse lobe, which counts as what remains.
struct KajiyaKay {
  explicit KajiyaKay(const FiberView& v) {
    const ScatterFiber fiber = v.fiber();
    lobes = scatter_prepare_marschner(fiber, v.sin_o, v.cos_o);
    diffuse = tuft_color(v.material.material(), fiber.sigma_a) * max(1 - lobes.a_r, 0.f);
    choice = scatter_choice(lobes.a_r, kNone, kNone, diffuse);
  }

  Vec3 value(FiberAngles a) const {
    return scatter_kajiya_kay(lobes, kNone, a.sin_i, a.cos_i) + diffuse * scatter_diffuse(a.cos_i);
  }
  float density(FiberAngles a) const { return scatter_pdf_kajiya_kay(lobes, choice, a.sin_i, a.cos_i); }
  FiberWeight weigh(FiberAngles a) const { return {value(a), density(a)}; }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_kajiya_kay(lobes, choice, u); }
  DrawnDirection draw(Vec4 u) const { return draw_weighed(*this, u); }
  Vec3 albedo() const { return v_splat(lobes.a_r) + diffuse; }
  void keep(int lobe) {
    if (lobe != 0) lobes.a_r = 0;
    if (lobe != 3) diffuse = kNone;
  }

  ScatterLobes lobes;
  Vec3 diffuse;
  ScatterChoice choice;
};

/// The near field: R, TT, TRT and what remains, each leaving at the azimuth of its offset h.
struct Chiang {
  explicit Chiang(const FiberView& v) : near(v.material.chiang(v.strand_color, v.sin_o, v.cos_o, v.h)) {}

  Vec3 value(FiberAngles a) const { return scatter_chiang(near, a.sin_i, a.cos_i, a.phi); }
  float density(FiberAngles a) const { return weigh(a).density; }
  /// scatter_chiang() and scatter_pdf_chiang(): the same lobes, weighted by their energies and by how often they are chosen.
  FiberWeight weigh(FiberAngles a) const {
    const auto lobe = [&](const ScatterCone& cone, float center) {
      return scatter_cone_value(cone, a.sin_i, a.cos_i) * scatter_logistic(scatter_wrap(a.phi - center), near.rate);
    };
    const float r = lobe(near.r, near.phi_r), tt = lobe(near.tt, near.phi_tt), trt = lobe(near.trt, near.phi_trt),
                rest = scatter_cone_value(near.rest, a.sin_i, a.cos_i) * kInvTwoPi;
    return {v_splat(near.a_r * r) + near.a_tt * tt + near.a_trt * trt + near.a_rest * rest,
            choice.r * r + choice.tt * tt + choice.trt * trt + choice.rest * rest};
  }
  /// scatter_sample_chiang(), drawing from the chosen lobe alone.
  ScatterDirection sample(Vec4 u) const {
    const float lobe = scatter_chosen(choice, u.x);
    if (lobe == 3) return in_cone(near.rest, u, kTwoPi * u.w, lobe);
    const ScatterCone& cone = lobe == 0 ? near.r : lobe == 1 ? near.tt : near.trt;
    const float center = lobe == 0 ? near.phi_r : lobe == 1 ? near.phi_tt : near.phi_trt;
    return in_cone(cone, u, center + scatter_sample_logistic(u.w, near.rate), lobe);
  }
  /// Everything is drawn exactly: a lobe's weight is its energy.
  DrawnDirection draw(Vec4 u) const {
    const ScatterDirection d = sample(u);
    if (d.lobe == 0) return {d, over_chance(v_splat(near.a_r), choice.r)};
    if (d.lobe == 1) return {d, over_chance(near.a_tt, choice.tt)};
    if (d.lobe == 2) return {d, over_chance(near.a_trt, choice.trt)};
    return {d, over_chance(near.a_rest, choice.rest)};
  }
  Vec3 albedo() const { return v_splat(near.a_r) + near.a_tt + near.a_trt + near.a_rest; }
  void keep(int lobe) {
    if (lobe != 0) near.a_r = 0;
    if (lobe != 1) near.a_tt = kNone;
    if (lobe != 2) near.a_trt = kNone;
    if (lobe != 3) near.a_rest = kNone;
  }

  ScatterNear near;
  ScatterChoice choice = scatter_choice_chiang(near);
};

/// Chiang's far field by fitted lobes: R, TT, TRT and what remains.
struct Pelekis {
  explicit Pelekis(const FiberView& v) : lobes(scatter_prepare_pelekis(v.fiber(), v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_pelekis(lobes, a.sin_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_pelekis(lobes, choice, a.sin_i, a.phi); }
  FiberWeight weigh(FiberAngles a) const { return {value(a), density(a)}; }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_pelekis(lobes, choice, u); }
  DrawnDirection draw(Vec4 u) const { return draw_weighed(*this, u); }
  Vec3 albedo() const { return v_splat(lobes.a_r) + lobes.a_tt + lobes.a_trt + lobes.a_rest; }
  void keep(int lobe) {
    if (lobe != 0) lobes.a_r = 0;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 2) lobes.a_trt = kNone;
    if (lobe != 3) lobes.a_rest = kNone;
  }

  ScatterPelekis lobes;
  ScatterChoice choice = scatter_choice_pelekis(lobes);
};

/// R, TT, TRT without glints, and the glints, which count as what remains.
struct Sadeghi {
  explicit Sadeghi(const FiberView& v)
      : lobes(scatter_prepare_sadeghi(make_artist_fiber(v.material.material()), scatter_crossing_color(v.fiber().sigma_a),
                                      v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_sadeghi(lobes, a.sin_i, a.cos_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_sadeghi(lobes, choice, a.sin_i, a.cos_i, a.phi); }
  FiberWeight weigh(FiberAngles a) const { return {value(a), density(a)}; }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_sadeghi(lobes, choice, u); }
  DrawnDirection draw(Vec4 u) const { return draw_weighed(*this, u); }
  Vec3 albedo() const { return lobes.a_r + lobes.a_tt + lobes.a_trt + lobes.a_glint; }
  void keep(int lobe) {
    if (lobe != 0) lobes.a_r = kNone;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 2) lobes.a_trt = kNone;
    if (lobe != 3) lobes.a_glint = kNone;
  }

  ScatterArtist lobes;
  ScatterChoice choice = scatter_choice_sadeghi(lobes);
};

}  // namespace fiber_models
}  // namespace pelage
