// The grooms of a scene with their levels of detail, from frame to frame.
#pragma once

#include <pelage/scene.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "frame/frame.h"
#include "lod/choose_levels.h"
#include "lod/hair_cards.h"
#include "lod/thickened_strands.h"

namespace pelage {

/// Draws grooms that have thick hairs as their size on the screen asks for, and remembers the levels, for hysteresis. Refers to the
/// scene's grooms: keep them alive.
class ThickHairs {
 public:
  /// Does nothing where settings.thick_hairs is off or no groom has `lod`.
  explicit ThickHairs(const Scene& scene);

  bool active() const { return !grooms_.empty(); }

  /// Chooses levels for the grooms of `scene` as `view` shows them, and how fine maps of lights need to be. Where active(); the scene must be the
  /// one that this was made for, or that of the last move().
  void choose(const Scene& scene, const CameraView& view);
  /// Whether that chose other levels than the time before, or another size for the maps.
  bool changed() const { return changed_; }

  /// `scene` with its grooms at the levels that were chosen, and RenderSettings::opacity_map_size no finer than what is seen. Of another pose of the
  /// scene, where can_draw_alike(): the same strands and pieces of thick hairs.
  Scene drawn(const Scene& scene, const CameraView& view) const;
  /// Unless something else than thick hairs stands for clusters.
  bool can_draw_alike() const;

  /// `scene` in another pose of its grooms, to choose levels for from now on.
  void move(const Scene& scene);

 private:
  struct Groom {
    std::size_t number;  // in the scene
    PrismHairs prisms;
    StrandCuts cuts;
    LodCut cut;
    BlendedCut blended;                         // where levels blend, instead of `cut`
    std::optional<ThickenedStrands> thickened;  // where they stand for clusters
    std::optional<HairCards> cards;             // where they do
  };
  static BlendedCut blended(const Groom& groom, const ThickHairSettings& settings, const LodPlace& place);
  static LodCut chosen(const Groom& groom, const ThickHairSettings& settings, const LodPlace& place);
  static std::vector<GroomInstance> draw(const GroomInstance& instance, const LodPlace& place, const Groom& groom);
  std::vector<Groom> grooms_;
  int map_size_ = 0;
  bool changed_ = false;
};

/// Spans of everything that is drawn.
std::uint64_t drawn_segments(const Scene& drawn);

}  // namespace pelage
