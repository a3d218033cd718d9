// Where strands are cut that are drawn in parts, between the segments of their thick hairs.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <cstdint>

#include "lod/choose_levels.h"

namespace pelage {

/// Of a strand the places of its thick hair's control points, to whole spans.
struct CutStrand {
  std::uint32_t strand;
  std::array<std::uint32_t, LodHierarchy::kPoints> spans;  ///< from the root

  /// Along segments first … last − 1; of no spans where it has too few.
  StrandPart part(std::size_t first, std::size_t last) const { return {strand, spans[first], spans[last] - spans[first]}; }
  /// What `at` [kPoints], values at the control points, is at the end of so many spans from the root: straight between the cuts.
  float between(const float* at, float from_root) const;
};

/// Cuts strands of a groom. Refers to it: keep it alive. Where the groom moves, other poses are cut as this one, so that they have the same parts.
class StrandCuts {
 public:
  explicit StrandCuts(const StrandSet& strands) : strands_(&strands) {}

  /// By shares of the length of the control polygon: of the spans' ends the nearest, so that parts are as long in the mean as what
  /// they stand for. O(points of the strand).
  CutStrand operator()(std::uint32_t strand) const;

 private:
  const StrandSet* strands_;
};

}  // namespace pelage
