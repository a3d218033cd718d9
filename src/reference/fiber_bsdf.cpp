#include "reference/fiber_bsdf.h"

#include <cmath>

#include "frame/fiber.h"

namespace pelage {
namespace {

using Model = HairMaterial::Model;
using namespace kernel;

constexpr Vec3 kNone{0, 0, 0};

/// A unit vector across the tangent: toward `w` where that has a component there, any otherwise.
Vec3 across(Vec3 tangent, Vec3 w) {
  const Vec3 x = w - tangent * dot(w, tangent);
  if (dot(x, x) > 1e-12f) return normalize(x);
  return normalize(cross(tangent, std::fabs(tangent.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
}

/// The lobes with all but one switched off.
ScatterLobes isolated(ScatterLobes l, int lobe) {
  if (lobe != 0) l.gain_r = 0, l.a_r = 0;
  if (lobe != 1) l.a_tt = kNone;
  if (lobe != 2) l.a_trt = kNone;
  if (lobe != 3) l.a_rest = kNone;
  return l;
}

}  // namespace

FiberBsdf::FiberBsdf(const HairMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye, float /*h*/)
    : model_(material.model), tangent_(tangent), across_(across(tangent, to_eye)), side_(cross(tangent_, across_)) {
  const ScatterFiber fiber = make_fiber(material, strand_color);
  const float sin_o = v_clamp(dot(to_eye, tangent), -1, 1), cos_o = std::sqrt(1 - sin_o * sin_o);
  lobes_ = model_ == Model::kZhu ? scatter_prepare_zhu(fiber, sin_o, cos_o) : scatter_prepare_marschner(fiber, sin_o, cos_o);
  diffuse_ = scatter_tuft_color(fiber.sigma_a, material.beta_azimuthal) * std::max(1 - lobes_.a_r, 0.f);
  choice_ = model_ == Model::kKajiyaKay ? scatter_choice(lobes_.a_r, kNone, kNone, diffuse_) : scatter_choice_of(lobes_);
}

FiberBsdf::Angles FiberBsdf::angles(Vec3 to_light) const {
  const float sin_i = v_clamp(dot(to_light, tangent_), -1, 1);
  return {sin_i, std::sqrt(1 - sin_i * sin_i), m_atan2(dot(to_light, side_), dot(to_light, across_))};
}

Vec3 FiberBsdf::evaluate_at(const ScatterLobes& lobes, Vec3 diffuse, Angles a) const {
  switch (model_) {
    case Model::kKajiyaKay: return scatter_kajiya_kay(lobes, kNone, a.sin_i, a.cos_i) + diffuse * scatter_diffuse(a.cos_i);
    case Model::kMarschner: return scatter_marschner(lobes, a.sin_i, a.cos_i, m_cos(a.phi));
    case Model::kZhu: break;
  }
  return scatter_zhu(lobes, a.sin_i, a.cos_i, m_cos(a.phi));
}

float FiberBsdf::pdf_at(Angles a) const {
  switch (model_) {
    case Model::kKajiyaKay: return scatter_pdf_kajiya_kay(lobes_, choice_, a.sin_i, a.cos_i);
    case Model::kMarschner: return scatter_pdf_marschner(lobes_, choice_, a.sin_i, a.cos_i, a.phi);
    case Model::kZhu: break;
  }
  return scatter_pdf_zhu(lobes_, choice_, a.sin_i, a.cos_i, a.phi);
}

Vec3 FiberBsdf::evaluate(Vec3 to_light) const { return evaluate_at(lobes_, diffuse_, angles(to_light)); }

Vec3 FiberBsdf::evaluate_lobe(Vec3 to_light, int lobe) const {
  return evaluate_at(isolated(lobes_, lobe), lobe == 3 ? diffuse_ : kNone, angles(to_light));
}

float FiberBsdf::pdf(Vec3 to_light) const { return pdf_at(angles(to_light)); }

FiberSample FiberBsdf::sample(std::array<float, 4> u) const {
  const Vec4 w(u[0], u[1], u[2], u[3]);
  const ScatterDirection d = model_ == Model::kKajiyaKay   ? scatter_sample_kajiya_kay(lobes_, choice_, w)
                             : model_ == Model::kMarschner ? scatter_sample_marschner(lobes_, choice_, w)
                                                           : scatter_sample_zhu(lobes_, choice_, w);
  const Angles a{d.sin_i, d.cos_i, d.phi};
  const Vec3 direction = tangent_ * d.sin_i + (across_ * m_cos(d.phi) + side_ * m_sin(d.phi)) * d.cos_i;
  return {normalize(direction), evaluate_at(lobes_, diffuse_, a), pdf_at(a), static_cast<int>(d.lobe)};
}

Vec3 FiberBsdf::albedo() const {
  const Vec3 r(lobes_.a_r, lobes_.a_r, lobes_.a_r);
  return model_ == Model::kKajiyaKay ? r + diffuse_ : r + lobes_.a_tt + lobes_.a_trt + lobes_.a_rest;
}

}  // namespace pelage
