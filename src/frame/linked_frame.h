// One frame by strand linking: the layer that linking works on, and what becomes of it.
#pragma once

#include <pelage/image.h>

#include "frame/one_frame.h"
#include "frame/visibility.h"

namespace pelage {

class PixelMask;
class StrandCurves;

/// What linking works on.
struct LinkInput {
  StrandLayer layer;
  Behind behind;
};

/// One sample in the middle of each pixel of inputs.view, which has `side`² pixels for one of the picture's; with the exact
/// area of strands where `coverage` is set. The layer reaches kLayerMargin screen pixels beyond all samples of hair.
LinkInput render_strand_layer(const FrameInputs& inputs, int side, bool coverage, Stages& stages);
inline constexpr int kLayerMargin = 16;  ///< a walk may leave the box of all samples by that much

/// Sets place and size of `layer`, of whose side² visibility pixels a screen pixel has, around all of `hair`.
void place_layer(const PixelMask& hair, StrandLayer& layer);

/// Links, alpha fix and filter as scene.settings.link says: R, G, B, A, linear, premultiplied, of the size of the picture.
/// `nearest`, where given, becomes [h·w]: camera z of what a pixel's first visibility pixel shows after linking. The filter's kernel
/// for color is `color_scale` ≥ 1 times as large as that for opacity.
Image link_and_filter(LinkInput input, const StrandCurves& curves, const RenderSettings& settings, Stages& stages,
                      Buffer<float>* nearest = nullptr, float color_scale = 1);

/// `what`, View::kLinked or kLinkAlpha: what linking and alpha fix make of one sample a pixel, no light.
DebugView render_link_view(const FrameInputs& inputs, View what, Stages& stages);

}  // namespace pelage
