// From the 32-bit segment id of a G-buffer pixel back to the strand: which one, where on it, and what is there.
#pragma once

#include <pelage/scene.h>

#include <cstdint>

#include "frame/curve_basis.h"
#include "frame/frame.h"
#include "frame/material_map.h"

namespace pelage {

/// A segment by its place: sub-segment k of span `span` of strand `strand` of groom `groom`.
struct SegmentRef {
  std::uint32_t groom = 0, strand = 0, span = 0, k = 0;
};

/// A place on a strand, in world space.
struct StrandSurface {
  Vec3 position;    ///< metres
  Vec3 tangent;     ///< unit length, root to tip
  float u = 0;      ///< 0 at the root … 1 at the tip, by curve parameter
  float width = 0;  ///< diameter, metres; all of it, whatever GroomInstance::shares says
};

/// The segment with this id: where strands have equally many points at once, else by binary search over the offsets, O(log
/// strands). `id` must be one that raster wrote.
SegmentRef find_segment(const Scene& scene, const SegmentNumbering& numbering, std::uint32_t id);

/// The four control points that a span blends, in object space, phantom ends included.
void span_points(const StrandSet& set, std::uint32_t strand, std::uint32_t span, Vec3 (&points)[4]);

/// The curve of segment `s` at t ∈ [0, 1] (0 where it starts). The tangent of a curve that stands still is taken from
/// the control points around it; (0, 1, 0) where all of them coincide.
StrandSurface surface_at(const Scene& scene, const SegmentNumbering& numbering, const SegmentRef& s, float t);

/// t ∈ [0, 1] of the place on segment `s` (the chord that raster drew) that is seen nearest to the screen point
/// (x, y), pixels; perspective-correct.
float locate_on_segment(const Scene& scene, const SegmentNumbering& numbering, const CameraView& view, const SegmentRef& s,
                        float x, float y);

/// Roughness and tilt of a strand at u, 0 at the root … 1 at the tip, as factors of the material's; of grooms with maps of them.
Finish strand_finish(const GroomInstance& groom, std::uint32_t strand, float u);

/// Color of a strand where a span starts: its own where it has one, else the material's.
Vec3 strand_color(const GroomInstance& groom, std::uint32_t strand, std::uint32_t span);

}  // namespace pelage
