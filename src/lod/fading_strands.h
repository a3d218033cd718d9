// Strands that fade in while the thick hairs that stand for them fade out.
#pragma once

#include <pelage/scene.h>

#include <cstdint>
#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"
#include "lod/strand_cuts.h"

namespace pelage {

/// Segments of every strand whose finest hair passes something on at their ends, and where it passes all.
struct StrandSegments {
  std::vector<std::uint16_t> drawn, whole;  ///< [strands] a bit a segment; `whole` is a part of `drawn`
};
StrandSegments strand_segments(const LodHierarchy& lod, const BlendedCut& cut);

/// Copies of the strands of `set` that are drawn with a share somewhere, in the order of memory, narrowed by it; `parts` of them fade. All that
/// strands have they keep. The same for any number of threads. O(points of those strands).
Pieces fading_strands(const StrandSet& set, const LodHierarchy& lod, const BlendedCut& cut, const StrandSegments& segments,
                      const StrandCuts& cuts);

}  // namespace pelage
