#include "lod/thick_hairs.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/bounds.h"
#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/strand_part.h"
#include "lod/draw_levels.h"

namespace pelage {
namespace {

constexpr int kSmallestMap = 64;
constexpr float kTexelsPerPixel = 2;

std::uint64_t spans_of(const GroomInstance& groom) {
  std::uint64_t spans = 0;
  for (std::size_t i = 0; i < drawn_parts(groom); ++i) spans += drawn_part(groom, i).spans;
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
    grooms_.push_back({g, PrismHairs(*groom.lod), StrandCuts(*groom.strands), {}, {}, {}});
    if (shape == LodShape::kStrands) grooms_.back().thickened.emplace(*groom.lod);
    if (shape == LodShape::kCards) grooms_.back().cards.emplace(*groom.strands, *groom.lod);
  }
}

std::vector<GroomInstance> ThickHairs::draw(const GroomInstance& instance, const ThickHairSettings& settings,
                                            const LodPlace& place, Groom& groom) {
  const StrandSet& set = *instance.strands;
  const std::size_t finest = place.lod.levels() - 1;
  if (groom.cards) groom.cut = HairCards::choose(place, groom.prisms, settings.pixels, settings.level, groom.cut);
  else if (settings.level >= 0) groom.cut = one_level(place.lod, std::min(static_cast<std::size_t>(settings.level), finest));
  else groom.cut = choose_levels(place, groom.prisms, settings.pixels, groom.cut);
  if (groom.cards) return draw_levels(instance, groom.cut, groom.cuts, CurveBasis::kLinear, groom.cards->pen(set, place));
  if (groom.thickened)
    return draw_levels(instance, groom.cut, groom.cuts, set.basis, groom.thickened->pen(set, place.lod, groom.cuts));
  return draw_levels(instance, groom.cut, groom.cuts, CurveBasis::kCatmullRom, thick_hair_pen(set, place));
}

void ThickHairs::move(const Scene& scene) {
  for (Groom& groom : grooms_) {
    const GroomInstance& instance = scene.grooms[groom.number];
    groom.prisms = PrismHairs(*instance.lod);
    if (groom.thickened) groom.thickened.emplace(*instance.lod);
    if (groom.cards) groom.cards.emplace(*instance.strands, *instance.lod);
  }
}

std::optional<Scene> ThickHairs::drawn_alike(const Scene& scene, const CameraView& view) const {
  if (std::any_of(grooms_.begin(), grooms_.end(), [](const Groom& g) { return g.cards || g.thickened; })) return std::nullopt;
  return draw_grooms(scene, grooms_, view, [&](const Groom& groom, const LodPlace& place) {
    const GroomInstance& instance = scene.grooms[groom.number];
    return draw_levels(instance, groom.cut, groom.cuts, CurveBasis::kCatmullRom, thick_hair_pen(*instance.strands, place));
  });
}

Scene ThickHairs::drawn(const Scene& scene, const CameraView& view) {
  PELAGE_CHECK(active());
  changed_ = false, segments_ = 0;
  float pixels = grooms_.size() == scene.grooms.size() ? 0 : INFINITY;  // grooms without levels of detail take maps as they are
  Scene drawn = draw_grooms(scene, grooms_, view, [&](Groom& groom, const LodPlace& place) {
    pixels = std::max(pixels, pixels_wide(groom.prisms.box(), view, place.to_camera));
    const LodCut before = groom.cut;
    std::vector<GroomInstance> pieces = draw(scene.grooms[groom.number], scene.settings.thick_hairs, place, groom);
    changed_ = changed_ || before != groom.cut;
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
