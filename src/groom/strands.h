// Single strands between the guides: locks, curls, frizz, flyaways, lengths and widths.
#pragma once

#include <pelage/grow.h>

#include <vector>

#include "groom/guides.h"

namespace pelage::groom {

/// One strand per root. Strands come out sorted by their nearest guide (guide_id); strand_id is the place in `roots`, so
/// that the strands with strand_id < n are an even thinning of the whole when every prefix of `roots` is.
StrandSet fill_strands(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                       const std::vector<Root>& roots, const Progress& progress);

}  // namespace pelage::groom
