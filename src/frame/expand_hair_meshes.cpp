#include <pelage/scene.h>

#include <algorithm>
#include <memory>

#include "frame/material_map.h"

namespace pelage {
namespace {

/// Color of every point, from the maps of the groom.
void color_points(const GroomInstance& groom, StrandSet& set) {
  set.colors.resize(set.point_count());
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    for (std::uint32_t i = set.offsets[s]; i < set.offsets[s + 1]; ++i) {
      const float w = static_cast<float>(i - set.offsets[s]) / static_cast<float>(set.offsets[s + 1] - set.offsets[s] - 1);
      set.colors[i] = mapped_color(groom, {set.root_uv[s].x, set.root_uv[s].y, w});
    }
}

}  // namespace

bool has_unmade_strands(const Scene& scene) {
  return std::any_of(scene.grooms.begin(), scene.grooms.end(),
                     [](const GroomInstance& groom) { return groom.hair_mesh && !groom.strands; });
}

void expand_hair_meshes(Scene& scene, const Progress& progress) {
  for (GroomInstance& groom : scene.grooms) {
    if (!groom.hair_mesh || groom.strands) continue;
    StrandSet set = expand(*groom.hair_mesh, {.points = kHairMeshPoints}, progress);  // as method swr draws it
    if (has_color_maps(groom)) {
      color_points(groom, set);
      groom.material.color_source = HairMaterial::ColorSource::kStrand;
    }
    groom.strands = std::make_shared<const StrandSet>(std::move(set));
  }
}

}  // namespace pelage
