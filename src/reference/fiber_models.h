// The models of kernel/scatter behind one face: what each scatters from one direction, lobe by lobe.
//
// Every struct here is made for one θ_o and has
//   value(a)    f·cos θ_i of all lobes            density(a)  of sample(), per solid angle, all lobes together
//   sample(u)   a direction                       albedo()    integral of value over the sphere
//   keep(lobe)  switches all other lobes off: 0 R, 1 TT, 2 TRT, 3 what remains
#pragma once

#include <pelage/scene.h>

#include "frame/fiber.h"

namespace pelage {

/// A direction of light about the fiber; φ = φ_i − φ_o, radians.
struct FiberAngles {
  float sin_i, cos_i, phi;
};

/// What all models are made from. h: see FiberBsdf.
struct FiberView {
  const HairMaterial& material;
  Vec3 strand_color;
  float sin_o, cos_o, h;
};

namespace fiber_models {

using namespace kernel;
inline constexpr Vec3 kNone{0, 0, 0};

/// R, TT, TRT and what remains, each a cone times an azimuthal lobe.
struct Marschner {
  explicit Marschner(const FiberView& v)
      : lobes(scatter_prepare_marschner(make_fiber(v.material, v.strand_color), v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_marschner(lobes, a.sin_i, a.cos_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_marschner(lobes, choice, a.sin_i, a.cos_i, a.phi); }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_marschner(lobes, choice, u); }
  Vec3 albedo() const { return v_splat(lobes.a_r) + lobes.a_tt + lobes.a_trt + lobes.a_rest; }
  void keep(int lobe) {
    if (lobe != 0) lobes.gain_r = lobes.a_r = 0;
    if (lobe != 1) lobes.a_tt = kNone;
    if (lobe != 2) lobes.a_trt = kNone;
    if (lobe != 3) lobes.a_rest = kNone;
  }

  ScatterLobes lobes;
  ScatterChoice choice = scatter_choice_of(lobes);
};

/// R, TT and a diffuse lobe that holds what remains.
struct Zhu {
  explicit Zhu(const FiberView& v) : lobes(scatter_prepare_zhu(make_fiber(v.material, v.strand_color), v.sin_o, v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_zhu(lobes, a.sin_i, a.cos_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_zhu(lobes, choice, a.sin_i, a.cos_i, a.phi); }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_zhu(lobes, choice, u); }
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
    const ScatterFiber fiber = make_fiber(v.material, v.strand_color);
    lobes = scatter_prepare_marschner(fiber, v.sin_o, v.cos_o);
    diffuse = tuft_color(v.material, fiber.sigma_a) * max(1 - lobes.a_r, 0.f);
    choice = scatter_choice(lobes.a_r, kNone, kNone, diffuse);
  }

  Vec3 value(FiberAngles a) const {
    return scatter_kajiya_kay(lobes, kNone, a.sin_i, a.cos_i) + diffuse * scatter_diffuse(a.cos_i);
  }
  float density(FiberAngles a) const { return scatter_pdf_kajiya_kay(lobes, choice, a.sin_i, a.cos_i); }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_kajiya_kay(lobes, choice, u); }
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
  explicit Chiang(const FiberView& v)
      : near(scatter_prepare_chiang(make_fiber(v.material, v.strand_color), v.sin_o, v.cos_o, v.h)) {}

  Vec3 value(FiberAngles a) const { return scatter_chiang(near, a.sin_i, a.cos_i, a.phi); }
  float density(FiberAngles a) const { return scatter_pdf_chiang(near, choice, a.sin_i, a.cos_i, a.phi); }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_chiang(near, choice, u); }
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

/// R, TT, TRT without glints, and the glints, which count as what remains.
struct Sadeghi {
  explicit Sadeghi(const FiberView& v)
      : lobes(scatter_prepare_sadeghi(make_artist_fiber(v.material),
                                      kernel::scatter_crossing_color(fiber_absorption(v.material, v.strand_color)), v.sin_o,
                                      v.cos_o)) {}

  Vec3 value(FiberAngles a) const { return scatter_sadeghi(lobes, a.sin_i, a.cos_i, m_cos(a.phi)); }
  float density(FiberAngles a) const { return scatter_pdf_sadeghi(lobes, choice, a.sin_i, a.cos_i, a.phi); }
  ScatterDirection sample(Vec4 u) const { return scatter_sample_sadeghi(lobes, choice, u); }
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
