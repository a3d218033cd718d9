// The G-buffer before and after the strands.
#pragma once

#include "frame/frame.h"
#include "raster/raster.h"

namespace pelage {

/// Sizes `out` for `view` and `layers` and clears it. Opaque geometry enters here: a pixel of a nearest-wins layer starts
/// at (opaque depth, kNoSegment) where there is some, so that the nearest-wins rule itself hides what lies behind.
void clear_gbuffer(const CameraView& view, const RasterLayers& layers, GBuffer& out);

/// Makes pixels that no strand won kEmptyPixel again.
void finish_gbuffer(const RasterLayers& layers, GBuffer& out);

}  // namespace pelage
