// Raster, for hair meshes: strands are made, drawn into 64-bit pixels and forgotten (Lipp 2026, §3.1).
#pragma once

#include <pelage/progress.h>
#include <pelage/scene.h>

#include <cstdint>
#include <span>

#include "frame/deferred.h"

namespace pelage {

/// Which layers of a DeferredBuffer to fill.
struct DeferredLayers {
  bool center = true;
  bool conservative = false;  ///< only together with `center`
  int samples = 0;            ///< 0 for none; else 2, 4 or 8
  bool coverage = false;      ///< exact area of the strands
};

/// The part of the picture that the selected bundles can reach, and the depths that they have there; a part of no size where
/// they reach none. Fills view, left, top and range of `out`.
void place_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                    const CameraView& view, DeferredBuffer& out);

/// Clears the layers of `out`, which place_deferred() has placed, and draws the strands of `selection` into them. The same bits for
/// any number of threads and any instruction set. Returns the number of segments.
///
/// opaque_depth: of the whole picture, camera z, [picture height · picture width · samples], with samples those of `layers`, 1
/// for none; or empty. Strands behind are hidden, in the layers of one sample where the pixel is hidden as a whole.
/// Throws what `progress` throws; Error("raster", …) when it cancels.
std::uint64_t raster_hair_meshes(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                                 const CameraView& view, const DeferredLayers& layers, const Buffer<float>& opaque_depth,
                                 DeferredBuffer& out, const Progress& progress = {});

}  // namespace pelage
