#include "lod/thick_hairs.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/bounds.h"
#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "lod/draw_levels.h"

namespace pelage {
namespace {

constexpr int kSmallestMap = 64;
constexpr float kTexelsPerPixel = 2;

std::uint64_t spans_of(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  std::uint64_t spans = 0;
  for (std::size_t i = 0; i < drawn_strands(groom); ++i) {
    const std::size_t s = groom.only ? (*groom.only)[i] : i;
    spans += span_count(set.basis, set.offsets[s + 1] - set.offsets[s]);
  }
  return spans;
}

/// How wide a box may look on the screen, pixels; INFINITY before the near plane.
float pixels_wide(const Bounds& box, const CameraView& view, const Affine& to_camera) {
  float nearest = INFINITY;
  for (const Vec3 corner : corners(box)) nearest = std::min(nearest, transform_point(to_camera, corner).z);
  if (!(nearest >= view.near_plane)) return INFINITY;
  return length(box.extent()) * similarity_scale(to_camera) * pixels_per_metre(view, nearest);
}

/// Texels a side of maps of lights for hair that is `pixels` wide: a power of two, so that it seldom changes, at least two a pixel
/// and no less than the settings' smallest; `most` where hair is large.
int map_size(float pixels, int most) {
  int size = kSmallestMap;
  while (size < most && static_cast<float>(size) < kTexelsPerPixel * pixels) size *= 2;
  return std::min(size, most);
}

/// `scene` with what `draw(groom, place)` makes of grooms that have levels, in the order of the scene; others stay as they are.
template <class Grooms, class Draw>
Scene draw_grooms(const Scene& scene, Grooms& with_levels, const CameraView& view, const Draw& draw) {
  Scene drawn = scene;
  drawn.grooms.clear();
  auto next = with_levels.begin();
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (next == with_levels.end() || next->number != g) {
      drawn.grooms.push_back(groom);
      continue;
    }
    std::vector<GroomInstance> pieces =
        draw(*next++, LodPlace{*groom.lod, view, compose(view.world_to_camera, groom.transform)});
    std::move(pieces.begin(), pieces.end(), std::back_inserter(drawn.grooms));
  }
  return drawn;
}

}  // namespace

ThickHairs::ThickHairs(const Scene& scene) {
  if (!scene.settings.thick_hairs.on) return;
  const LodShape shape = scene.settings.thick_hairs.shape;
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (!groom.lod || !groom.strands) continue;
    grooms_.push_back({g, LevelBounds(*groom.lod), {}, {}, {}});
    if (shape == LodShape::kStrands) grooms_.back().thickened.emplace(*groom.lod);
    if (shape == LodShape::kCards) grooms_.back().cards.emplace(*groom.strands, *groom.lod);
  }
}

std::vector<GroomInstance> ThickHairs::draw(const GroomInstance& instance, const ThickHairSettings& settings,
                                            const LodPlace& place, Groom& groom) {
  const StrandSet& set = *instance.strands;
  if (groom.cards) groom.levels = HairCards::choose(place, groom.bounds, settings.pixels, settings.level, groom.levels);
  else if (settings.level >= 0) groom.levels = one_level(place.lod, static_cast<std::size_t>(settings.level));
  else groom.levels = choose_levels(place, groom.bounds, settings.pixels, groom.levels);
  if (groom.cards)
    return draw_levels(instance, place.lod, groom.levels, CurveBasis::kLinear, groom.cards->pen(set, place, groom.bounds));
  if (groom.thickened)
    return draw_levels(instance, place.lod, groom.levels, set.basis, groom.thickened->pen(set, place.lod, groom.bounds));
  return draw_levels(instance, place, groom.bounds, groom.levels);
}

void ThickHairs::move(const Scene& scene) {
  for (Groom& groom : grooms_) {
    const GroomInstance& instance = scene.grooms[groom.number];
    groom.bounds = LevelBounds(*instance.lod);
    if (groom.thickened) groom.thickened.emplace(*instance.lod);
    if (groom.cards) groom.cards.emplace(*instance.strands, *instance.lod);
  }
}

std::optional<Scene> ThickHairs::drawn_alike(const Scene& now, const Scene& scene, const CameraView& view) const {
  if (std::any_of(grooms_.begin(), grooms_.end(), [](const Groom& g) { return g.cards || g.thickened; })) return std::nullopt;
  return draw_grooms(scene, grooms_, view, [&](const Groom& groom, const LodPlace& place) {
    const GroomInstance& instance = scene.grooms[groom.number];
    return draw_levels(instance, place, groom.bounds, groom.levels, now.grooms[groom.number].strands.get());
  });
}

Scene ThickHairs::drawn(const Scene& scene, const CameraView& view) {
  PELAGE_CHECK(active());
  changed_ = false, segments_ = 0;
  float pixels = grooms_.size() == scene.grooms.size() ? 0 : INFINITY;  // grooms without levels of detail take maps as they are
  Scene drawn = draw_grooms(scene, grooms_, view, [&](Groom& groom, const LodPlace& place) {
    pixels = std::max(pixels, pixels_wide(groom.bounds.box(), view, place.to_camera));
    const LodLevels before = groom.levels;
    std::vector<GroomInstance> pieces = draw(scene.grooms[groom.number], scene.settings.thick_hairs, place, groom);
    changed_ = changed_ || before != groom.levels;
    return pieces;
  });
  drawn.settings.opacity_map_size = map_size(pixels, scene.settings.opacity_map_size);
  changed_ = changed_ || map_size_ != drawn.settings.opacity_map_size;
  map_size_ = drawn.settings.opacity_map_size;
  for (const GroomInstance& groom : drawn.grooms)
    if (groom.strands) segments_ += spans_of(groom);
  return drawn;
}

}  // namespace pelage
