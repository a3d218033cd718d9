#include "lod/thick_hairs.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/bounds.h"
#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/strand_part.h"
#include "lod/draw_levels.h"
#include "lod/thick_pieces.h"

namespace pelage {
namespace {

constexpr int kSmallestMap = 64;
constexpr float kTexelsPerPixel = 1.75f;  // of the box's diagonal; lights see it shorter

/// How wide a box may look on the screen, pixels; INFINITY before the near plane.
float pixels_wide(const Bounds& box, const CameraView& view, const Affine& to_camera) {
  float nearest = INFINITY;
  for (const Vec3 corner : corners(box)) nearest = std::min(nearest, transform_point(to_camera, corner).z);
  if (!(nearest >= view.near_plane)) return INFINITY;
  return length(box.extent()) * similarity_scale(to_camera) * pixels_per_metre(view, nearest);
}

/// Texels a side of maps of lights for hair that is `pixels` wide: in steps of √2, so that it seldom changes, no less than the smallest,
/// `most` where hair is large.
int map_size(float pixels, int most) {
  float size = kSmallestMap;
  while (size < static_cast<float>(most) && size < kTexelsPerPixel * pixels) size *= 1.41421356f;
  return std::min(static_cast<int>(std::lround(size)), most);
}

LodPlace place_of(const GroomInstance& groom, const CameraView& view) {
  return {*groom.lod, view, compose(view.world_to_camera, groom.transform)};
}

}  // namespace

ThickHairs::ThickHairs(const Scene& scene) {
  if (!scene.settings.thick_hairs.on) return;
  const LodShape shape = scene.settings.thick_hairs.shape;
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (!groom.lod || !groom.strands) continue;
    grooms_.push_back({g, PrismHairs(*groom.lod), StrandCuts(*groom.strands), {}, {}, {}, {}});
    if (shape == LodShape::kStrands) grooms_.back().thickened.emplace(*groom.lod);
    if (shape == LodShape::kCards) grooms_.back().cards.emplace(*groom.strands, *groom.lod);
  }
}

LodCut ThickHairs::chosen(const Groom& groom, const ThickHairSettings& settings, const LodPlace& place) {
  if (groom.cards) return HairCards::choose(place, groom.prisms, settings.pixels, settings.level, groom.cut);
  if (settings.level < 0 && settings.error > 0) return choose_levels_by_error(place, groom.prisms, settings.error, groom.cut);
  if (settings.level < 0) return choose_levels(place, groom.prisms, settings.pixels, groom.cut);
  return one_level(place.lod, std::min(static_cast<std::size_t>(settings.level), place.lod.levels() - 1));
}

BlendedCut ThickHairs::blended(const Groom& groom, const ThickHairSettings& settings, const LodPlace& place) {
  if (settings.error > 0) return choose_blended_by_error(place, groom.prisms, settings.error, settings.blend);
  return choose_blended(place, groom.prisms, settings.pixels, settings.blend);
}

std::vector<GroomInstance> ThickHairs::draw(const GroomInstance& instance, const LodPlace& place, const Groom& groom) {
  const StrandSet& set = *instance.strands;
  if (!groom.blended.empty())
    return draw_levels(instance, groom.blended, groom.cuts, CurveBasis::kCatmullRom,
                       thick_hair_pen(set, place, &groom.blended));
  if (groom.cards)
    return draw_levels(instance, groom.cut, groom.cuts, CurveBasis::kLinear,
                       cluster_by_cluster(place.lod, groom.cards->pen(set, place)));
  if (groom.thickened)
    return draw_levels(instance, groom.cut, groom.cuts, set.basis,
                       cluster_by_cluster(place.lod, groom.thickened->pen(set, place.lod, groom.cuts)));
  return draw_levels(instance, groom.cut, groom.cuts, CurveBasis::kCatmullRom, thick_hair_pen(set, place));
}

void ThickHairs::move(const Scene& scene) {
  for (Groom& groom : grooms_) {
    const GroomInstance& instance = scene.grooms[groom.number];
    groom.prisms = PrismHairs(*instance.lod), groom.cuts = StrandCuts(*instance.strands);
    if (groom.thickened) groom.thickened.emplace(*instance.lod);
    if (groom.cards) groom.cards.emplace(*instance.strands, *instance.lod);
  }
}

void ThickHairs::choose(const Scene& scene, const CameraView& view) {
  PELAGE_CHECK(active());
  float pixels = grooms_.size() == scene.grooms.size() ? 0 : INFINITY;  // grooms without levels of detail take maps as they are
  changed_ = false;
  for (Groom& groom : grooms_) {
    const LodPlace place = place_of(scene.grooms[groom.number], view);
    pixels = std::max(pixels, pixels_wide(groom.prisms.box(), view, place.to_camera));
    BlendedCut blend;
    LodCut cut;
    if (scene.settings.thick_hairs.blend > 0) blend = blended(groom, scene.settings.thick_hairs, place);
    else cut = chosen(groom, scene.settings.thick_hairs, place);
    changed_ = changed_ || cut != groom.cut || blend != groom.blended;
    groom.cut = std::move(cut), groom.blended = std::move(blend);
  }
  const int size = map_size(pixels, scene.settings.opacity_map_size);
  changed_ = changed_ || size != map_size_;
  map_size_ = size;
}

Scene ThickHairs::drawn(const Scene& scene, const CameraView& view) const {
  Scene drawn = scene;
  drawn.grooms.clear();
  auto next = grooms_.begin();
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (next == grooms_.end() || next->number != g) {
      drawn.grooms.push_back(groom);
      continue;
    }
    std::vector<GroomInstance> pieces = draw(groom, place_of(groom, view), *next++);
    std::move(pieces.begin(), pieces.end(), std::back_inserter(drawn.grooms));
  }
  drawn.settings.opacity_map_size = map_size_;
  return drawn;
}

bool ThickHairs::can_draw_alike() const {
  return std::none_of(grooms_.begin(), grooms_.end(), [](const Groom& g) { return g.cards || g.thickened; });
}

std::uint64_t drawn_segments(const Scene& drawn) {
  std::uint64_t segments = 0;
  for (const GroomInstance& groom : drawn.grooms)
    for (std::size_t i = 0; groom.strands && i < drawn_parts(groom); ++i) segments += drawn_part(groom, i).spans;
  return segments;
}

}  // namespace pelage
