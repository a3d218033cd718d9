// Guide curves: the shape of a haircut before single strands are told apart.
#pragma once

#include <pelage/grow.h>

#include <cstdint>
#include <vector>

#include "groom/distance_grid.h"
#include "groom/roots.h"

namespace pelage::groom {

/// The surface that hair grows on, and what it must stay outside of.
struct Ground {
  const TriangleMesh* mesh = nullptr;
  const DistanceGrid* collider = nullptr;  ///< null: nothing to collide with
  bool scalp = false;                      ///< the mesh is the mannequin: hair stands on its scalp only
  float size = 1;                          ///< metres, diagonal of the mesh's box, > 0
  DensityField density() const;
};

/// Direction, not normalised, in which the style combs hair at `root`.
Vec3 combing(const GrowSettings& settings, const Ground& ground, const Root& root);

/// Guides of equal arc length, each with a rotation-minimising frame. The first n are spread evenly for any n.
struct GuideSet {
  int points = 0;              ///< per guide
  float step = 0;              ///< metres between neighbouring points of a guide
  std::vector<Root> roots;     ///< [guide_count]
  std::vector<Vec3> position;  ///< [guide_count·points]
  std::vector<Vec3> side, up;  ///< [guide_count·points] unit, across the curve; side × up is the tangent
  std::vector<float> tie;      ///< [guide_count] arc length at which the guide passes the ponytail's tie; 0 for none
  std::size_t count() const { return roots.size(); }
};

/// Grows `count` guides of `guide_length` metres that fall, collide and gather as the style asks.
GuideSet grow_guides(const GrowSettings& settings, const Ground& ground, std::size_t count, float guide_length);

}  // namespace pelage::groom
