// A baseline for thick hairs: a random part of the strands, each as much wider as the others are missing (Cook 2007, references.bib:
// Cook2007Stochastic; Lipp 2026 thins bundles of hair meshes so).
#pragma once

#include <cstdint>
#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"

namespace pelage {

/// Which strands of every prism are kept.
class ThickenedStrands {
 public:
  /// O(strands · log strands). Refers to nothing.
  explicit ThickenedStrands(const LodHierarchy& lod);

  /// Strands of a prism in a random order that never changes: fewer of them are always a part of more.
  const std::uint32_t* strands(const LodHierarchy& lod, std::size_t prism) const {
    return &shuffled_[lod.hairs[prism].first_strand];
  }

  /// Draws as many strands of `set` as a level has thick hairs in the prism, m of n, n/m times as wide: in sum their widths are those of
  /// all. Their sections are their share of the prism's, 1/m of its area. All arguments must outlive what is returned, and so must this.
  DrawClusters pen(const StrandSet& set, const LodHierarchy& lod, const LevelBounds& bounds) const;

 private:
  std::vector<std::uint32_t> shuffled_;  // LodHierarchy::order, each prism's strands among themselves
};

}  // namespace pelage
