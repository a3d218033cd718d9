#include "raster/raster.h"

#include <pelage/error.h>

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>

#include "assemble/assemble.h"
#include "core/check.h"
#include "core/parallel.h"
#include "kernel/scalar.h"
#include "raster/gbuffer.h"
#include "raster/sample_positions.h"

namespace pelage {

PixelKey pixel_key(float depth, std::uint32_t id) {
  return static_cast<PixelKey>(std::bit_cast<std::uint32_t>(depth)) << 32 | id;
}
float key_depth(PixelKey key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }

namespace {

constexpr std::size_t kStrandsPerTask = 64;

void atomic_min(PixelKey& pixel, PixelKey key) {
  const std::atomic_ref<PixelKey> shared(pixel);
  PixelKey now = shared.load(std::memory_order_relaxed);
  while (key < now && !shared.compare_exchange_weak(now, key, std::memory_order_relaxed)) {
  }
}

/// Calls emit(x, y, depth) for every pixel whose point at `at` (from its top left corner) the band covers.
template <class Emit>
void walk(const kernel::RasterBand& band, int width, int height, Vec2 at, const Emit& emit) {
  const float at_u = band.x_major ? at.x : at.y, at_v = band.x_major ? at.y : at.x;
  const int columns = band.x_major ? width : height, rows = band.x_major ? height : width;
  const float first = std::max(std::ceil(band.first - at_u), 0.f);
  const float last = std::min(std::floor(band.last - at_u), static_cast<float>(columns - 1));
  for (float column = first; column <= last; ++column) {
    const float u = column + at_u, s = u - band.u;
    const float center = kernel::raster_band_center(band, s), half = kernel::raster_band_half(band, s);
    float row = std::max(kernel::raster_first_row(center, half, at_v), 0.f);
    for (; row < static_cast<float>(rows) && kernel::raster_row_covered(row, at_v, center, half); ++row) {
      if (!kernel::raster_between_caps(band, u, row + at_v)) continue;
      const int i = static_cast<int>(column), j = static_cast<int>(row);
      emit(band.x_major ? i : j, band.x_major ? j : i, kernel::raster_band_depth(band, s));
    }
  }
}

void raster_block(const ScreenBlock& block, const RasterLayers& layers, GBuffer& out) {
  const auto positions = sample_positions(layers.samples > 0 ? layers.samples : 1);
  for (std::size_t j = 0; j + 1 < block.count; ++j) {
    const std::uint32_t id = block.id[j];
    if (id == ScreenBlock::kNoSegment) continue;
    const kernel::RasterBand band = kernel::raster_band(
        {block.x[j], block.y[j]}, {block.x[j + 1], block.y[j + 1]}, block.radius[j], block.radius[j + 1],
        block.depth[j], block.depth[j + 1], {block.cap_x[j], block.cap_y[j]}, {block.cap_x[j + 1], block.cap_y[j + 1]});
    if (layers.center || layers.overdraw)
      walk(band, out.width, out.height, {0.5f, 0.5f}, [&](int x, int y, float depth) {
        const std::size_t pixel = static_cast<std::size_t>(y) * out.width + x;
        if (layers.center) atomic_min(out.center[pixel], pixel_key(depth, id));
        if (layers.overdraw) std::atomic_ref(out.overdraw[pixel]).fetch_add(1, std::memory_order_relaxed);
      });
    for (int sample = 0; sample < layers.samples; ++sample)
      walk(band, out.width, out.height, positions[sample], [&](int x, int y, float depth) {
        const std::size_t pixel = static_cast<std::size_t>(y) * out.width + x;
        atomic_min(out.sample_keys[pixel * layers.samples + sample], pixel_key(depth, id));
      });
  }
}

/// Tells progress from whichever thread gets there first, and passes a cancellation on.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::uint64_t total) : progress_(progress), total_(total) {}
  void add(std::uint64_t done) {
    const std::uint64_t now = done_.fetch_add(done, std::memory_order_relaxed) + done;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || now < told_) return;
    told_ = now;
    if (!progress_("raster", static_cast<double>(now) / static_cast<double>(total_)))
      throw Error("raster", "", "cancelled", "");
  }

 private:
  const Progress& progress_;
  std::uint64_t total_, told_ = 0;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;
};

}  // namespace

std::uint64_t raster_strands(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                             const RasterLayers& layers, GBuffer& out, const Progress& progress) {
  clear_gbuffer(view, layers, out);
  std::uint64_t strands = 0;
  for (const GroomInstance& groom : scene.grooms) strands += groom.strands->strand_count();
  SharedProgress shared(progress, std::max<std::uint64_t>(1, strands));
  std::atomic<std::uint64_t> segments{0};
  tbb::enumerable_thread_specific<ScreenBlock> blocks;
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const AssembleJob job = make_assemble_job(scene, view, numbering, g);
    parallel_for(job.strands->strand_count(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      ScreenBlock& block = blocks.local();
      std::uint64_t drawn = 0;
      for (std::size_t s = begin; s < end;) {
        s = assemble_strands(job, s, end, block);
        raster_block(block, layers, out);
        drawn += block.count;
      }
      segments.fetch_add(drawn, std::memory_order_relaxed);
      shared.add(end - begin);
    });
  }
  finish_gbuffer(layers, out);
  return segments;
}

}  // namespace pelage
