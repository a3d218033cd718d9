// The rare case of assemble: strands that cross the near plane or leave the guard band.
#pragma once

#include "assemble/assemble.h"

namespace pelage {

/// Cuts the polylines of `block` (camera space, `radius` in metres) at the near plane and at the four sides of the guard
/// band, in double precision. Segments outside vanish; a strand that comes back starts a new run of points. Ids stay.
void clip(const AssembleJob& job, ScreenBlock& block);

/// A point in camera space, metres.
struct ClipPoint {
  double x, y, z, radius;
};
/// Cuts the segment a → b to what lies inside; false where nothing does.
bool clip_segment(const CameraView& view, ClipPoint& a, ClipPoint& b);

}  // namespace pelage
