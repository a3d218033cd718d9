#include "light/light.h"

#include <algorithm>

#include "light/environment.h"
#include "light/light_view.h"
#include "light/opacity_map.h"
#include "light/shadow_map.h"
#include "light/strand_lines.h"

namespace pelage {
namespace {

/// The environment is cut into 2^n pieces: 16, as Andersen 2016 does (references.bib: Andersen2016HybridFur).
constexpr int kEnvironmentLevels = 4;
/// Their maps are blurred by their spread anyway.
constexpr int kEnvironmentMapSize = 192;
/// … and drawn from about this many strands.
constexpr std::size_t kEnvironmentStrands = 4000;

bool emits(const Light& light) { return light.intensity.x > 0 || light.intensity.y > 0 || light.intensity.z > 0; }

std::size_t strand_total(const Scene& scene) {
  std::size_t total = 0;
  for (const GroomInstance& groom : scene.grooms) total += groom.strands->strand_count();
  return total;
}

/// Everything that the maps of one light depend on.
struct MapJob {
  const Scene& scene;
  const MeshTracer& meshes;
  const std::vector<StrandLines>& lines;
  Bounds subject;  ///< what the maps look at: the grooms, or the meshes where there are none
  int size;
  std::size_t strand_stride;
};

void prepare(PreparedLight prepared, const MapJob& job, LightRig& rig) {
  prepared.light.direction = normalize(prepared.light.direction);
  if (!job.scene.settings.shadows || !prepared.light.casts_shadow || job.subject.empty()) {
    rig.lights.push_back(std::move(prepared));
    return;
  }
  const std::vector<CameraView> views = light_views(prepared.light, job.subject, job.size);
  for (const CameraView& view : views) {
    PreparedLight face;
    face.light = prepared.light, face.spread = prepared.spread;
    face.only_in_view = views.size() > 1;
    face.opacity = build_opacity_map(job.lines, view, {job.strand_stride});
    face.shadow = build_shadow_map(job.meshes, view);
    rig.lights.push_back(std::move(face));
  }
}

}  // namespace

LightRig prepare_lights(const Scene& scene, const MeshTracer& meshes) {
  LightRig rig;
  const std::vector<StrandLines> lines = strand_lines(scene.grooms);
  const Bounds hair = bounds(lines);
  MapJob job{scene, meshes, lines, hair.empty() ? meshes.bounds() : hair, scene.settings.opacity_map_size, 1};
  for (const Light& light : scene.lights) {
    if (!emits(light)) continue;
    PreparedLight prepared;
    prepared.light = light;
    prepare(std::move(prepared), job, rig);
  }

  job.size = std::min(kEnvironmentMapSize, scene.settings.opacity_map_size);
  job.strand_stride = std::max<std::size_t>(1, strand_total(scene) / kEnvironmentStrands);
  for (const EnvironmentPiece& piece : cut_environment(scene.environment, kEnvironmentLevels)) {
    PreparedLight prepared;
    prepared.light.type = Light::Type::kDirectional;
    prepared.light.name = "environment";
    prepared.light.direction = -piece.from;
    prepared.light.intensity = piece.irradiance;
    prepared.spread = piece.spread;
    prepare(std::move(prepared), job, rig);
  }
  rig.irradiance = irradiance_harmonics(scene.environment);
  return rig;
}

std::size_t resident_bytes(const LightRig& rig) {
  std::size_t total = 0;
  for (const PreparedLight& l : rig.lights)
    total += l.opacity.first_depth.bytes() + l.opacity.crossings.bytes() + l.shadow.depth.bytes();
  return total;
}

}  // namespace pelage
