// A groom as its chosen levels of detail show it: strands, parts of strands, and pieces of thick hairs.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"
#include "lod/strand_cuts.h"

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

/// What stands for `groom` (which has `lod`) where its hairs have the levels of `cut`: the groom itself with GroomInstance::only what is drawn of
/// its strands, and parts of curves of `basis` with GroomInstance::sections, which `draw` makes of each hair that shows. What is empty is left out; a groom of
/// which all strands are drawn is returned as it is. The same for any number of threads. O(what is drawn).
std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodCut& cut, const StrandCuts& cuts, CurveBasis basis,
                                       const DrawCluster& draw);

/// Draws thick hairs: Catmull-Rom curves through the knots of their B-splines, so that pieces of one hair meet exactly, each point as wide as
/// covered_width() of the cross-section that `place` sees. Refers to its arguments.
DrawCluster thick_hair_pen(const StrandSet& strands, const LodPlace& place);

}  // namespace pelage
