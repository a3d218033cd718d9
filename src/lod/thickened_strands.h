// A baseline for thick hairs: a random part of the strands, each as much wider as the others are missing (Cook 2007, references.bib:
// Cook2007Stochastic; Lipp 2026 thins bundles of hair meshes so).
#pragma once

#include <cstdint>
#include <vector>

#include "lod/pieces.h"
#include "lod/strand_cuts.h"

namespace pelage {

/// Which strand stands for every cluster.
class ThickenedStrands {
 public:
  /// O(strands · levels). Refers to nothing.
  explicit ThickenedStrands(const LodHierarchy& lod);

  /// A random strand of the cluster of a hair, which one of its children keeps too: strands of coarse levels are always a part of those of finer ones.
  std::uint32_t strand(std::size_t hair) const { return strands_[hair]; }

  /// Draws that strand of `set`, as many times as wide as the hair has fibers: in sum widths are those of all strands. Its sections
  /// are those of the hair. All arguments must outlive what is returned, and so must this.
  DrawCluster pen(const StrandSet& set, const LodHierarchy& lod, const StrandCuts& cuts) const;

 private:
  std::vector<std::uint32_t> strands_;  // [hairs]
};

}  // namespace pelage
