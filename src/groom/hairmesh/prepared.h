// A hair mesh ready to be drawn, frame after frame.
#pragma once

#include <pelage/hair_mesh.h>

#include <memory>
#include <vector>

#include "groom/hairmesh/cage.h"

namespace pelage {

struct PreparedHairMesh {
  std::shared_ptr<const HairMesh> mesh;
  std::vector<BundleCage> cages;  ///< per bundle
  std::vector<Bounds> boxes;      ///< per bundle: bounds() of its strands
  std::vector<float> stagger;     ///< per bundle: δ of Lipp 2026, eq. 1, 0…1
  std::vector<float> across;      ///< per bundle: metres from side to side, in the mean over its layers; of a braid, of a lock
  std::vector<float> turns;       ///< per bundle: of its style's fastest wave, along a strand of the cage's length

  /// `hair_mesh` must be valid.
  explicit PreparedHairMesh(std::shared_ptr<const HairMesh> hair_mesh);
};

}  // namespace pelage
