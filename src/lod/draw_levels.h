// A groom as its chosen levels of detail show it: some strands as they are, pieces of strands, and pieces of thick hairs.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"

namespace pelage {

/// How wide a thick hair is drawn: of `fibers` fibers with diameter `fiber` that lie at random in a band of width `band`, the mean part of
/// the band that is covered, band·(1 − (1 − fiber/band)^fibers). One fiber is as wide as itself, dense hair as its band. Metres.
float covered_width(float band, float fiber, float fibers);

/// Fibers that are `length_ratio` times as long as the center they wind about: how many times as much hair a line of sight across meets.
/// They lean by δ, cos δ = 1/ratio, toward all sides alike; what leans along the line of sight is seen as short as the center. Mean of
/// the projected lengths: the perimeter of an ellipse with semi-axes `length_ratio` and 1 over 2π. 1 where the ratio is below 1.
float crossing_ratio(float length_ratio);

/// Such fibers' variance of direction about the center's, along each axis across it: sin²δ/2. Radians², 0…½.
float direction_variance(float length_ratio);

/// What stands for `groom` (which has `lod`) where its segments have `levels`: the groom itself with GroomInstance::only the strands that are
/// drawn whole; its strands in pieces; its thick hairs in pieces, each point as wide as covered_width() of the cross-section that `view`
/// sees, with GroomInstance::sections. What is empty is left out; a groom of which all strands are drawn is returned as it is.
///
/// Thick hairs are Catmull-Rom curves through the knots of their B-splines, so pieces of one hair meet exactly. Pieces of strands reach from the
/// control point before their place to the one after, by the lengths of `measured`, the strands in another pose, where it is given: so two
/// poses are cut alike. The same for any number of threads. O(what is drawn).
std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodPlace& place, const LevelBounds& bounds,
                                       const LodLevels& levels, const StrandSet* measured = nullptr);

/// The same with something else than thick hairs where levels are not strands: what `clusters` draws, curves of `basis`.
std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodHierarchy& lod, const LodLevels& levels,
                                       CurveBasis basis, const DrawClusters& clusters, const StrandSet* measured = nullptr);

/// Directions from places of a groom to the eye, in the groom's space; of any length.
class ToEye {
 public:
  explicit ToEye(const LodPlace& place);  ///< refers to it
  Vec3 operator()(Vec3 p) const;

 private:
  const LodPlace& place_;
  Vec3 x_, y_, z_;  // axes of the camera in the groom's space
};

}  // namespace pelage
