// Shade, for hair meshes: what the 64 bits of a pixel tell is enough (Lipp 2026, §3.1.2 and §3.4).
#pragma once

#include <pelage/scene.h>

#include <span>

#include "frame/deferred.h"
#include "frame/frame.h"

namespace pelage {

/// Colors of the strands that `buffer` shows: of its sample_keys, or of `center` where there are none. Samples of a pixel that see
/// the same strand share one evaluation. Position comes from depth, color from the groom's material and maps by uvw.
///
/// grooms, selection: those that the buffer was made with; sample_positions: places of the samples inside a pixel (of `center`:
/// one, the middle). Bits do not depend on threads or instruction set. O(pixels · samples + evaluations · lights).
Radiance shade_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                        const DeferredBuffer& buffer, const DeferredMaterials& materials,
                        std::span<const Vec2> sample_positions);

}  // namespace pelage
