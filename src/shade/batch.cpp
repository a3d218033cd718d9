#include "shade/batch.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "frame/fiber.h"
#include "frame/light_lookup.h"

namespace pelage {
namespace {

MapConstants view_constants(const CameraView& view) {
  MapConstants m;
  static_assert(sizeof(m.row) == sizeof(view.world_to_camera.m));
  std::memcpy(m.row, view.world_to_camera.m, sizeof(m.row));
  m.focal = view.focal, m.center_x = view.center_x, m.center_y = view.center_y, m.near_plane = view.near_plane;
  m.perspective = view.perspective;
  m.last_x = static_cast<float>(view.width - 1), m.last_y = static_cast<float>(view.height - 1);
  m.width = view.width;
  m.origin_width = static_cast<std::int32_t>(origin_columns(view));
  return m;
}

MapConstants opacity_constants(const OpacityMap& map) {
  MapConstants m = view_constants(map.view);
  if (map.crossings.empty()) return m;
  m.depth = map.first_depth.data(), m.crossings = map.crossings.data(), m.layer_end = map.layer_end;
  return m;
}

MapConstants shadow_constants(const ShadowMap& map) {
  MapConstants m = view_constants(map.view);
  if (!map.depth.empty()) m.depth = map.depth.data();
  return m;
}

}  // namespace

void pad(ShadeBatch& batch) {
  for (ShadeBatch::Lanes* lanes : {&batch.px,
                                   &batch.py,
                                   &batch.pz,
                                   &batch.tx,
                                   &batch.ty,
                                   &batch.tz,
                                   &batch.ex,
                                   &batch.ey,
                                   &batch.ez,
                                   &batch.absorb_r,
                                   &batch.absorb_g,
                                   &batch.absorb_b,
                                   &batch.depth_shift,
                                   &batch.beta_longitudinal,
                                   &batch.beta_azimuthal,
                                   &batch.tilt,
                                   &batch.table,
                                   &batch.fibers,
                                   &batch.fiber_radius,
                                   &batch.half_width,
                                   &batch.half_depth,
                                   &batch.lean,
                                   &batch.occlusion})
    std::fill_n(lanes->begin() + static_cast<std::ptrdiff_t>(batch.count), ShadeBatch::kPadding, (*lanes)[0]);
}

std::vector<LightConstants> light_constants(const LightRig& rig) {
  std::vector<LightConstants> all;
  for (const PreparedLight& prepared : rig.lights) {
    const Light& light = prepared.light;
    LightConstants k;
    k.type = light.type;
    k.position = light.position, k.to_light = -light.direction, k.intensity = light.intensity;
    k.cos_inner = std::cos(light.inner_angle), k.cos_outer = std::cos(light.outer_angle);
    k.spread2 = prepared.spread * prepared.spread;
    k.mean_cosine = std::exp(-0.5f * k.spread2);
    k.wide = prepared.spread > kWideSpread;
    k.only_in_view = prepared.only_in_view;
    k.opacity = opacity_constants(prepared.opacity), k.shadow = shadow_constants(prepared.shadow);
    all.push_back(k);
  }
  return all;
}

ProbeConstants probe_constants(const LightRig& rig) {
  return {rig.probe.texels.empty() ? nullptr : rig.probe.texels.data(), rig.irradiance};
}

ShadeConstants shade_constants(const HairMaterial& material, bool dual_scattering, const LightRig& rig) {
  GroomInstance groom;
  groom.material = material;
  return shade_constants(groom, dual_scattering, rig);
}

ShadeConstants shade_constants(const GroomInstance& groom, bool dual_scattering, const LightRig& rig) {
  using Model = HairMaterial::Model;
  const HairMaterial& material = groom.material;
  const bool dual = dual_scattering && material.model != Model::kKajiyaKay;
  const bool tabulated = dual && material.model != Model::kSadeghi;
  ShadeConstants k;
  k.material = material, k.artist = make_artist_fiber(material), k.dual_scattering = dual;
  k.lights = light_constants(rig), k.probe = probe_constants(rig);
  k.mapped = has_finish_maps(groom);
  if (k.mapped) k.levels = RoughnessLevels(groom);
  if (!tabulated) return k;
  for (const float roughness : k.levels.values()) {
    const HairMaterial level = k.mapped ? finished(material, {roughness, 1}) : material;
    const std::vector<float> table = forward_attenuation_table(level).a_f;
    k.attenuation.insert(k.attenuation.end(), table.begin(), table.end());
  }
  return k;
}

void set_bundle(const SeenBundle& bundle, ShadeBatch& batch, std::size_t i) {
  constexpr float kNarrowest = 1e-7f;  // a bundle of fibers without width
  batch.fibers[i] = bundle.fibers, batch.fiber_radius[i] = bundle.radius;
  batch.lean[i] = bundle.spread;
  batch.half_width[i] = std::max(0.5f * bundle.extent.width, kNarrowest);
  batch.half_depth[i] = std::max(0.5f * bundle.extent.thickness, kNarrowest);
}

HairMaterial set_finish(const ShadeConstants& k, Finish finish, ShadeBatch& batch, std::size_t i) {
  const HairMaterial material = finished(k.material, finish);
  batch.beta_longitudinal[i] = material.beta_longitudinal, batch.beta_azimuthal[i] = material.beta_azimuthal;
  batch.tilt[i] = material.cuticle_tilt;
  batch.table[i] =
      static_cast<float>(k.levels.nearest(finish.roughness)) * (kernel::kScatterTableRows * kernel::kScatterTableColumns);
  return material;
}

}  // namespace pelage
