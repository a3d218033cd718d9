// Single strands between the guides: clumps, curls, frizz, flyaways, widths.
#pragma once

#include <pelage/grow.h>

#include "groom/guides.h"

namespace pelage::groom {

/// One strand per root. `roots` in the order of scatter_roots(); strands come out sorted by guide, with strand_id the
/// place in `roots`, so that the strands with strand_id < n are an even thinning of the whole.
StrandSet fill_strands(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                       const std::vector<Root>& roots, const Progress& progress);

}  // namespace pelage::groom
