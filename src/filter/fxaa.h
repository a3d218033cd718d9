// Fast approximate anti-aliasing, version 3.11, quality variant (references.bib: Lottes2009Fxaa): pixels at an edge take color from
// across it, by how far they are from the ends of the edge.
#pragma once

#include <pelage/image.h>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// Thresholds are of display-encoded brightness. The defaults are the author's for high quality, with the longest of
/// his searches (preset 39: 27 pixels to either side).
struct FxaaSettings {
  float edge_threshold = 0.125f;  ///< contrast of a pixel and its four neighbors, as a share of the brightest, to be an edge
  float edge_threshold_min = 0.0312f;  ///< … and at least this
  float subpixel = 0.75f;              ///< 0…1: how much single pixels that stick out are blurred
};

/// [h·w] pixels from the center of each pixel to where it is to be read instead (see resample()); 0 away from edges,
/// at most half a pixel elsewhere. `display` is encoded R, G, B, A.
///
/// O(pixels), rows in parallel; no pixel depends on the result of another.
Buffer<Vec2> fxaa_offsets(const Image& display, const FxaaSettings& settings = {});

}  // namespace pelage
