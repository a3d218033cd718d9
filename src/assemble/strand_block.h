// Assemble, for hair meshes: a group of strands, made on the fly, → projected polylines with what their pixels will hold.
#pragma once

#include <cstdint>

#include "frame/deferred.h"
#include "frame/frame.h"
#include "groom/hairmesh/strand_group.h"

namespace pelage {

/// Strands of a group on their way to raster. Point i of strand l stands at i·stride + l of `points`, and `id` is the point's own
/// number, where payload_high and payload_low are found. Reuse it: it allocates once.
struct StrandBlock {
  ScreenBlock points;
  ScreenBlock pairs;  ///< of a view that has to clip: a segment each
};

/// What the pixels of one groom's strands hold, whatever the view.
struct PayloadJob {
  Affine to_world;  ///< object → world: for tangents
  UvCells cells;
};

/// How one groom's strands come before one view.
struct ProjectJob {
  CameraView view;
  Affine to_camera;       ///< object → camera
  float width_scale = 1;  ///< camera-space diameter per width of the mesh
};
ProjectJob make_project_job(const CameraView& view, const GroomInstance& groom);

/// Begins a block: numbers the points of `group` and packs their payload, once for all views. Thread-safe on different blocks.
/// O(points).
void pack_group(const StrandGroup& group, const PayloadJob& job, StrandBlock& block);

/// Projects the strands of `group`, which pack_group() has packed into `block`. Segments behind the near plane or beyond the guard
/// band are left out or cut exactly. Returns the part of `block` that holds the strands, until it is projected for another view.
/// `widen`: factor on every width. Thread-safe on different blocks. O(points).
const ScreenBlock& project_group(const StrandGroup& group, const ProjectJob& job, float widen, StrandBlock& block);

}  // namespace pelage
