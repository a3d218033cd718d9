#include "raster/opaque.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/light_lookup.h"
#include "kernel/scalar.h"
#include "raster/coat.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
constexpr std::size_t kMaxSamples = 16;
/// Pixels that are traced together.
constexpr std::size_t kRunPixels = 256;
/// Samples share a shade where normals differ by less than about 11° …
constexpr float kSharedNormal = 0.98f;
/// … and depths by less than this share.
constexpr float kSharedDepth = 0.02f;
/// Shadow rays start this share of the camera distance off the surface.
constexpr float kRayOffset = 2e-4f;
/// Metres that a mesh must be in front of a surface in an environment piece's coarse shadow map, in texels.
constexpr ShadowBias kEnvironmentBias{0, 2.5f};

/// A hit with what shading needs; normals face the eye.
struct Shading {
  Surface surface;
  Vec3 to_eye;
  float depth;
  const MeshInstance* material;
  const CoatAlbedo* coat;
};

using Coats = std::vector<CoatAlbedo>;  // [meshes]

Shading shading_at(const Scene& scene, const Coats& coats, const MeshTracer& meshes, const Ray& ray, const RayHit& hit) {
  Shading s{meshes.surface(hit), normalize(-ray.direction), hit.distance, &scene.meshes[hit.mesh], &coats[hit.mesh]};
  if (dot(s.surface.geometric_normal, s.to_eye) < 0)
    s.surface.normal = -s.surface.normal, s.surface.geometric_normal = -s.surface.geometric_normal,
    s.surface.lifted = s.surface.position;
  return s;
}

bool same_shade(const Shading& a, const Shading& b) {
  return a.material == b.material && dot(a.surface.normal, b.surface.normal) > kSharedNormal &&
         std::fabs(a.depth - b.depth) < kSharedDepth * a.depth;
}

/// For light on the side of the eye.
bool in_shadow(const MeshTracer& meshes, const Shading& s, const Illumination& light) {
  const float offset = kRayOffset * s.depth;
  const Ray ray{s.surface.lifted + s.surface.geometric_normal * offset, light.to_light, offset, light.distance - offset};
  bool hit = false;
  meshes.occluded({&ray, 1}, {&hit, 1});
  return hit;
}

Vec3 direct_light(const Scene& scene, const MeshTracer& meshes, const Shading& s, const PreparedLight& prepared) {
  const Illumination light = illuminate(prepared, s.surface.position);
  const float cosine = dot(s.surface.normal, light.to_light);
  if (cosine <= 0 || light.irradiance == Vec3(0, 0, 0)) return {0, 0, 0};
  const bool shadowed = scene.settings.shadows && prepared.light.casts_shadow;
  if (shadowed && in_shadow(meshes, s, light)) return {0, 0, 0};
  const float open = kernel::light_transmittance(crossings_at(prepared.opacity, s.surface.position));
  const float gloss =
      kernel::shade_ggx(s.surface.normal, s.to_eye, light.to_light, s.material->specular, s.material->roughness);
  const Vec3 matte = s.surface.color * ((1 - s.material->specular) * cosine / kPi);
  return (matte + Vec3(gloss, gloss, gloss)) * light.irradiance * open;
}

/// Share of the environment's light on the surface that neither meshes nor strands keep off.
float environment_visibility(const Shading& s, const LightRig& rig) {
  float seen = 0, all = 0;
  for (const PreparedLight& piece : rig.lights) {
    if (piece.spread == 0) continue;
    const Vec3 to_light = -piece.light.direction;
    // A piece is wide: it lights a surface a little past the horizon of its center.
    const float weight =
        std::max(dot(s.surface.normal, to_light) + 0.5f * piece.spread, 0.f) * kernel::v_luminance(piece.light.intensity);
    if (weight == 0) continue;
    all += weight;
    const float open = kernel::light_transmittance(crossings_at(piece.opacity, s.surface.position));
    seen += weight * open * mesh_visibility(piece.shadow, s.surface.position, kEnvironmentBias);
  }
  return all > 0 ? seen / all : 1;
}

