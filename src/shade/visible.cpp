#include "shade/visible.h"

#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kPixelsPerTask = 4096;
constexpr std::size_t kMaxSamplesPerPixel = 16;

std::uint32_t segment_of(PixelKey key) { return static_cast<std::uint32_t>(key); }

/// Position of the first key of the pixel with the segment of key i; i itself where it is the first.
std::size_t first_alike(const PixelKey* pixel, std::size_t i) {
  std::size_t k = 0;
  while (segment_of(pixel[k]) != segment_of(pixel[i]) || pixel[k] == kEmptyPixel) ++k;
  return k;
}

std::size_t count_distinct(const PixelKey* pixel, std::size_t n) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (pixel[i] != kEmptyPixel && first_alike(pixel, i) == i) ++count;
  return count;
}

}  // namespace

VisibleList list_visible(std::span<const PixelKey> keys, int samples_per_pixel) {
  const std::size_t n = static_cast<std::size_t>(samples_per_pixel), pixels = keys.size() / n;
  PELAGE_CHECK(n >= 1 && n <= kMaxSamplesPerPixel);
  PELAGE_CHECK_EQ(pixels * n, keys.size());
  PELAGE_CHECK_LT(keys.size(), std::size_t{Radiance::kNone});
  std::vector<std::size_t> first((pixels + kPixelsPerTask - 1) / kPixelsPerTask + 1);
  parallel_for(pixels, kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t p = begin; p < end; ++p) count += count_distinct(keys.data() + p * n, n);
    first[begin / kPixelsPerTask + 1] = count;
  });
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];

  VisibleList list;
  list.first.resize(first.back()), list.index.resize(keys.size());
  parallel_for(pixels, kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    std::size_t next = first[begin / kPixelsPerTask];
    for (std::size_t p = begin; p < end; ++p) {
      const PixelKey* pixel = keys.data() + p * n;
      std::uint32_t* index = list.index.data() + p * n;
      for (std::size_t i = 0; i < n; ++i) {
        index[i] = Radiance::kNone;
        if (pixel[i] == kEmptyPixel) continue;
        const std::size_t k = first_alike(pixel, i);
        if (k == i) {
          list.first[next] = static_cast<std::uint32_t>(p * n + i);
          index[i] = static_cast<std::uint32_t>(next++);
        } else {
          index[i] = index[k];
        }
      }
    }
  });
  return list;
}

}  // namespace pelage
