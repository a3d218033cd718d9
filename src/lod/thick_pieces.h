// Thick hairs as an eye sees them.
#pragma once

#include <functional>

#include "lod/choose_levels.h"
#include "lod/pieces.h"

namespace pelage {

/// Catmull-Rom curves through the knots of the B-splines of all hairs of which `shown` is some segments, so that pieces of one hair meet exactly, each point
/// as wide as covered_width() of the cross-section that `place` sees; of those that have a share by `blend`, unless it is null, of so many of their fibers.
/// `strands` are those of the groom. O(hairs + points drawn), in parallel.
Pieces thick_pieces(const StrandSet& strands, const LodPlace& place, const ShownSegments& shown,
                    const BlendedCut* blend = nullptr);

/// The same as draw_levels() asks for it. Refers to its arguments.
DrawHairs thick_hair_pen(const StrandSet& strands, const LodPlace& place, const BlendedCut* blend = nullptr);

}  // namespace pelage