/// The environment by its irradiance. A coat that is as rough as skin blurs it about as irradiance does, so what comes from
/// around the mirrored direction is taken from there.
Vec3 environment_light(const LightRig& rig, const Shading& s) {
  const Vec3 n = s.surface.normal, mirrored = n * (2 * dot(n, s.to_eye)) - s.to_eye;
  const Vec3 matte = s.surface.color * environment_irradiance(rig.irradiance, n) * (1 - s.material->specular);
  const Vec3 gloss = environment_irradiance(rig.irradiance, mirrored) * s.coat->seen_from(dot(n, s.to_eye));
  return (matte + gloss) * (environment_visibility(s, rig) / kPi);
}

Vec3 shade_opaque(const Scene& scene, const MeshTracer& meshes, const LightRig& rig, const Shading& s) {
  Vec3 sum = environment_light(rig, s);
  for (const PreparedLight& light : rig.lights)
    if (light.spread == 0) sum += direct_light(scene, meshes, s, light);
  return sum;
}

/// Fills the depths and shades of a pixel and appends its distinct colors to `colors`.
void trace_pixel(const Scene& scene, const Coats& coats, const CameraView& view, std::span<const Vec2> positions,
                 const MeshTracer& meshes, const LightRig& rig, int x, int y, float* depth, std::uint8_t* shade,
                 std::vector<Vec3>& colors) {
  std::array<Ray, kMaxSamples> rays;
  std::array<RayHit, kMaxSamples> hits;
  const std::size_t n = positions.size();
  for (std::size_t i = 0; i < n; ++i)
    rays[i] = camera_ray(view, static_cast<float>(x) + positions[i].x, static_cast<float>(y) + positions[i].y);
  meshes.trace({rays.data(), n}, {hits.data(), n});
  std::array<Shading, kMaxSamples> shaded;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    depth[i] = hits[i].distance, shade[i] = OpaqueLayer::kNone;
    if (hits[i].mesh == RayHit::kNone) continue;
    const Shading s = shading_at(scene, coats, meshes, rays[i], hits[i]);
    std::size_t k = 0;
    while (k < count && !same_shade(shaded[k], s)) ++k;
    if (k == count) shaded[count++] = s, colors.push_back(shade_opaque(scene, meshes, rig, s));
    shade[i] = static_cast<std::uint8_t>(k);
  }
}

/// Brings the colors of all runs of pixels together, in their order.
void join_colors(const std::vector<std::vector<Vec3>>& runs, OpaqueLayer& layer) {
  std::vector<std::size_t> begin{0};
  for (const std::vector<Vec3>& run : runs) begin.push_back(begin.back() + run.size());
  layer.color.resize(begin.back());
  parallel_for(runs.size(), 64, [&](std::size_t from, std::size_t to) {
    for (std::size_t r = from; r < to; ++r) {
      std::copy(runs[r].begin(), runs[r].end(), layer.color.data() + begin[r]);
      const std::size_t last = std::min((r + 1) * kRunPixels, layer.first.size());
      for (std::size_t p = r * kRunPixels; p < last; ++p) layer.first[p] += static_cast<std::uint32_t>(begin[r]);
    }
  });
}

}  // namespace

OpaqueLayer trace_opaque(const Scene& scene, const CameraView& view, std::span<const Vec2> sample_positions,
                         const MeshTracer& meshes, const LightRig& rig) {
  PELAGE_CHECK(!sample_positions.empty() && sample_positions.size() <= kMaxSamples);
  OpaqueLayer layer;
  if (meshes.empty()) return layer;
  layer.width = view.width, layer.height = view.height, layer.samples = static_cast<int>(sample_positions.size());
  const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const std::size_t n = sample_positions.size();
  layer.depth.resize(pixels * n), layer.shade.resize(pixels * n), layer.first.resize(pixels);
  Coats coats;
  for (const MeshInstance& mesh : scene.meshes) coats.emplace_back(mesh.specular, mesh.roughness);
  std::vector<std::vector<Vec3>> runs((pixels + kRunPixels - 1) / kRunPixels);
  parallel_for(runs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t p = r * kRunPixels; p < std::min((r + 1) * kRunPixels, pixels); ++p) {
        layer.first[p] = static_cast<std::uint32_t>(runs[r].size());
        trace_pixel(scene, coats, view, sample_positions, meshes, rig,
                    static_cast<int>(p % static_cast<std::size_t>(view.width)),
                    static_cast<int>(p / static_cast<std::size_t>(view.width)), layer.depth.data() + p * n,
                    layer.shade.data() + p * n, runs[r]);
      }
  });
  join_colors(runs, layer);
  return layer;
}

}  // namespace pelage
