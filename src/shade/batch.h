// What one evaluation of shade needs, laid out for lanes.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "frame/frame.h"
#include "frame/dual_scattering_tables.h"
#include "frame/material_map.h"
#include "frame/section.h"

namespace pelage {

/// Evaluations of one groom, as structure of arrays. Lanes from `count` up to the next multiple of the lane count are
/// evaluated too: they hold copies of valid values.
struct ShadeBatch {
  static constexpr std::size_t kSize = 256;
  static constexpr std::size_t kPadding = 64;
  using Lanes = std::array<float, kSize + kPadding>;
  std::size_t count = 0;
  alignas(64) Lanes px, py, pz;                    ///< position on the strand's axis, metres, world
  alignas(64) Lanes tx, ty, tz;                    ///< tangent, unit length
  alignas(64) Lanes ex, ey, ez;                    ///< direction to the eye, unit length
  alignas(64) Lanes absorb_r, absorb_g, absorb_b;  ///< per fiber radius
  alignas(64) Lanes depth_shift{};                 ///< strands between it and every light that are not there after all
  alignas(64) Lanes beta_longitudinal{}, beta_azimuthal{}, tilt{};  ///< of grooms with maps of them; see HairMaterial
  alignas(64) Lanes table{};         ///< of those: where their ForwardAttenuationTable begins, a whole number
  alignas(64) Lanes fiber_radius{};  ///< metres; 0: not known, so that light is what it is where the eye does not look along it
  alignas(64) Lanes fibers{}, half_width{}, half_depth{}, lean{};  ///< of thick hairs: SeenBundle
  /// share of the probe's light that arrives, 0…1; 1 where none is baked
  alignas(64) Lanes occlusion = ones();
  alignas(64) Lanes r, g, b;  ///< result: radiance, W/(m²·sr)

 private:
  static Lanes ones() {
    Lanes lanes;
    lanes.fill(1);
    return lanes;
  }
};

/// Copies lane 0 behind the last one, so that whole vectors see valid numbers.
void pad(ShadeBatch& batch);

/// A map of a light, as plain numbers and pointers that outlive the evaluation.
struct MapConstants {
  float row[3][4];  ///< world to camera
  float focal = 1, center_x = 0, center_y = 0, near_plane = 0;
  bool perspective = false;
  float last_x = 0, last_y = 0;  ///< width − 1, height − 1
  std::int32_t width = 0, origin_width = 0;
  const float* depth = nullptr;  ///< opacity: first depths of blocks; shadow: depths. Null: no map
  const std::uint32_t* crossings = nullptr;
  std::array<float, OpacityMap::kLayers> layer_end{};
};

/// A light, as plain numbers.
struct LightConstants {
  Light::Type type = Light::Type::kDirectional;
  Vec3 position, to_light, intensity;
  float cos_inner = 0, cos_outer = 0;
  float spread2 = 0;      ///< radians², variance of its directions
  float mean_cosine = 1;  ///< of its directions to their mean
  bool wide = false;      ///< so spread that its azimuth is averaged over a half circle
  bool only_in_view = false;
  MapConstants opacity, shadow;
};

/// The environment by its probe, as plain numbers and pointers that outlive the evaluation.
struct ProbeConstants {
  const float* texels = nullptr;  ///< EnvironmentProbe::texels; null: pieces among the lights stand for the environment
  std::array<Vec3, 9> irradiance{};
};

/// What all evaluations of a groom share.
struct ShadeConstants {
  HairMaterial material;
  kernel::ScatterArtistFiber artist;  ///< of kSadeghi
  bool dual_scattering = true;
  std::vector<LightConstants> lights;
  ProbeConstants probe;
  bool bundled = false;            ///< thick hairs, which scatter as the bundles of the lanes
  bool mapped = false;             ///< roughness and tilt are those of the lanes
  RoughnessLevels levels;          ///< of the groom's maps
  std::vector<float> attenuation;  ///< a ForwardAttenuationTable of each level; empty without dual scattering, and of kSadeghi
};

/// Radians: a light of more spread than this counts as coming from a half circle of azimuths.
inline constexpr float kWideSpread = 0.25f;

std::vector<LightConstants> light_constants(const LightRig& rig);
ProbeConstants probe_constants(const LightRig& rig);
/// Makes the material's table where dual scattering is on and the model needs one: Kajiya-Kay does not know it, Sadeghi's
/// lobes do not depend on the inclination.
ShadeConstants shade_constants(const HairMaterial& material, bool dual_scattering, const LightRig& rig);
/// The same with the tables that the groom's maps of roughness need.
ShadeConstants shade_constants(const GroomInstance& groom, bool dual_scattering, const LightRig& rig);
/// Tells lane `i`, of thick hairs, which bundle it is.
void set_bundle(const SeenBundle& bundle, ShadeBatch& batch, std::size_t i);
/// Tells lane `i`, of a groom with maps of roughness or tilt, its own; returns the material there.
HairMaterial set_finish(const ShadeConstants& constants, Finish finish, ShadeBatch& batch, std::size_t i);

}  // namespace pelage
