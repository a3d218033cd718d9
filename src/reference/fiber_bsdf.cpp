#include "reference/fiber_bsdf.h"

#include <cmath>

namespace pelage {
namespace {

/// A unit vector across the tangent: toward `w` where that has a component there, any otherwise.
Vec3 across(Vec3 tangent, Vec3 w) {
  const Vec3 x = w - tangent * dot(w, tangent);
  if (dot(x, x) > 1e-12f) return normalize(x);
  return normalize(cross(tangent, std::fabs(tangent.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
}

/// None in a section without width.
std::optional<BundlePlace> place_in(const ThickPlace& thick, const kernel::ScatterBundle& others, Vec3 to_eye, Vec3 met) {
  const Vec3 tangent = thick.tangent;
  const float area = dot(tangent, cross(thick.major, thick.minor));  // over π
  if (!(std::fabs(area) > 0)) return {};
  const Vec3 to_x = cross(thick.minor, tangent) / area, to_y = cross(tangent, thick.major) / area;
  const auto stretched = [&](Vec3 v) { return Vec2(dot(v, to_x), dot(v, to_y)); };
  const Vec3 x = across(tangent, to_eye);
  return BundlePlace{stretched(met - thick.axis), stretched(x), stretched(cross(tangent, x)),
                     2 * others.reach * kernel::kInvPi / std::fabs(area)};
}

float sine_along(Vec3 tangent, Vec3 w) { return kernel::v_clamp(dot(w, tangent), -1, 1); }
float cosine_of(float sine) { return std::sqrt(1 - sine * sine); }

/// m_cos() and m_sin() of one angle, which is reduced once for both.
Vec2 cos_sin(float x) {
  const float n = kernel::m_quadrant(x), r = kernel::m_reduce(x, n);
  const float c = kernel::m_cos_poly(r), s = kernel::m_sin_poly(r);
  switch (static_cast<int>(n) & 3) {
    case 1: return {-s, c};
    case 2: return {-c, -s};
    case 3: return {s, -c};
    default: return {c, s};
  }
}

}  // namespace

FiberBsdf::Model FiberBsdf::make_model(const FiberView& view) {
  const HairMaterial::Model model = view.material.material().model;
  if (view.bundle && model == HairMaterial::Model::kZhu) return fiber_models::Aggregate<fiber_models::ZhuFibers>(view);
  if (view.bundle && (model == HairMaterial::Model::kMarschner || model == HairMaterial::Model::kChiang))
    return fiber_models::Aggregate<fiber_models::MarschnerFibers>(view);
  switch (model) {
    case HairMaterial::Model::kKajiyaKay: return fiber_models::KajiyaKay(view);
    case HairMaterial::Model::kZhu: return fiber_models::Zhu(view);
    case HairMaterial::Model::kChiang: return fiber_models::Chiang(view);
    case HairMaterial::Model::kSadeghi: return fiber_models::Sadeghi(view);
    case HairMaterial::Model::kPelekis: return fiber_models::Pelekis(view);
    case HairMaterial::Model::kMarschner: break;
  }
  return fiber_models::Marschner(view);
}

FiberBsdf::FiberBsdf(Vec3 tangent, Vec3 to_eye, const FiberView& view)
    : tangent_(tangent), across_(across(tangent, to_eye)), side_(cross(tangent_, across_)), model_(make_model(view)) {}

FiberView FiberBsdf::view_of(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye) {
  const float sine = sine_along(tangent, to_eye);
  return {material, strand_color, sine, cosine_of(sine), 0, {}};
}

FiberBsdf::FiberBsdf(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye, float h)
    : FiberBsdf(tangent, to_eye, [&] {
        FiberView view = view_of(material, strand_color, tangent, to_eye);
        view.h = h;
        return view;
      }()) {}

FiberBsdf::FiberBsdf(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye,
                     const kernel::ScatterBundle& others)
    : FiberBsdf(tangent, to_eye, [&] {
        FiberView view = view_of(material, strand_color, tangent, to_eye);
        view.bundle = others;
        return view;
      }()) {}

FiberBsdf::FiberBsdf(const FiberMaterial& material, Vec3 strand_color, const ThickPlace& thick, Vec3 to_eye,
                     const kernel::ScatterBundle& others, Vec3 met)
    : FiberBsdf(thick.fiber_tangent(met), to_eye, [&] {
        FiberView view = view_of(material, strand_color, thick.fiber_tangent(met), to_eye);
        view.bundle = others, view.place = place_in(thick, others, to_eye, met), view.spread = thick.fiber_spread();
        return view;
      }()) {}

FiberAngles FiberBsdf::angles(Vec3 to_light) const {
  const float sin_i = sine_along(tangent_, to_light);
  return {sin_i, cosine_of(sin_i), kernel::m_atan2(dot(to_light, side_), dot(to_light, across_))};
}

Vec3 FiberBsdf::evaluate(Vec3 to_light) const {
  return std::visit([a = angles(to_light)](const auto& model) { return model.value(a); }, model_);
}

Vec3 FiberBsdf::evaluate_lobe(Vec3 to_light, int lobe) const {
  const auto value = [a = angles(to_light), lobe](auto model) {
    model.keep(lobe);
    return model.value(a);
  };
  return std::visit(value, model_);
}

float FiberBsdf::pdf(Vec3 to_light) const {
  return std::visit([a = angles(to_light)](const auto& model) { return model.density(a); }, model_);
}

Vec3 FiberBsdf::world(const kernel::ScatterDirection& d) const {
  const Vec2 around = cos_sin(d.phi);
  return tangent_ * d.sin_i + (across_ * around.x + side_ * around.y) * d.cos_i;
}

FiberSample FiberBsdf::sample(std::array<float, 4> u) const {
  const auto draw = [&](const auto& model) {
    const kernel::ScatterDirection d = model.sample(Vec4(u[0], u[1], u[2], u[3]));
    const FiberAngles a{d.sin_i, d.cos_i, d.phi};
    const FiberWeight w = model.weigh(a);
    return FiberSample{world(d), w.value, w.density, static_cast<int>(d.lobe)};
  };
  return std::visit(draw, model_);
}

ScatteredDirection FiberBsdf::scatter(std::array<float, 4> u) const {
  const auto draw = [&](const auto& model) {
    const DrawnDirection drawn = model.draw(Vec4(u[0], u[1], u[2], u[3]));
    return ScatteredDirection{world(drawn.to), drawn.weight};
  };
  return std::visit(draw, model_);
}

Vec3 FiberBsdf::albedo() const {
  return std::visit([](const auto& model) { return model.albedo(); }, model_);
}

}  // namespace pelage
