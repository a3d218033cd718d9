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

  /// `scene` with its grooms as `view` shows them, and RenderSettings::opacity_map_size no finer than what is seen. Where active(); the
  /// scene must be the one that this was made for.
  Scene drawn(const Scene& scene, const CameraView& view);

  /// `scene` in another pose of its grooms, to choose levels for from now on.
  void move(const Scene& scene);
  /// `scene`, another pose of that of which drawn() was called last, as the same strands and pieces of thick hairs. None where something else than
  /// thick hairs stands for clusters.
  std::optional<Scene> drawn_alike(const Scene& scene, const CameraView& view) const;

  /// Whether the last call chose other levels than the one before, or another size for the maps of lights.
  bool changed() const { return changed_; }
  std::uint64_t segments() const { return segments_; }  ///< of the last call: spans of what is drawn

 private:
  struct Groom {
    std::size_t number;  // in the scene
    PrismHairs prisms;
    StrandCuts cuts;
    LodCut cut;
    std::optional<ThickenedStrands> thickened;  // where they stand for clusters
    std::optional<HairCards> cards;             // where they do
  };
  static std::vector<GroomInstance> draw(const GroomInstance& instance, const ThickHairSettings& settings,
                                         const LodPlace& place, Groom& groom);
  std::vector<Groom> grooms_;
  int map_size_ = 0;
  bool changed_ = false;
  std::uint64_t segments_ = 0;
};

}  // namespace pelage
