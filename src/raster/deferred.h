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

/// The part of the picture that the bundles of `selection` that view `number` sees can reach, and the depths that they have there;
/// a part of no size where they reach none. Fills view, left, top and range of `out`. view: that of the whole picture.
void place_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                    std::size_t number, const CameraView& view, DeferredBuffer& out);

/// A view that strands are drawn for.
struct DeferredTarget {
  const CameraView& view;  ///< of the whole picture
  /// Of the whole picture, camera z, [picture height · picture width · samples], with samples those of the layers, 1 for none; or
  /// empty. Strands behind are hidden, in the layers of one sample where the pixel is hidden as a whole.
  const Buffer<float>& opaque_depth;
  DeferredBuffer& out;  ///< placed by place_deferred()
};

/// Clears the layers of all targets and draws the strands of `selection` into them, each made once. Target v is the view of that
/// number in `selection`; what it gets is what it would get alone. The same bits for any number of threads and any instruction set.
/// Returns the number of segments that were made: bundles that nearer ones hide as a whole are left out, but for
/// layers of area, or of centers and samples at once.
///
/// targets: as many as views were selected for. Throws what `progress` throws; Error("raster", …) when it cancels.
std::uint64_t raster_hair_meshes(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                                 std::span<const DeferredTarget> targets, const DeferredLayers& layers,
                                 const Progress& progress = {});

}  // namespace pelage
