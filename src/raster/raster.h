// Raster: all strands of a scene → the layers of a G-buffer, nearest wins.
#pragma once

#include <pelage/progress.h>
#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>

#include "core/pixel_mask.h"
#include "frame/frame.h"
#include "raster/keys.h"

namespace pelage {

/// Which layers of a GBuffer to fill. They share one walk over the strands.
struct RasterLayers {
  bool center = true;         ///< band covers the pixel's center
  bool conservative = false;  ///< band touches the pixel anywhere
  int samples = 0;            ///< 0 for none; else 1, 2, 4, 8 or 16 positions (frame/sample_positions.h)
  bool analytic = false;      ///< area and tangent: raster/analytic.h
  bool coverage = false;      ///< area alone, of thin strands, and fast: raster/coverage.h; not together with `analytic`
  const PixelMask* full =
      nullptr;            ///< pixels that `coverage` takes as full from the beginning, and draws nothing into; or null
  bool overdraw = false;  ///< count the fragments at the pixel's center, hidden ones too
};

/// Rasterizes every strand of `scene` into `out`: resizes and clears the layers that `layers` asks for, empties the others,
/// then streams assemble → raster, a block of points per thread at a time. The result has the same bits for any number
/// of threads and any instruction set. Returns the number of segments drawn or looked at.
///
/// view: of make_camera_view(); numbering: of number_segments() for this scene and view.
/// out.opaque_depth: empty, or [height·width·out_samples] with out_samples = max(1, layers.samples); hair behind it is
/// hidden: sample by sample in `sample_keys`; in the other layers a pixel hides what lies behind all its samples.
/// Throws what `progress` throws; Error("raster", …) when it cancels.
std::uint64_t raster_strands(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                             const RasterLayers& layers, GBuffer& out, const Progress& progress = {});

}  // namespace pelage
