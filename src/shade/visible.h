// The strands that pixels see, each once per pixel, in a fixed order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

struct VisibleList {
  Buffer<std::uint32_t> first;  ///< of each distinct segment of each pixel: the first key that shows it; increasing
  Buffer<std::uint32_t> index;  ///< [keys] Radiance::index: which of `first` a key shows; Radiance::kNone for none
};

/// Lists `keys`, the layer of pixels with `samples_per_pixel` adjacent keys each. O(keys), in parallel: counts per block
/// of pixels, sums them up, then fills, so that the order is that of the pixels for any number of threads.
VisibleList list_visible(std::span<const PixelKey> keys, int samples_per_pixel);

}  // namespace pelage
