// Curves that stand for clusters of strands, as they are made.
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/buffer.h"

namespace pelage {

/// Segments first … last − 1 of a hair.
struct LodRun {
  std::size_t first, last;
};

/// Calls body(run) for every run of set bits of `segments`.
template <class Body>
void for_each_run(std::uint32_t segments, const Body& body) {
  for (std::size_t first = 0, last; segments >> first != 0; first = last) {
    first += static_cast<std::size_t>(std::countr_zero(segments >> first));
    last = first + static_cast<std::size_t>(std::countr_one(segments >> first));
    body(LodRun{first, last});
  }
}

/// Calls body(hair, strand) for every strand of the finest level, in parallel.
void for_each_finest_strand(const LodHierarchy& lod, const std::function<void(std::size_t hair, std::uint32_t strand)>& body);

/// What stands for clusters of strands: whole curves, and which parts of them are drawn.
struct Pieces {
  StrandSet hairs;
  ThickSections sections;         ///< of `hairs`
  std::vector<StrandPart> parts;  ///< of `hairs`, ascending
  std::vector<float> shares;      ///< of `hairs`, GroomInstance::shares; none where levels do not blend
};

/// Appends what stands for the cluster of a hair along the segments whose bits are set, of which there are some. Called from several threads
/// at once, each with pieces of its own. `level` is the hair's.
using DrawCluster = std::function<void(std::uint32_t hair, std::size_t level, std::uint16_t segments, Pieces& out)>;

/// Segments of a hair that are drawn, a bit for each.
using ShownSegments = std::function<std::uint16_t(std::size_t hair)>;

/// Makes what stands for all hairs of which some segments are drawn.
using DrawHairs = std::function<Pieces(const ShownSegments& shown)>;

/// A cluster after the other, level by level. Refers to `lod`.
DrawHairs cluster_by_cluster(const LodHierarchy& lod, DrawCluster draw);

/// Knot k of the B-spline along the center of a hair.
Vec3 hair_knot(const LodHierarchy& lod, std::size_t hair, std::size_t k);

/// Strand s of `from` without its points, appended to `to`.
void append_attributes(const StrandSet& from, std::size_t s, StrandSet& to);
/// Number of the first strand of thick hair `h` of a chain of `from`: the hair's own.
std::uint32_t first_strand_id(const LodHierarchy& lod, std::size_t h, const StrandSet& from);
/// What thick hair `h` of a chain of `from` has besides points, appended to `to`.
void append_attributes(const LodHierarchy& lod, std::size_t h, const StrandSet& from, StrandSet& to);
/// Closes the strand whose points were appended last.
void end_strand(StrandSet& set);

/// A strand, `widen` times as wide as it is.
void append_strand(const StrandSet& set, std::uint32_t strand, float widen, StrandSet& pieces);

template <class T>
void reserve(std::size_t count, std::vector<T>& values) {
  values.reserve(count);
  prefer_huge_pages(values.data(), count * sizeof(T));
}

/// Makes room for so many points of so many curves.
void reserve(std::size_t points, std::size_t curves, Pieces& pieces);

/// All of `parts`, one after the other.
Pieces join(const std::vector<Pieces>& parts);

}  // namespace pelage
