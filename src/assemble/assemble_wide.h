// The loops of assemble over whole lanes, compiled once per instruction set; all of them give the same bits.
#pragma once

#include "assemble/assemble.h"

namespace pelage {

/// Writes the refined points of parts first … end − 1 of the job in camera space to `block`, which has room for them: x, y, depth,
/// half the width in metres as `radius`, and `id`.
void camera_points(const AssembleJob& job, std::size_t first, std::size_t end, ScreenBlock& block);

/// Whether some point of `block` (camera space) lies before the near plane or may lie beyond the guard band.
bool needs_clipping(const AssembleJob& job, const ScreenBlock& block);

/// Camera space → pixels, in place, and then the caps.
void project_points(const AssembleJob& job, ScreenBlock& block);

}  // namespace pelage
