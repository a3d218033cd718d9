// What a groom with levels of detail is drawn as: strands, pieces of strands, and pieces of what stands for clusters.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pelage {

/// Segments first … last − 1 of the hairs of a prism, all of one level.
struct LodRun {
  std::size_t first, last, level;
};

/// What some prisms are drawn as.
struct Pieces {
  std::vector<std::uint32_t> whole;  ///< strands, as they stand in the groom
  StrandSet strands;                 ///< parts of strands
  StrandSet hairs;                   ///< what stands for clusters
  ThickSections sections;            ///< of `hairs`
};

/// Appends to Pieces::hairs and Pieces::sections what stands for the clusters of a prism along a run of a level of thick hairs. Called from
/// several threads at once, each with pieces of its own.
using DrawClusters = std::function<void(std::size_t prism, const LodRun& run, Pieces& out)>;

/// Share of a hair's length that control point k lies at.
inline float share_at(std::size_t k) { return static_cast<float>(k) / static_cast<float>(LodHierarchy::kPoints - 1); }

/// Knot k of the B-spline along the center of a hair.
Vec3 hair_knot(const LodHierarchy& lod, std::size_t hair, std::size_t k);

/// Strand s of `from` without its points, appended to `to`.
void append_attributes(const StrandSet& from, std::size_t s, StrandSet& to);
/// What thick hair `h` of a chain of `from` has besides points, appended to `to`; the strand's number is that of its first one.
void append_attributes(const LodHierarchy& lod, std::size_t h, const StrandSet& from, StrandSet& to);
/// Closes the strand whose points were appended last.
void end_strand(StrandSet& set);

/// The part of a strand at shares `from` to `to` of the length of its control polygon, and what it takes to whole spans, `widen` times as
/// wide as it is. The lengths are those in `measured`, the strands in another pose, where it is given: so two poses are cut alike.
void append_strand(const StrandSet& set, std::size_t strand, float from, float to, float widen, StrandSet& pieces,
                   const StrandSet* measured = nullptr);

/// `from` after what stands in `to`.
void append(const Pieces& from, Pieces& to);

}  // namespace pelage
