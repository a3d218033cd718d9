#include "reference/dual_light.h"

#include <algorithm>
#include <cmath>

#include "frame/fiber.h"

namespace pelage {
namespace {

using Model = HairMaterial::Model;
using namespace kernel;

struct Angles {
  float sin_i, cos_i, cos_phi;
};

Angles angles(const DualPlace& s, Vec3 to_light) {
  const float sin_i = v_clamp(dot(to_light, s.tangent), -1, 1);
  const Vec3 across = v_normalize(to_light - s.tangent * sin_i);
  return {sin_i, std::sqrt(1 - sin_i * sin_i), v_clamp(dot(across, s.across), -1, 1)};
}

/// f·cos of the fiber itself.
Vec3 single(const DualPlace& s, Angles a) {
  if (s.model == Model::kKajiyaKay) return scatter_kajiya_kay(s.lobes, s.tuft_color, a.sin_i, a.cos_i);
  if (s.model == Model::kZhu) return scatter_zhu(s.lobes, a.sin_i, a.cos_i, a.cos_phi);
  if (s.model == Model::kPelekis) return scatter_pelekis(s.pelekis, a.sin_i, a.cos_phi);
  if (s.model == Model::kSadeghi) return scatter_sadeghi(s.artist, a.sin_i, a.cos_i, a.cos_phi);
  return scatter_marschner(s.lobes, a.sin_i, a.cos_i, a.cos_phi);
}

/// The same of light that other fibers scattered forward to it.
Vec3 forwarded(const DualPlace& s, float variance, Angles a) {
  if (s.model == Model::kZhu) return scatter_dual_forward_zhu(s.lobes, variance, a.sin_i, a.cos_i, a.cos_phi);
  if (s.model == Model::kPelekis) return scatter_dual_forward_pelekis(s.pelekis, variance, a.sin_i, a.cos_phi);
  if (s.model == Model::kSadeghi) return scatter_dual_forward_sadeghi(s.artist, variance, a.sin_i, a.cos_i, a.cos_phi);
  return scatter_dual_forward_marschner(s.lobes, variance, a.sin_i, a.cos_i, a.cos_phi);
}

/// Lobes of the models that have Marschner's kinds; of Chiang's near field the mean over the fiber.
ScatterLobes prepare_lobes(Model model, const ScatterFiber& fiber, float sin_o, float cos_o) {
  if (model == Model::kZhu) return scatter_prepare_zhu(fiber, sin_o, cos_o);
  if (model == Model::kChiang) return scatter_prepare_chiang_far(fiber, sin_o, cos_o);
  return scatter_prepare_marschner(fiber, sin_o, cos_o);
}

/// Mean forward attenuation of a strand of Sadeghi's model, the same for every inclination.
Vec3 artist_attenuation(const HairMaterial& material, Vec3 sigma_a) {
  return scatter_averages_sadeghi(scatter_prepare_sadeghi(make_artist_fiber(material), scatter_crossing_color(sigma_a), 0, 1))
      .a_f;
}

}  // namespace

DualLight::DualLight(const std::vector<GroomInstance>& grooms) {
  for (const GroomInstance& groom : grooms) {
    const Model model = groom.material.model;
    Entry entry{groom.material, has_finish_maps(groom), {}, {}};
    if (entry.mapped) entry.levels = RoughnessLevels(groom);
    if (model != Model::kKajiyaKay && model != Model::kSadeghi)
      for (const float roughness : entry.levels.values())
        entry.attenuation.push_back(forward_attenuation_table(entry.at({roughness, 1})));
    grooms_.push_back(std::move(entry));
  }
}

DualPlace DualLight::place(std::size_t groom, Vec3 color, Finish finish, Vec3 tangent, Vec3 to_eye) const {
  const HairMaterial material = grooms_[groom].at(finish);
  const ScatterFiber fiber = make_fiber(material, color);
  const float sin_o = v_clamp(dot(to_eye, tangent), -1, 1), cos_o = std::sqrt(1 - sin_o * sin_o);
  DualPlace s;
  s.model = material.model;
  s.tangent = tangent;
  s.across = v_normalize(to_eye - tangent * sin_o);
  s.tuft_color = tuft_color(material, fiber.sigma_a);
  if (s.model == Model::kSadeghi) {
    s.artist = scatter_prepare_sadeghi(make_artist_fiber(material), scatter_crossing_color(fiber.sigma_a), sin_o, cos_o);
    s.averages = scatter_averages_sadeghi(s.artist);
  } else if (s.model == Model::kPelekis) {
    s.pelekis = scatter_prepare_pelekis(fiber, sin_o, cos_o);
    s.averages = scatter_averages_pelekis(s.pelekis);
  } else {
    s.lobes = prepare_lobes(s.model, fiber, sin_o, cos_o);
    s.averages = scatter_averages(s.lobes);
  }
  s.back = scatter_back(s.averages, sin_o, cos_o);
  return s;
}

void DualLight::cross(CrossedStrands& crossed, std::size_t groom, Vec3 color, Finish finish, Vec3 tangent,
                      Vec3 to_light) const {
  const Entry& entry = grooms_[groom];
  const HairMaterial material = entry.at(finish);
  const Vec3 sigma_a = fiber_absorption(material, color);
  ++crossed.count;
  if (material.model == Model::kKajiyaKay) {  // half of what its diffuse lobe scatters goes on
    crossed.attenuation = crossed.attenuation * scatter_tuft_color(sigma_a, material.beta_azimuthal) * 0.5f;
    return;
  }
  if (material.model == Model::kSadeghi) {
    crossed.attenuation = crossed.attenuation * artist_attenuation(material, sigma_a);
    return;
  }
  const float sin_i = v_clamp(dot(to_light, tangent), -1, 1), cos_i = std::sqrt(1 - sin_i * sin_i);
  const ForwardAttenuationTable& table = entry.attenuation[entry.levels.nearest(finish.roughness)];
  crossed.attenuation = crossed.attenuation *
                        Vec3(table.lookup(cos_i, sigma_a.x), table.lookup(cos_i, sigma_a.y), table.lookup(cos_i, sigma_a.z));
}

// Zinke 2008, eq. 5 (transmittance) and section 4: direct light where nothing is crossed, else light that every strand on
// the way scattered forward; each adds the variance of this strand's forward lobes, as they lie alike.
Vec3 DualLight::evaluate(const DualPlace& s, Vec3 to_light, const CrossedStrands& crossed) {
  const Angles a = angles(s, to_light);
  if (s.model == Model::kKajiyaKay) return single(s, a) * crossed.attenuation;
  if (crossed.count == 0) return single(s, a) + scatter_dual_local(s.back, 0, a.sin_i, a.cos_i, a.cos_phi);
  const float variance = scatter_dual_variance(static_cast<float>(crossed.count), s.averages.v_f);
  const Vec3 scattered = forwarded(s, variance, a) + scatter_dual_local(s.back, variance, a.sin_i, a.cos_i, a.cos_phi);
  return scattered * crossed.attenuation * kDualDensity;
}

}  // namespace pelage
