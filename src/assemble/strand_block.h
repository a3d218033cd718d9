// Assemble, for hair meshes: a group of strands, made on the fly, → projected polylines with what their pixels will hold.
#pragma once

#include <cstdint>

#include "frame/deferred.h"
#include "frame/frame.h"
#include "groom/hairmesh/strand_group.h"

namespace pelage {

/// How one groom's strands come before one view.
struct StrandBlockJob {
  CameraView view;
  Affine to_camera;       ///< object → camera
  Affine to_world;        ///< object → world: for tangents
  float width_scale = 1;  ///< camera-space diameter per width of the mesh
  UvCells cells;
};
StrandBlockJob make_strand_block_job(const Scene& scene, const CameraView& view, const DeferredGroom& groom, std::size_t i,
                                     std::size_t grooms);

/// Fills `block` (overwriting it) with the strands of `group`. Point i of strand l stands at i·block.stride + l, and `id` is the
/// point's own number, where payload_high and payload_low are found. Segments behind the near plane or beyond the guard band are
/// left out or cut exactly; points then stand in pairs, a segment each. `widen`: factor on every width.
///
/// Reuse the block. Thread-safe on different blocks. O(points).
void assemble_group(const StrandGroup& group, const StrandBlockJob& job, float widen, ScreenBlock& block);

}  // namespace pelage
