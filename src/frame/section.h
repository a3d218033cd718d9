// Elliptical cross-sections of thick hairs, as a direction sees them.
#pragma once

#include <pelage/scene.h>
#include <pelage/vec.h>

#include "frame/frame.h"
#include "frame/segment_lookup.h"

namespace pelage {

/// How a cross-section is seen: l_w and l_t of Huang 2025, section 5.2 (references.bib: Huang2025LevelOfDetail).
struct SectionExtent {
  float width = 0;      ///< across the hair, facing the eye
  float thickness = 0;  ///< along the line of sight, perpendicular to the hair
};

/// An ellipse with semi-axes `major` and `minor` (metres, any space) of a hair along `along`, seen in direction `to_eye`, both of any
/// length. A hair that is seen from its end shows its longer axis.
SectionExtent section_extent(Vec3 major, Vec3 minor, Vec3 along, Vec3 to_eye);

/// A thick hair at one place, as an eye sees it. Metres, world space.
struct SeenBundle {
  float fibers = 1;  ///< n_total
  float radius = 0;  ///< of one fiber
  float spread = 0;  ///< radians², ThickSections::spreads
  SectionExtent extent;
};

/// The bundle of segment `s` at t ∈ [0, 1], of a groom with GroomInstance::sections. `surface` is the place there; `to_eye` of any length.
SeenBundle bundle_at(const Scene& scene, const SegmentNumbering& numbering, const SegmentRef& s, float t,
                     const StrandSurface& surface, Vec3 to_eye);

}  // namespace pelage
