// Guides: the few strands that a groom moves with, and how much of each every other strand takes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lod/stations.h"

namespace pelage {

/// Three guides, ascending: the edges of a triangular prism.
using Prism = std::array<std::uint32_t, 3>;

/// A guide for each of `count` clusters of strands by k-means over their control points: the strand with the least mean squared
/// distance D to the others of its cluster (Huang 2025, section 5.1, step 1). Strand indices, ascending; fewer than `count` where
/// fewer strands differ.
std::vector<std::uint32_t> choose_guides(const Stations& stations, std::uint32_t count, std::uint32_t seed,
                                         const Progress& progress);

/// Those strands that others name as their guide (StrandSet::guide_id). Strand indices, ascending; none where there are no such.
std::vector<std::uint32_t> own_guides(const StrandSet& strands);

/// The three guides nearest to every strand by D, of equal ones the first; with fewer than three guides the last stands in for
/// those that are missing. [strand_count]
std::vector<Prism> nearest_guides(const Stations& stations, const std::vector<std::uint32_t>& guides);

/// Shares of the three guides (the third has the rest), each 0…1, with which they come nearest to `strand` over all control
/// points. Where several do, that with the least sum of squares.
Vec2 prism_weights(const Vec3* strand, const Vec3* g0, const Vec3* g1, const Vec3* g2);

}  // namespace pelage
