// Frames along a curve that turn no more than the curve does.
#pragma once

#include <pelage/vec.h>

namespace pelage::groom {

/// Rotation-minimising frames of the polyline `p` by the double reflection method (Wang et al. 2008; references.bib:
/// Wang2008Frames): side[i] and up[i] are unit and span the plane across the curve, side × up is the tangent.
///
/// `normal` is where `side` starts, as far as it lies across the curve. count ≥ 2; repeated points repeat their frame.
void rotation_minimizing_frames(const Vec3* p, int count, Vec3 normal, Vec3* side, Vec3* up);

}  // namespace pelage::groom
