// The rare case of assemble: strands that cross the near plane or leave the guard band.
#pragma once

#include "assemble/assemble.h"

namespace pelage {

/// Whether some point of `block` (camera space, before projection) lies before the near plane or beyond the guard band.
bool needs_clipping(const AssembleJob& job, const ScreenBlock& block);

/// Cuts the polylines of `block` (camera space, `radius` in metres) at the near plane and at the four sides of the guard
/// band, in double precision. Segments outside vanish; a strand that comes back starts a new run of points. Ids stay.
void clip(const AssembleJob& job, ScreenBlock& block);

}  // namespace pelage
