// The ellipses along a cluster of strands.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/stations.h"

namespace pelage {

/// One control point's: center + x·major + y·minor, x² + y² ≤ 1.
struct CrossSection {
  Vec3 center, major, minor;
  float radius = 0;  ///< mean of the fibers
};

/// Ellipses across the cluster `strands` of `stations` at every control point (Huang 2025, section 5.1, step 3): center at the mean;
/// axes by principal components of the places seen along the center line (the paper leaves out the component nearest to the mean
/// tangent); lengths in proportion to the standard deviations, such that a share `covered` of the places lies within, and a
/// fiber's radius more. With `strays` a fiber takes the disc of Stations::strays too, so that all of its curve is covered, curls
/// included; without, one strand makes a circle of its own radius.
///
/// Axes follow the hair: from control point to control point they turn with the center line (as little as they can), then to the
/// nearer principal axis; where the section is round, and has none to speak of, not at all.
std::array<CrossSection, LodHierarchy::kPoints> fit_cross_sections(const Stations& stations,
                                                                   std::span<const std::uint32_t> strands, float covered,
                                                                   bool strays);

/// Radians a metre by which the strands turn about the centers of `sections`, which are theirs, from root to tip, right-handed: the turn from control
/// point to control point that fits all places best, those count more that are far from the center, times the share of how places move (squared) that
/// it explains. 0 for one strand.
float twist_of(const Stations& stations, std::span<const std::uint32_t> strands,
               const std::array<CrossSection, LodHierarchy::kPoints>& sections);

/// Exchanges the axes of all sections, by a quarter turn, where `major` is the shorter one on the mean.
void put_longer_first(std::array<CrossSection, LodHierarchy::kPoints>& sections);

/// Mean area of sections.
float mean_area(const std::array<CrossSection, LodHierarchy::kPoints>& sections);

}  // namespace pelage
