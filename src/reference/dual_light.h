// Dual scattering with rays: what raster's shade approximates by opacity maps, with every strand on the way to the light
// counted. Zinke 2008 (references.bib: Zinke2008Dual); docs/derivations/dual_scattering.md.
#pragma once

#include <pelage/scene.h>

#include <vector>

#include "frame/dual_scattering_tables.h"
#include "frame/material_map.h"
#include "kernel/scalar.h"
#include "reference/light_sampler.h"
#include "reference/ray_scene.h"
#include "reference/vertex.h"

namespace pelage {

/// A strand seen by the eye, made ready for light from anywhere.
struct DualPlace {
  HairMaterial::Model model;
  Vec3 tangent, across;          ///< unit length; across: toward the eye in the normal plane
  kernel::ScatterLobes lobes;    ///< of every model but Sadeghi's
  kernel::ScatterArtist artist;  ///< of Sadeghi's
  kernel::ScatterPelekis pelekis;
  kernel::ScatterAverages averages;
  kernel::ScatterBack back;
  Vec3 tuft_color;  ///< of Kajiya-Kay
};

/// Strands that light from one direction crosses.
struct CrossedStrands {
  int count = 0;
  Vec3 attenuation{1, 1, 1};  ///< product of their mean forward attenuations
};

/// The materials of a scene, tabulated. Pure and thread-safe.
class DualLight {
 public:
  explicit DualLight(const std::vector<GroomInstance>& grooms);

  /// finish: by the maps of the groom; (1, 1) without.
  DualPlace place(std::size_t groom, Vec3 strand_color, Finish finish, Vec3 tangent, Vec3 to_eye) const;
  /// One more strand of groom `groom` on the way of light toward `to_light`.
  void cross(CrossedStrands& crossed, std::size_t groom, Vec3 strand_color, Finish finish, Vec3 tangent, Vec3 to_light) const;
  /// f·cos θ_i of the strand and of the hair around it.
  static Vec3 evaluate(const DualPlace& place, Vec3 to_light, const CrossedStrands& crossed);

 private:
  struct Entry {
    HairMaterial material;
    bool mapped;
    RoughnessLevels levels;
    std::vector<ForwardAttenuationTable> attenuation;  ///< of each level; none for Kajiya-Kay

    HairMaterial at(Finish finish) const { return mapped ? finished(material, finish) : material; }
  };
  std::vector<Entry> grooms_;
};

}  // namespace pelage
