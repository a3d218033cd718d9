#include "raster/gbuffer.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/sample_positions.h"
#include "raster/analytic.h"
#include "raster/coverage.h"

namespace pelage {
namespace {

constexpr std::size_t kGrain = 1 << 16;

template <class T>
void clear(Buffer<T>& buffer, bool wanted, std::size_t size, T value) {
  if (!wanted) return buffer.release();
  buffer.resize(size);
  parallel_for(size, kGrain,
               [&](std::size_t begin, std::size_t end) { std::fill(&buffer[begin], &buffer[begin] + (end - begin), value); });
}

void hide(Buffer<PixelKey>& keys, const Buffer<float>& opaque, std::size_t samples_per_key) {
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float* depth = &opaque[i * samples_per_key];
      keys[i] = pixel_key(*std::max_element(depth, depth + samples_per_key), ScreenBlock::kNoSegment);
    }
  });
}

void finish(Buffer<PixelKey>& keys) {
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (key_id(keys[i]) == ScreenBlock::kNoSegment) keys[i] = kEmptyPixel;
  });
}

// What is as good as full is full, in whatever order the strands came.
void finish_coverage(GBuffer& out) {
  constexpr auto kWhole = static_cast<std::uint32_t>(kMaxStrandDepth / GBuffer::kCoverageUnit);
  parallel_for(out.coverage.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (out.coverage[i] >= kFullDepth) out.coverage[i] = kWhole;
  });
}

}  // namespace

void clear_gbuffer(const CameraView& view, const RasterLayers& layers, GBuffer& out) {
  if (layers.samples != 0 && !is_sample_count(layers.samples))
    throw Error("raster", "samples", fmt::format("{} samples per pixel", layers.samples), "use 1, 2, 4, 8 or 16");
  out.width = view.width, out.height = view.height, out.samples = std::max(1, layers.samples);
  const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const std::size_t samples = static_cast<std::size_t>(out.samples);
  clear(out.center, layers.center, pixels, kEmptyPixel);
  clear(out.conservative, layers.conservative, pixels, kEmptyPixel);
  clear(out.sample_keys, layers.samples > 0, pixels * samples, kEmptyPixel);
  clear(out.coverage, layers.analytic || layers.coverage, pixels, std::uint32_t{0});
  clear(out.tangent_cos2, layers.analytic, pixels, std::int32_t{0});
  clear(out.tangent_sin2, layers.analytic, pixels, std::int32_t{0});
  clear(out.overdraw, layers.overdraw, pixels, std::uint32_t{0});
  if (out.opaque_depth.empty()) return;
  PELAGE_CHECK_EQ(out.opaque_depth.size(), pixels * samples);
  if (layers.center) hide(out.center, out.opaque_depth, samples);
  if (layers.conservative) hide(out.conservative, out.opaque_depth, samples);
  if (layers.samples > 0) hide(out.sample_keys, out.opaque_depth, 1);
}

void finish_gbuffer(const RasterLayers& layers, GBuffer& out) {
  if (layers.coverage) finish_coverage(out);
  if (out.opaque_depth.empty()) return;
  if (layers.center) finish(out.center);
  if (layers.conservative) finish(out.conservative);
  if (layers.samples > 0) finish(out.sample_keys);
}

}  // namespace pelage
