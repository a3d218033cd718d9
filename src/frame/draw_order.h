// In which order strands are drawn into an image that several threads share.
#pragma once

#include <pelage/scene.h>

#include <cstdint>
#include <vector>

#include "frame/frame.h"

namespace pelage {

/// The strands of `groom` in an order that suits threads which take neighbors of it: strips of the image that `view` sees, one
/// after the other, and in each of them the nearest strands first, all by the strands' middle control points. Threads in strips of their own
/// seldom write the same cache lines, and fragments that come after nearer ones need no more than a look.
///
/// Empty for grooms with GroomInstance::only, and where the order in memory serves better: neighbors there are neighbors on the screen already, or strands cover few
/// pixels for the points that have to be fetched. Only speed may depend on the order. O(strands), some 20 ns each.
std::vector<std::uint32_t> draw_order(const GroomInstance& groom, const CameraView& view);

}  // namespace pelage
