#include "light/light.h"

#include <algorithm>

#include "frame/strand_part.h"
#include "light/environment.h"
#include "light/light_view.h"
#include "light/opacity_map.h"
#include "light/probe.h"
#include "light/shadow_map.h"
#include "light/strand_lines.h"

namespace pelage {
namespace {

/// The environment is cut into 2^n pieces: 16, as Andersen 2016 does (references.bib: Andersen2016HybridFur).
constexpr int kEnvironmentLevels = 4;
/// Their maps are blurred by their spread anyway.
constexpr int kEnvironmentMapSize = 192;
/// … and drawn from about this many strands at least.
constexpr std::size_t kEnvironmentStrands = 4000;
/// Maps of single lights are drawn from about this many strands: the others of a larger groom tell them little.
constexpr std::size_t kLightStrands = 50000;

bool emits(const Light& light) { return light.intensity.x > 0 || light.intensity.y > 0 || light.intensity.z > 0; }

/// Everything that the maps of one light depend on.
struct MapJob {
  const Scene& scene;
  const MeshTracer& meshes;
  const std::vector<StrandLines>& lines;
  Bounds subject;  ///< what the maps look at: the grooms, or the meshes where there are none
  int size;
  std::size_t strand_stride;
};

std::size_t drawn_strands(const Scene& scene) {
  std::size_t total = 0;
  for (const GroomInstance& groom : scene.grooms) total += drawn_parts(groom);
  return total;
}

/// Appends `group` to the rig, with its maps; all opacity maps of a group are drawn together.
void prepare(std::vector<PreparedLight> group, const MapJob& job, LightRig& rig) {
  std::vector<CameraView> views;
  std::vector<std::size_t> owners;
  for (PreparedLight& prepared : group) {
    prepared.light.direction = normalize(prepared.light.direction);
    if (!job.scene.settings.shadows || !prepared.light.casts_shadow || job.subject.empty()) {
      rig.lights.push_back(std::move(prepared));
      continue;
    }
    const std::vector<CameraView> faces = light_views(prepared.light, job.subject, job.size);
    for (const CameraView& view : faces) {
      owners.push_back(rig.lights.size()), views.push_back(view);
      PreparedLight& face = rig.lights.emplace_back();
      face.light = prepared.light, face.spread = prepared.spread;
      face.only_in_view = faces.size() > 1;
      face.shadow = build_shadow_map(job.meshes, view);
    }
  }
  std::vector<OpacityMap> maps = build_opacity_maps(job.lines, views, {job.strand_stride});
  for (std::size_t i = 0; i < maps.size(); ++i) rig.lights[owners[i]].opacity = std::move(maps[i]);
}

/// The environment as directional lights with a spread.
void prepare_environment(MapJob job, LightRig& rig) {
  job.size = std::min(kEnvironmentMapSize, job.scene.settings.opacity_map_size);
  job.strand_stride = std::max<std::size_t>(1, drawn_strands(job.scene) / kEnvironmentStrands);
  std::vector<PreparedLight> group;
  for (const EnvironmentPiece& piece : cut_environment(job.scene.environment, kEnvironmentLevels)) {
    PreparedLight& prepared = group.emplace_back();
    prepared.light.type = Light::Type::kDirectional;
    prepared.light.name = "environment";
    prepared.light.direction = -piece.from;
    prepared.light.intensity = piece.irradiance;
    prepared.spread = piece.spread;
  }
  prepare(std::move(group), job, rig);
}

}  // namespace

LightRig prepare_lights(const Scene& scene, const MeshTracer& meshes) {
  LightRig rig;
  const std::vector<StrandLines> lines = strand_lines(scene.grooms);
  const Bounds hair = bounds(lines);
  for (const StrandLines& l : lines) rig.strands.extend(l.reach());
  MapJob job{scene,
             meshes,
             lines,
             hair.empty() ? meshes.bounds() : hair,
             scene.settings.opacity_map_size,
             std::max<std::size_t>(1, (drawn_strands(scene) + kLightStrands / 2) / kLightStrands)};
  std::vector<PreparedLight> group;
  for (const Light& light : scene.lights) {
    if (!emits(light)) continue;
    group.emplace_back().light = light;
  }
  prepare(std::move(group), job, rig);

  if (environment_lighting(scene.settings) == EnvironmentLighting::kProbe) rig.probe = make_probe(scene.environment);
  else prepare_environment(job, rig);
  rig.irradiance = irradiance_harmonics(scene.environment);
  return rig;
}

std::size_t resident_bytes(const LightRig& rig) {
  std::size_t total = rig.probe.texels.bytes();
  for (const PreparedLight& l : rig.lights)
    total += l.opacity.first_depth.bytes() + l.opacity.crossings.bytes() + l.shadow.depth.bytes();
  return total;
}

}  // namespace pelage
