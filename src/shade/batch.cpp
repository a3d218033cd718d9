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
  for (ShadeBatch::Lanes* lanes :
       {&batch.px, &batch.py, &batch.pz, &batch.tx, &batch.ty, &batch.tz, &batch.ex, &batch.ey, &batch.ez, &batch.absorb_r,
        &batch.absorb_g, &batch.absorb_b, &batch.depth_shift, &batch.occlusion})
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
  using Model = HairMaterial::Model;
  const bool dual = dual_scattering && material.model != Model::kKajiyaKay;
  const bool tabulated = dual && material.model != Model::kSadeghi;
  return {material,
          make_artist_fiber(material),
          dual,
          light_constants(rig),
          probe_constants(rig),
          tabulated ? make_forward_attenuation_table(material) : ForwardAttenuationTable{}};
}

}  // namespace pelage
