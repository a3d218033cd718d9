// Where strands are cut that are drawn in parts, between the segments of their thick hairs.
#pragma once

#include <pelage/scene.h>

#include <cstdint>
#include <vector>

#include "lod/choose_levels.h"

namespace pelage {

/// Of each strand the places of its thick hair's control points, to whole spans.
class StrandCuts {
 public:
  /// By shares of the length of control polygons: of the spans' ends the nearest, so that parts are as long in the mean as what
  /// they stand for. O(points), in parallel. Strands in other poses are cut alike.
  explicit StrandCuts(const StrandSet& strands);

  /// The part of a strand along segments first … last − 1; of no spans where it has too few.
  StrandPart part(std::uint32_t strand, std::size_t first, std::size_t last) const;

  /// What `at` [kPoints], values at the control points, is at the end of so many spans from the root: straight between the cuts.
  float between(std::uint32_t strand, const float* at, float spans) const;

 private:
  std::vector<std::uint32_t> cuts_;  // [strands · kPoints], spans from the root
};

}  // namespace pelage
