#include "reference/surface_bsdf.h"

#include <algorithm>
#include <cmath>

#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
/// Roughness below this is sampled as this: a mirror has no density.
constexpr float kLeastRoughness = 1e-3f;

/// GGX, Walter 2007, eq. 33 (references.bib: Walter2007Microfacet).
float ggx(float cos_h, float alpha) {
  const float a2 = alpha * alpha, q = cos_h * cos_h * (a2 - 1) + 1;
  return a2 / (kPi * q * q);
}

}  // namespace

SurfaceBsdf::SurfaceBsdf(Vec3 normal, Vec3 to_eye, Vec3 color, float specular, float roughness)
    : normal_(normal), to_eye_(to_eye), diffuse_(color * (1 - specular)), specular_(specular),
      roughness_(std::max(roughness, kLeastRoughness)) {
  tangent_ = normalize(cross(normal, std::fabs(normal.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  bitangent_ = cross(normal, tangent_);
  // Schlick's Fresnel at the eye's angle: about what the coat takes.
  const float m = 1 - std::clamp(dot(normal, to_eye), 0.f, 1.f), m2 = m * m;
  const float coat = specular + (1 - specular) * m2 * m2 * m, base = kernel::v_luminance(diffuse_);
  choose_diffuse_ = std::clamp(base / std::max(base + coat, 1e-6f), 0.1f, 0.9f);
}

Vec3 SurfaceBsdf::evaluate(Vec3 to_light) const {
  const float cosine = dot(normal_, to_light);
  if (!(cosine > 0)) return {0, 0, 0};
  const float gloss = kernel::shade_ggx(normal_, to_eye_, to_light, specular_, roughness_);
  return diffuse_ * (cosine / kPi) + Vec3(gloss, gloss, gloss);
}

float SurfaceBsdf::pdf(Vec3 to_light) const {
  const float cosine = dot(normal_, to_light);
  if (!(cosine > 0)) return 0;
  const Vec3 sum = to_eye_ + to_light;
  const Vec3 h = normalize(sum);
  const float nh = std::clamp(dot(normal_, h), 0.f, 1.f), vh = std::max(std::fabs(dot(to_eye_, h)), 1e-4f);
  return choose_diffuse_ * cosine / kPi + (1 - choose_diffuse_) * ggx(nh, roughness_) * nh / (4 * vh);
}

FiberSample SurfaceBsdf::sample(std::array<float, 4> u) const {
  const float around = 2 * kPi * u[2];
  const auto about_normal = [&](float cosine) {
    const float r = std::sqrt(std::max(0.f, 1 - cosine * cosine));
    return tangent_ * (r * std::cos(around)) + bitangent_ * (r * std::sin(around)) + normal_ * cosine;
  };
  FiberSample s{{}, {0, 0, 0}, 0, kLobe};
  if (u[0] < choose_diffuse_) {
    s.direction = about_normal(std::sqrt(1 - u[1]));
  } else {
    // Walter 2007, eq. 35.
    const float tan2 = roughness_ * roughness_ * u[1] / (1 - u[1]);
    const Vec3 h = about_normal(1 / std::sqrt(1 + tan2));
    s.direction = h * (2 * dot(to_eye_, h)) - to_eye_;
  }
  s.direction = normalize(s.direction);
  s.pdf = pdf(s.direction);
  s.value = evaluate(s.direction);
  return s;
}

}  // namespace pelage
