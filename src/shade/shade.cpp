#include "shade/shade.h"

#include <bit>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/light_lookup.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"
#include "shade/visible.h"

namespace pelage {
namespace {

constexpr ShadowBias kHairBias{0.002f, 1.5f};

Vec3 shade_sample(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const LightRig& rig,
                  Vec2 screen, PixelKey key) {
  const SegmentRef segment = find_segment(scene, numbering, static_cast<std::uint32_t>(key));
  const float t = locate_on_segment(scene, numbering, view, segment, screen.x, screen.y);
  const StrandSurface s = surface_at(scene, numbering, segment, t);
  const HairMaterial& material = scene.grooms[segment.groom].material;
  const Vec3 eye = transform_point(view.camera_to_world, {0, 0, 0});
  const Vec3 to_eye = normalize(eye - s.position);
  Vec3 sum;
  for (const PreparedLight& light : rig.lights) {
    const Illumination i = illuminate(light, s.position);
    const float sin_i = dot(i.to_light, s.tangent), cos_i = std::sqrt(std::max(0.f, 1 - sin_i * sin_i));
    const float sin_o = dot(to_eye, s.tangent);
    const float h = kernel::m_asin(sin_i) + kernel::m_asin(sin_o), v = 4 * material.beta_longitudinal * material.beta_longitudinal;
    const float open = kernel::light_transmittance(0.4f * crossings_at(light.opacity, s.position)) *
                       mesh_visibility(light.shadow, s.position, kHairBias);
    const float gloss = 0.02f * std::exp(-h * h / (2 * v)) / std::sqrt(v);
    sum += (material.color * (cos_i * 0.2f) + Vec3(gloss, gloss, gloss)) * i.irradiance * open;
  }
  return sum;
}

}  // namespace

Radiance shade(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer,
               const LightRig& rig, std::span<const Vec2> sample_positions) {
  const bool sampled = !gbuffer.sample_keys.empty();
  const Buffer<PixelKey>& keys = sampled ? gbuffer.sample_keys : gbuffer.center;
  const int samples = sampled ? gbuffer.samples : 1;
  PELAGE_CHECK_EQ(sample_positions.size(), static_cast<std::size_t>(samples));
  VisibleList list = list_visible({keys.data(), keys.size()}, samples);
  Radiance radiance;
  radiance.index = std::move(list.index);
  radiance.color.resize(list.samples.size());
  parallel_for(list.samples.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const VisibleSample& s = list.samples[i];
      const Vec2 p = sample_positions[s.sample];
      const Vec2 screen{static_cast<float>(s.pixel % static_cast<std::uint32_t>(view.width)) + p.x,
                        static_cast<float>(s.pixel / static_cast<std::uint32_t>(view.width)) + p.y};
      radiance.color[i] = shade_sample(scene, view, numbering, rig, screen, s.key);
    }
  });
  return radiance;
}

}  // namespace pelage
