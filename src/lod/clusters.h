// Who stands together on which level.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/guide_hairs.h"
#include "lod/stations.h"

namespace pelage {

/// Sets order, prisms and the hairs of level 0 of `lod`: strands that share their three guides (Huang 2025, section 5.1, step 2).
/// Prisms ascend; strands of one keep their order.
void group_by_prism(const std::vector<Prism>& nearest, LodHierarchy& lod);

/// Adds a level below the finest one: every hair's strands in parts, whose mean area, a strand's part counting as often as there
/// are strands in it, is about 1/area_ratio of the hair's; areas without strays, which no division makes less. Reorders strands within hairs of the
/// finest level.
///
/// The part with the most area in it is divided in two (k-means) until that is reached, or kMostParts are; strands that lie in the
/// same places stay together.
void divide_finest_level(const Stations& stations, const LodSettings& settings, LodHierarchy& lod);
inline constexpr std::size_t kMostParts = 16;

}  // namespace pelage
