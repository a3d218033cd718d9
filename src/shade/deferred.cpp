#include "shade/deferred.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/fiber.h"
#include "frame/material_map.h"
#include "frame/reproject.h"
#include "groom/hairmesh/prepared.h"
#include "shade/batch.h"
#include "shade/evaluate.h"
#include "shade/visible.h"

namespace pelage {
namespace {

constexpr std::size_t kCells = std::size_t{kUvCells} * kUvCells;

/// What a cell of (u, v) says about the strands there.
struct CellFacts {
  std::uint16_t groom = 0;  ///< of the DeferredGrooms
  float depth_shift = 0;    ///< Δ of Lipp 2026, eq. 8
};

/// Share of the width of all strands that is drawn, by cell of the groom: β of eq. 8, for bundles with more than one cell or less.
std::vector<float> drawn_shares(const DeferredGroom& groom, std::uint32_t number, const LodSelection& selection,
                                const UvCells& cells) {
  std::vector<float> drawn(std::size_t{cells.count} * cells.count), all(drawn.size());
  constexpr std::uint32_t kProbes = 64;
  for (const BundleDraw& draw : selection.bundles) {
    if (draw.groom != number) continue;
    const BundleCage& cage = groom.mesh->cages[draw.bundle];
    const auto strands = static_cast<float>(cage.bundle->strands);
    const float share = static_cast<float>(draw.strands) * draw.width_scale / strands;
    for (std::uint32_t i = 0; i < kProbes; ++i) {
      const Vec2 uv = groom_place(cage, i);
      const auto count = static_cast<float>(cells.count);
      const auto cell = static_cast<std::size_t>(kernel::raster_cell(uv.y, count)) * cells.count +
                        static_cast<std::size_t>(kernel::raster_cell(uv.x, count));
      drawn[cell] += strands * share, all[cell] += strands;
    }
  }
  for (std::size_t c = 0; c < drawn.size(); ++c) drawn[c] = all[c] > 0 ? std::min(drawn[c] / all[c], 1.f) : 1.f;
  return drawn;
}

std::vector<CellFacts> cell_facts(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection) {
  std::vector<CellFacts> facts(kCells);
  const SwrSettings& settings = scene.settings.swr;
  const bool shifted = settings.lod && settings.depth_correction && !settings.thicken;
  for (std::size_t g = 0; g < grooms.size(); ++g) {
    const UvCells cells = uv_cells(g, grooms.size());
    const std::vector<float> shares =
        shifted ? drawn_shares(grooms[g], static_cast<std::uint32_t>(g), selection, cells) : std::vector<float>();
    for (std::uint32_t v = 0; v < cells.count; ++v)
      for (std::uint32_t u = 0; u < cells.count; ++u) {
        CellFacts& f = facts[std::size_t{cells.first_v + v} * kUvCells + cells.first_u + u];
        f.groom = static_cast<std::uint16_t>(g);
        if (shifted) f.depth_shift = kernel::lod_depth_shift(shares[std::size_t{v} * cells.count + u]);
      }
  }
  return facts;
}

/// Everything that gathering reads.
struct Gather {
  const Scene& scene;
  std::span<const DeferredGroom> grooms;
  const DeferredBuffer& buffer;
  std::span<const Vec2> sample_positions;
  const Buffer<PixelKey>& keys;
  std::vector<CellFacts> facts;
  std::vector<Vec3> absorption;  // of grooms without maps
};

const CellFacts& facts_of(const Gather& g, PixelKey key) {
  return g.facts[std::size_t{deferred::v_cell(key)} * kUvCells + deferred::u_cell(key)];
}

/// The middle of the cells of uvw.
GroomPlace groom_place(const Gather& g, PixelKey key, std::uint32_t groom) {
  const UvCells cells = uv_cells(groom, g.grooms.size());
  const auto middle = [](std::uint32_t cell, std::uint32_t count) {
    return (static_cast<float>(cell) + 0.5f) / static_cast<float>(count);
  };
  return {middle(deferred::u_cell(key) - cells.first_u, cells.count),
          middle(deferred::v_cell(key) - cells.first_v, cells.count), middle(deferred::w_cell(key), 64)};
}

/// Absorption of what the key shows; tells lane `i` its roughness and tilt where maps have them.
Vec3 set_material(const Gather& g, PixelKey key, std::uint32_t groom, const ShadeConstants& constants, ShadeBatch& batch,
                  std::size_t i) {
  const GroomInstance& instance = g.scene.grooms[g.grooms[groom].groom];
  const bool colored = has_color_maps(instance);
  if (!colored && !constants.mapped) return g.absorption[groom];
  const GroomPlace place = groom_place(g, key, groom);
  const HairMaterial material =
      constants.mapped ? set_finish(constants, mapped_finish(instance, place), batch, i) : instance.material;
  return colored ? kernel::scatter_absorption(mapped_color(instance, place), material.beta_azimuthal)
                 : fiber_absorption(material, material.color);
}

/// World-space place of a sample, from its depth.
Vec3 place_of(const Gather& g, std::uint32_t key_number, PixelKey key) {
  const CameraView& view = g.buffer.view;
  const auto width = static_cast<std::uint32_t>(view.width), samples = static_cast<std::uint32_t>(g.sample_positions.size());
  const std::uint32_t pixel = key_number / samples;
  const Vec2 in_pixel = g.sample_positions[key_number % samples];
  const Vec2 at(static_cast<float>(pixel % width) + in_pixel.x, static_cast<float>(pixel / width) + in_pixel.y);
  return transform_point(view.camera_to_world, unproject(view, at, g.buffer.range.metres(deferred::depth_level(key))));
}

void gather_lane(const Gather& g, std::uint32_t number, const ShadeConstants& constants, ShadeBatch& batch, std::size_t i) {
  const CameraView& view = g.buffer.view;
  const PixelKey key = g.keys[number];
  const CellFacts& facts = facts_of(g, key);
  const Vec3 position = place_of(g, number, key), tangent = deferred::tangent(key);
  const Vec3 to_eye = direction_to_eye(view, position);
  const Vec3 absorption = set_material(g, key, facts.groom, constants, batch, i);
  batch.px[i] = position.x, batch.py[i] = position.y, batch.pz[i] = position.z;
  batch.tx[i] = tangent.x, batch.ty[i] = tangent.y, batch.tz[i] = tangent.z;
  batch.ex[i] = to_eye.x, batch.ey[i] = to_eye.y, batch.ez[i] = to_eye.z;
  batch.absorb_r[i] = absorption.x, batch.absorb_g[i] = absorption.y, batch.absorb_b[i] = absorption.z;
  batch.depth_shift[i] = facts.depth_shift;
  batch.occlusion[i] = g.scene.settings.swr.occlusion ? deferred::occlusion(key) : 1.f;
}

/// Shades what the keys at `visible` show, at most ShadeBatch::kSize of them, groom by groom.
void shade_block(const Gather& g, const std::vector<ShadeConstants>& constants, std::span<const std::uint32_t> visible,
                 ShadeBatch& batch, Vec3* color) {
  std::array<std::uint32_t, ShadeBatch::kSize> taken;
  for (std::size_t groom = 0; groom < constants.size(); ++groom) {
    batch.count = 0;
    for (std::uint32_t i = 0; i < visible.size(); ++i) {
      if (facts_of(g, g.keys[visible[i]]).groom != groom) continue;
      gather_lane(g, visible[i], constants[groom], batch, batch.count);
      taken[batch.count++] = i;
    }
    if (batch.count == 0) continue;
    pad(batch);
    evaluate(constants[groom], batch);
    for (std::size_t j = 0; j < batch.count; ++j) color[taken[j]] = {batch.r[j], batch.g[j], batch.b[j]};
  }
}

}  // namespace

DeferredMaterials::DeferredMaterials(const Scene& scene, std::span<const DeferredGroom> grooms, const LightRig& rig) {
  std::vector<ShadeConstants> constants;
  for (const DeferredGroom& groom : grooms)
    constants.push_back(shade_constants(scene.grooms[groom.groom], scene.settings.dual_scattering, rig));
  constants_ = std::make_shared<const std::vector<ShadeConstants>>(std::move(constants));
}

Radiance shade_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                        const DeferredBuffer& buffer, const DeferredMaterials& materials,
                        std::span<const Vec2> sample_positions) {
  const bool sampled = buffer.samples > 1;
  const Buffer<PixelKey>& keys = sampled ? buffer.sample_keys : buffer.center;
  PELAGE_CHECK_EQ(sample_positions.size(), static_cast<std::size_t>(sampled ? buffer.samples : 1));
  VisibleList list = list_visible({keys.data(), keys.size()}, static_cast<int>(sample_positions.size()));
  Radiance radiance;
  radiance.index = std::move(list.index);
  radiance.color.resize(list.first.size());
  Gather gather{scene, grooms, buffer, sample_positions, keys, cell_facts(scene, grooms, selection), {}};
  for (const DeferredGroom& groom : grooms) {
    const HairMaterial& material = scene.grooms[groom.groom].material;
    gather.absorption.push_back(fiber_absorption(material, material.color));
  }
  parallel_for(list.first.size(), ShadeBatch::kSize, [&](std::size_t begin, std::size_t end) {
    ShadeBatch batch;
    shade_block(gather, materials.constants(), {list.first.data() + begin, end - begin}, batch, radiance.color.data() + begin);
  });
  return radiance;
}

}  // namespace pelage
