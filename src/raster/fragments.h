// Fragments on their way from the walk over bands to the depth test: a few thousand at a time, per thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "frame/deferred.h"
#include "frame/frame.h"

namespace pelage {

class TileLocks;

/// Covered places whose depth has not been tested yet. Walks append whole lanes, so there is room for one behind the end.
struct FragmentBuffer {
  static constexpr std::size_t kCapacity = 4096;
  static constexpr std::size_t kPadding = 64;
  std::size_t count = 0;
  Buffer<std::uint32_t> pixel{kCapacity + kPadding};  ///< y·width + x
  Buffer<std::uint32_t> rank{kCapacity + kPadding};   ///< by depth: the high half of the key, but for what `id` adds to it
  Buffer<std::uint32_t> id{kCapacity + kPadding};     ///< segment, or what else the low half is made from
  Buffer<std::uint32_t> mask{kCapacity + kPadding};   ///< bit s: sample s is covered; unused by the center layer
};

/// Walks the bands of `block`, many segments at a time, and enters what covers pixel centers into `keys`
/// ([height·width], nearest wins). `fragments` is scratch of the calling thread.
void raster_center(const ScreenBlock& block, int width, int height, FragmentBuffer& fragments, PixelKey* keys);

/// The same for sample layers of 1, 2, 4, 8 or 16 samples a pixel; keys: [height·width·samples], 64-byte aligned, which
/// all threads enter through the same `locks` of a width × height image.
void raster_samples(const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& fragments, TileLocks& locks,
                    PixelKey* keys);

/// Walks the strands of a block of assemble_group(): what covers pixel centers goes to `center`, what touches pixels at all to
/// `conservative`, in one walk; the latter may be null. Keys are those of DeferredBuffer, whose depth is in `range`.
void raster_deferred(const ScreenBlock& block, const DepthRange& range, int width, int height, FragmentBuffer& fragments,
                     PixelKey* center, PixelKey* conservative);
/// Their sample layers, as of raster_samples().
void raster_deferred_samples(const ScreenBlock& block, const DepthRange& range, int width, int height, int samples,
                             FragmentBuffer& fragments, TileLocks& locks, PixelKey* keys);

}  // namespace pelage
