// Assemble: strands of a groom → projected, clipped polylines in a ScreenBlock, a few thousand points at a time.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "frame/frame.h"
#include "frame/strand_part.h"

namespace pelage {

/// Projected points stay within this many pixels of the image: segments beyond are cut there (outside the image, so no
/// pixel changes) to keep 1/500 of a pixel of float precision, and rasterizers from walking where nothing is seen.
inline constexpr float kGuardBand = 4096;

/// Numbers the segments of all grooms of `scene`, seen by `view`. `settings.subdivisions` > 0 is used as it is; 0
/// chooses per groom the least number that keeps chords within a tenth of a pixel of the curve, or 0.8/n pixels for pictures
/// of n > 8 samples a pixel (at most kMaxSubdivisions, by a fixed sample of the strands). Linear grooms are never subdivided by choice.
/// Throws Error where the ids do not fit into 32 bits.
SegmentNumbering number_segments(const Scene& scene, const CameraView& view);
inline constexpr std::uint32_t kMaxSubdivisions = 16;

/// One groom made ready to be assembled for one view. Refers to the groom and to `order`: keep them alive.
struct AssembleJob {
  const StrandSet* strands = nullptr;
  std::span<const StrandPart> parts;     ///< what of the strands is drawn; empty: all of them, whole
  std::span<const std::uint32_t> order;  ///< [strand_count] of whole strands, in which order to draw them; empty: as they stand
  CameraView view;
  Affine to_camera;                ///< object → camera
  float width_scale = 1;           ///< camera-space diameter per stored width
  std::uint32_t subdivisions = 1;  ///< segments per span
  std::uint32_t base_id = 0;       ///< id of the groom's first segment
};
/// What is drawn at number `i`.
inline StrandPart part_at(const AssembleJob& job, std::size_t i) {
  if (!job.parts.empty()) return job.parts[i];
  return whole_strand(*job.strands, job.order.empty() ? i : job.order[i]);
}
AssembleJob make_assemble_job(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, std::size_t groom);

/// Points that `block` aims at: with the fragments of raster they stay in the second-level cache.
inline constexpr std::size_t kBlockPoints = 2048;

/// Fills `block` (overwriting it) with whole parts, from number `first` of those of `job` on, at least one and as many
/// as fit into kBlockPoints, and returns the number after the last. Segments behind the near plane or beyond the guard band are
/// left out or cut exactly. Reuse the block: it grows to the longest strand and then allocates no more.
///
/// first < last ≤ drawn_parts(). Thread-safe on different blocks. O(points).
std::size_t assemble_strands(const AssembleJob& job, std::size_t first, std::size_t last, ScreenBlock& block);

}  // namespace pelage
