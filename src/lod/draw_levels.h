// A groom as its chosen levels of detail show it: strands, parts of strands, and pieces of thick hairs.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"
#include "lod/strand_cuts.h"

namespace pelage {

/// What stands for `groom` (which has `lod`) where its hairs have the levels of `cut`: the groom itself with GroomInstance::only what is drawn of
/// its strands, and parts of curves of `basis` with GroomInstance::sections, which `draw` makes of the hairs that show. What is empty is left out; a groom of
/// which all strands are drawn is returned as it is. The same for any number of threads. O(what is drawn).
std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodCut& cut, const StrandCuts& cuts, CurveBasis basis,
                                       const DrawHairs& draw);

/// The same of levels that blend: what has a share of its place has GroomInstance::shares, and widths that are narrowed by it, and strands that fade are
/// copies in a groom of their own. `draw` must draw with those shares.
std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const BlendedCut& cut, const StrandCuts& cuts,
                                       CurveBasis basis, const DrawHairs& draw);

}  // namespace pelage
