// Debug views: what the G-buffer holds, one sample in the middle of each pixel.
#pragma once

#include <pelage/image.h>
#include <pelage/scene.h>

#include "frame/frame.h"

namespace pelage {

/// The same picture twice: numbers, and colors for people. Both R, G, B, A; A is 1 where there is a strand.
struct DebugView {
  Image
      data;  ///< the value in R, G and B: metres, u, coverage, fragments; unit tangent; hash of the strand; albedo; level of thick hairs, -1: strand
  Image display;  ///< sRGB-encoded, 0…1
};

/// `what` is any View but kBeauty, kMotion, kLinked and kLinkAlpha. Needs GBuffer::center, for kCoverage the analytic layer, for kOverdraw `overdraw`.
/// A strand keeps its kStrandId color from every camera: it follows from the strand's id. O(pixels · log strands).
DebugView make_debug_view(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer,
                          View what);

}  // namespace pelage
