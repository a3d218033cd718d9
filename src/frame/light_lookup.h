// What the maps of the lights say about one place: the scalar definition that every look-up agrees with.
#pragma once

#include <pelage/vec.h>

#include <array>

#include "frame/frame.h"

namespace pelage {

/// Camera-space position of a world-space point (x right, y down, z forward), and where the map sees it.
struct MapPlace {
  float x, y;     ///< texels
  float z;        ///< metres in front of the light
  bool in_front;  ///< z is beyond the near plane; otherwise x and y mean nothing
};
MapPlace place_on_map(const CameraView& view, Vec3 world);

/// Blocks in a row of OpacityMap::first_depth.
inline std::size_t origin_columns(const CameraView& view) {
  return static_cast<std::size_t>((view.width + OpacityMap::kOriginBlock - 1) / OpacityMap::kOriginBlock);
}

/// Layer of the map that holds `depth` behind the first strand; the last one for all that is deeper.
inline int layer_of(const OpacityMap& map, float depth) {
  int layer = 0;
  while (layer + 1 < OpacityMap::kLayers && depth > map.layer_end[static_cast<std::size_t>(layer)]) ++layer;
  return layer;
}

/// Expected number of strands between the light and `p` (world space), bilinear between texels; 0 outside the map.
float crossings_at(const OpacityMap& map, Vec3 p);

/// Metres that something must lie in front of a place to shade it: keeps roots from being shaded by their own scalp.
struct ShadowBias {
  float metres = 0;     ///< constant part
  float texels = 1.5f;  ///< part that grows with the size of a texel there
};

/// Share of the light that the meshes let pass to `p`, 0…1: percentage-closer filtering over 3×3 texels with a tent
/// (Reeves 1987; references.bib: Reeves1987Shadows); 1 outside the map.
float mesh_visibility(const ShadowMap& map, Vec3 p, ShadowBias bias);

/// Light that arrives at a place if nothing stands between.
struct Illumination {
  Vec3 to_light;    ///< unit length
  float distance;   ///< metres; +inf for directional lights
  Vec3 irradiance;  ///< W/m² on a surface that faces the light
};
Illumination illuminate(const Light& light, Vec3 p);
/// The same, but dark outside the view of a light that is one face of several.
Illumination illuminate(const PreparedLight& light, Vec3 p);

/// Irradiance of the environment on a surface with this unit normal, W/m²; never negative.
Vec3 environment_irradiance(const std::array<Vec3, 9>& harmonics, Vec3 normal);

}  // namespace pelage
