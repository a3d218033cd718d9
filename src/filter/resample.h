// Pictures read between their pixels, and what edge filters see of a picture.
#pragma once

#include <pelage/image.h>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// How the color channels of a picture relate to its alpha.
enum class AlphaKind {
  kPremultiplied,  ///< RenderResult::linear
  kStraight,       ///< RenderResult::display
};

/// A weighted sum of pixels (R, G, B, A); straight color is weighted by its alpha.
class PixelSum {
 public:
  explicit PixelSum(AlphaKind alpha) : alpha_(alpha) {}
  void add(const float* rgba, float weight);
  /// The sum, of the pixels' own kind of alpha.
  void write(float* rgba) const;

 private:
  AlphaKind alpha_;
  float sum_[4] = {};
};

/// Every pixel of `image` (R, G, B, A) bilinearly from its center plus offsets[y·width + x], pixels; what lies outside is
/// the border. O(pixels), rows in parallel.
Image resample(const Image& image, const Buffer<Vec2>& offsets, AlphaKind alpha);

/// [h·w] brightness of the encoded picture `display` (R, G, B, A; straight) as an eye sees it over black: 0…1, the luma of
/// ITU-R BT.601, which FXAA and SMAA both use.
Buffer<float> display_luma(const Image& display);

}  // namespace pelage
