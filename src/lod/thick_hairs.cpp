#include "lod/thick_hairs.h"

#include <iterator>
#include <utility>

#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "lod/draw_levels.h"

namespace pelage {
namespace {

std::uint64_t spans_of(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  std::uint64_t spans = 0;
  for (std::size_t i = 0; i < drawn_strands(groom); ++i) {
    const std::size_t s = groom.only ? (*groom.only)[i] : i;
    spans += span_count(set.basis, set.offsets[s + 1] - set.offsets[s]);
  }
  return spans;
}

}  // namespace

ThickHairs::ThickHairs(const Scene& scene) {
  if (!scene.settings.thick_hairs.on) return;
  for (std::size_t g = 0; g < scene.grooms.size(); ++g)
    if (scene.grooms[g].lod && scene.grooms[g].strands) grooms_.push_back({g, LevelBounds(*scene.grooms[g].lod), {}});
}

Scene ThickHairs::drawn(const Scene& scene, const CameraView& view) {
  PELAGE_CHECK(active());
  Scene drawn = scene;
  drawn.grooms.clear(), changed_ = false, segments_ = 0;
  auto next = grooms_.begin();
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const GroomInstance& groom = scene.grooms[g];
    if (next == grooms_.end() || next->number != g) {
      drawn.grooms.push_back(groom);
      continue;
    }
    const LodPlace place{*groom.lod, view, compose(view.world_to_camera, groom.transform)};
    const ThickHairSettings& settings = scene.settings.thick_hairs;
    LodLevels levels = settings.level >= 0 ? one_level(*groom.lod, static_cast<std::size_t>(settings.level))
                                           : choose_levels(place, next->bounds, settings.pixels, next->levels);
    changed_ = changed_ || levels != next->levels;
    next->levels = std::move(levels);
    std::vector<GroomInstance> pieces = draw_levels(groom, place, next->bounds, next->levels);
    std::move(pieces.begin(), pieces.end(), std::back_inserter(drawn.grooms));
    ++next;
  }
  for (const GroomInstance& groom : drawn.grooms)
    if (groom.strands) segments_ += spans_of(groom);
  return drawn;
}

}  // namespace pelage
