#include "lod/bundle_lod.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/bounds.h"
#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "groom/hairmesh/prepared.h"

namespace pelage {
namespace {

/// Least points of a turn of a bundle's fastest wave, and of a span between layers: fewer cut off so much that hair looks darker.
constexpr float kPointsPerTurn = 6, kPointsPerSpan = 2;

/// A box on the screen, pixels.
struct ScreenBox {
  Vec2 min{INFINITY, INFINITY}, max{-INFINITY, -INFINITY};
  float nearest = INFINITY, farthest = -INFINITY;  ///< metres, camera depth
  bool crosses_near_plane = false;

  void extend(const CameraView& view, Vec3 camera_point) {
    nearest = std::min(nearest, camera_point.z), farthest = std::max(farthest, camera_point.z);
    if (!(camera_point.z >= view.near_plane)) {
      crosses_near_plane = true;
      return;
    }
    const Vec2 p = project(view, camera_point);
    min = {std::min(min.x, p.x), std::min(min.y, p.y)}, max = {std::max(max.x, p.x), std::max(max.y, p.y)};
  }
  bool in_view(const CameraView& view) const {
    if (farthest < view.near_plane) return false;
    if (crosses_near_plane) return true;
    return max.x >= 0 && max.y >= 0 && min.x <= static_cast<float>(view.width) && min.y <= static_cast<float>(view.height);
  }
};

/// Eq. 3: the quads of all layers.
ScreenBox cage_box(const HairMesh& mesh, const HairMesh::Bundle& bundle, const Affine& to_camera, const CameraView& view) {
  ScreenBox box;
  for (const std::uint32_t column : bundle.columns)
    for (std::uint32_t i = mesh.column_offsets[column]; i < mesh.column_offsets[column + 1]; ++i)
      box.extend(view, transform_point(to_camera, mesh.positions[i]));
  return box;
}

/// All that its strands can reach.
ScreenBox strand_box(const Bounds& b, const Affine& to_camera, const CameraView& view) {
  ScreenBox box;
  for (const Vec3 corner : corners(b)) box.extend(view, transform_point(to_camera, corner));
  return box;
}

/// Strands and points of one bundle for one view; 0 strands where it is out of view.
BundleDraw choose(const GroomInstance& groom, const PreparedHairMesh& prepared, std::size_t bundle, const Affine& to_camera,
                  const CameraView& view, const SwrSettings& settings) {
  const HairMesh& mesh = *prepared.mesh;
  const HairMesh::Bundle& b = mesh.bundles[bundle];
  BundleDraw draw;
  const ScreenBox reach = strand_box(prepared.boxes[bundle], to_camera, view);
  draw.nearest = std::max(reach.nearest, view.near_plane);
  if (!reach.in_view(view)) return draw;
  const ScreenBox cage = cage_box(mesh, b, to_camera, view);
  const float most = static_cast<float>(settings.points);
  const bool whole = !settings.lod || cage.crosses_near_plane;
  const float selection =
      whole ? 1.f : kernel::lod_selection(cage.min, cage.max, static_cast<float>(view.height), groom.lod_lambda);
  const auto all = static_cast<float>(b.strands);
  const float fewest =
      settings.thicken ? kernel::lod_least_strands(all, mesh.width * groom.width_scale, prepared.across[bundle]) : 1.f;
  draw.strands =
      static_cast<std::uint32_t>(std::max(kernel::lod_strands(selection, all, whole ? 0.f : prepared.stagger[bundle]), fewest));
  const float spans = static_cast<float>(mesh.layers(b) - 1);
  const float least =
      std::max(spans + 1, std::min(most, std::max(kPointsPerSpan * spans + 1, kPointsPerTurn * prepared.turns[bundle])));
  draw.points = static_cast<std::uint32_t>(kernel::lod_points(selection, std::max(most, least), least));
  if (settings.thicken) draw.width_scale = all / static_cast<float>(draw.strands);
  return draw;
}

/// … for all views: what the one that asks for the most does.
BundleDraw choose(const GroomInstance& groom, const PreparedHairMesh& prepared, std::size_t bundle,
                  std::span<const Affine> to_camera, std::span<const CameraView> views, const SwrSettings& settings) {
  BundleDraw all;
  all.nearest = INFINITY, all.width_scale = INFINITY, all.views = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleDraw one = choose(groom, prepared, bundle, to_camera[v], views[v], settings);
    if (one.strands == 0) continue;
    all.strands = std::max(all.strands, one.strands), all.points = std::max(all.points, one.points);
    all.width_scale = std::min(all.width_scale, one.width_scale);  // more strands, less wide
    all.nearest = std::min(all.nearest, one.nearest);
    all.views |= 1u << v;
  }
  return all;
}

}  // namespace

LodSelection select_lod(const Scene& scene, std::span<const DeferredGroom> grooms, std::span<const CameraView> views) {
  PELAGE_CHECK(!views.empty() && views.size() <= kMostViews);
  LodSelection selection;
  for (std::size_t g = 0; g < grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[grooms[g].groom];
    const PreparedHairMesh& prepared = *grooms[g].mesh;
    std::vector<Affine> to_camera;
    for (const CameraView& view : views) to_camera.push_back(compose(view.world_to_camera, groom.transform));
    std::vector<BundleDraw> draws(prepared.cages.size());
    parallel_for(draws.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        draws[b] = choose(groom, prepared, b, to_camera, views, scene.settings.swr);
        draws[b].groom = static_cast<std::uint32_t>(g), draws[b].bundle = static_cast<std::uint32_t>(b);
      }
    });
    for (const BundleDraw& draw : draws) {
      if (draw.strands == 0) continue;
      selection.bundles.push_back(draw);
      selection.strands += draw.strands, selection.points += std::uint64_t{draw.strands} * draw.points;
    }
  }
  std::stable_sort(selection.bundles.begin(), selection.bundles.end(),
                   [](const BundleDraw& a, const BundleDraw& b) { return a.nearest < b.nearest; });
  return selection;
}

}  // namespace pelage
