// The strands that pixels see, each once per pixel, in a fixed order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// A distinct segment of a pixel, at the first of its samples that sees it.
struct VisibleSample {
  std::uint32_t pixel;   ///< y·width + x
  std::uint32_t sample;  ///< index of the sample position
  PixelKey key;
};

struct VisibleList {
  Buffer<VisibleSample> samples;  ///< ordered by pixel, then by sample
  Buffer<std::uint32_t> index;    ///< [keys] Radiance::index: which of `samples` a key shows; Radiance::kNone for none
};

/// Lists `keys`, the layer of pixels with `samples_per_pixel` adjacent keys each. O(keys), in parallel: counts per block
/// of pixels, sums them up, then fills, so that the order is that of the pixels for any number of threads.
VisibleList list_visible(std::span<const PixelKey> keys, int samples_per_pixel);

}  // namespace pelage
