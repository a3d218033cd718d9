#include "shade/shade.h"

#include <array>
#include <optional>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/fiber.h"
#include "frame/section.h"
#include "frame/segment_lookup.h"
#include "shade/batch.h"
#include "shade/evaluate.h"
#include "shade/visible.h"

namespace pelage {
namespace {

/// Everything that gathering reads.
struct Gather {
  const Scene& scene;
  const CameraView& view;
  const SegmentNumbering& numbering;
  std::span<const Vec2> sample_positions;
  const Buffer<PixelKey>& keys;    ///< of all pixels, as many adjacent ones as there are positions
  const VisibilityPacker* packer;  ///< null where they are not asked for
};

Vec2 screen_place(const Gather& g, std::uint32_t key) {
  const auto width = static_cast<std::uint32_t>(g.view.width), samples = static_cast<std::uint32_t>(g.sample_positions.size());
  const std::uint32_t pixel = key / samples, row = pixel / width;
  const Vec2 in_pixel = g.sample_positions[key % samples];
  return {static_cast<float>(pixel % width) + in_pixel.x, static_cast<float>(row) + in_pixel.y};
}

void gather_lane(const Gather& g, std::uint32_t key, const SegmentRef& segment, const ShadeConstants& constants,
                 ShadeBatch& batch, std::size_t i, StrandSample* visibility) {
  const GroomInstance& groom = g.scene.grooms[segment.groom];
  const Vec2 at = screen_place(g, key);
  const float t = locate_on_segment(g.scene, g.numbering, g.view, segment, at.x, at.y);
  const StrandSurface s = surface_at(g.scene, g.numbering, segment, t);
  const Vec3 to_eye = direction_to_eye(g.view, s.position);
  const HairMaterial material =
      constants.mapped ? set_finish(constants, strand_finish(groom, segment.strand, s.u), batch, i) : groom.material;
  const Vec3 absorption = fiber_absorption(material, strand_color(groom, segment.strand, segment.span));
  batch.px[i] = s.position.x, batch.py[i] = s.position.y, batch.pz[i] = s.position.z;
  batch.tx[i] = s.tangent.x, batch.ty[i] = s.tangent.y, batch.tz[i] = s.tangent.z;
  batch.ex[i] = to_eye.x, batch.ey[i] = to_eye.y, batch.ez[i] = to_eye.z;
  batch.absorb_r[i] = absorption.x, batch.absorb_g[i] = absorption.y, batch.absorb_b[i] = absorption.z;
  batch.fiber_radius[i] = 0.5f * s.width;
  if (constants.bundled) set_bundle(bundle_at(g.scene, g.numbering, segment, t, s, to_eye), batch, i);
  if (visibility) *visibility = g.packer->sample(segment, t, s);
}

/// Shades what the keys at `visible` show, at most ShadeBatch::kSize of them, groom by groom. `visibility` may be null.
void shade_block(const Gather& g, const std::vector<ShadeConstants>& constants, std::span<const std::uint32_t> visible,
                 Evaluator evaluator, ShadeBatch& batch, Vec3* color, StrandSample* visibility) {
  std::array<SegmentRef, ShadeBatch::kSize> segments;
  std::array<std::uint32_t, ShadeBatch::kSize> pending, left, taken;
  std::size_t pending_count = visible.size();
  for (std::size_t i = 0; i < visible.size(); ++i) {
    segments[i] = find_segment(g.scene, g.numbering, static_cast<std::uint32_t>(g.keys[visible[i]]));
    pending[i] = static_cast<std::uint32_t>(i);
  }
  while (pending_count > 0) {
    const std::uint32_t groom = segments[pending[0]].groom;
    std::size_t left_count = 0;
    batch.count = 0;
    for (std::size_t j = 0; j < pending_count; ++j) {
      const std::uint32_t i = pending[j];
      if (segments[i].groom != groom) {
        left[left_count++] = i;
        continue;
      }
      gather_lane(g, visible[i], segments[i], constants[groom], batch, batch.count, visibility ? visibility + i : nullptr);
      taken[batch.count++] = i;
    }
    pad(batch);
    evaluator(constants[groom], batch);
    for (std::size_t j = 0; j < batch.count; ++j) color[taken[j]] = {batch.r[j], batch.g[j], batch.b[j]};
    pending = left, pending_count = left_count;
  }
}

}  // namespace

Radiance shade(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer,
               const LightRig& rig, std::span<const Vec2> sample_positions, Buffer<StrandSample>* visibility) {
  return shade_with(evaluate, scene, view, numbering, gbuffer, rig, sample_positions, visibility);
}

Radiance shade_with(Evaluator evaluator, const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                    const GBuffer& gbuffer, const LightRig& rig, std::span<const Vec2> sample_positions,
                    Buffer<StrandSample>* visibility) {
  const bool sampled = !gbuffer.sample_keys.empty();
  const Buffer<PixelKey>& keys = sampled ? gbuffer.sample_keys : gbuffer.center;
  const int samples = sampled ? gbuffer.samples : 1;
  PELAGE_CHECK_EQ(sample_positions.size(), static_cast<std::size_t>(samples));
  VisibleList list = list_visible({keys.data(), keys.size()}, samples);
  Radiance radiance;
  radiance.index = std::move(list.index);
  radiance.color.resize(list.first.size());

  std::optional<VisibilityPacker> packer;
  if (visibility) packer.emplace(scene, view, numbering), visibility->resize(list.first.size());
  const Gather gather{scene, view, numbering, sample_positions, keys, packer ? &*packer : nullptr};
  std::vector<ShadeConstants> constants;
  for (const GroomInstance& groom : scene.grooms) {
    constants.push_back(shade_constants(groom, scene.settings.dual_scattering, rig));
    constants.back().bundled = groom.sections && scene.settings.thick_hairs.scattering == ThickScattering::kAggregate;
  }
  parallel_for(list.first.size(), ShadeBatch::kSize, [&](std::size_t begin, std::size_t end) {
    ShadeBatch batch;
    shade_block(gather, constants, {list.first.data() + begin, end - begin}, evaluator, batch, radiance.color.data() + begin,
                visibility ? visibility->data() + begin : nullptr);
  });
  return radiance;
}

}  // namespace pelage
