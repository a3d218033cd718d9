#include "raster/raster.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "assemble/assemble.h"
#include "core/check.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/draw_order.h"
#include "frame/strand_part.h"
#include "raster/analytic.h"
#include "raster/band_area.h"
#include "raster/band_walk.h"
#include "raster/coverage.h"
#include "raster/fragments.h"
#include "raster/gbuffer.h"
#include "raster/keys.h"
#include "raster/tile_locks.h"

namespace pelage {

namespace {

constexpr std::size_t kStrandsPerTask = 64;

/// What one thread works with; reused from task to task.
struct Worker {
  ScreenBlock block;
  FragmentBuffer fragments;
  StrandAreas areas;
  CoverageScratch coverage;
};

/// What all threads share.
struct Shared {
  TileLocks locks;
  std::optional<FullTiles> full;
};

void count_overdraw(const ScreenBlock& block, GBuffer& out) {
  const std::size_t width = static_cast<std::size_t>(out.width);
  for (std::size_t j = 0; j + 1 < block.count; ++j) {
    if (block.id[j] == ScreenBlock::kNoSegment) continue;
    walk_centers(band_at(block, j), out.width, out.height, [&](int x, int y, float) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      std::atomic_ref(out.overdraw[pixel]).fetch_add(1, std::memory_order_relaxed);
    });
  }
}

void raster_conservative(const ScreenBlock& block, GBuffer& out) {
  const std::size_t width = static_cast<std::size_t>(out.width);
  for (std::size_t j = 0; j + 1 < block.count; ++j) {
    if (block.id[j] == ScreenBlock::kNoSegment) continue;
    walk_touched(band_at(block, j), out.width, out.height, [&](int x, int y, float depth) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      atomic_min(out.conservative[pixel], pixel_key(depth, block.id[j]));
    });
  }
}

void raster_block(Worker& worker, const RasterLayers& layers, Shared& shared, GBuffer& out) {
  const ScreenBlock& block = worker.block;
  if (layers.center) raster_center(block, out.width, out.height, worker.fragments, out.center.data());
  if (layers.samples > 0)
    raster_samples(block, out.width, out.height, layers.samples, worker.fragments, shared.locks, out.sample_keys.data());
  if (layers.conservative) raster_conservative(block, out);
  if (layers.analytic) raster_analytic(block, worker.areas, out);
  if (layers.coverage) raster_coverage(block, worker.coverage, *shared.full, out);
  if (layers.overdraw) count_overdraw(block, out);
}

/// Assembles all strands before `view` and enters them into `out`, task by task. Returns the number of segments.
std::uint64_t stream_strands(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                             const RasterLayers& layers, GBuffer& out, SharedProgress& progress) {
  std::atomic<std::uint64_t> segments{0};
  tbb::enumerable_thread_specific<Worker> workers;
  Shared shared{TileLocks(out.width, out.height), {}};
  if (layers.coverage) shared.full.emplace(out.width, out.height, layers.full);
  for (std::size_t g = 0; g < scene.grooms.size(); ++g) {
    const std::vector<std::uint32_t> order = draw_order(scene.grooms[g], view);
    AssembleJob job = make_assemble_job(scene, view, numbering, g);
    job.order = order;
    parallel_for(drawn_parts(scene.grooms[g]), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      Worker& worker = workers.local();
      std::uint64_t points = 0;
      for (std::size_t s = begin; s < end;) {
        s = assemble_strands(job, s, end, worker.block);
        raster_block(worker, layers, shared, out);
        points += worker.block.count;
      }
      segments.fetch_add(points, std::memory_order_relaxed);
      progress.add(end - begin);
    });
  }
  return segments;
}

}  // namespace

std::uint64_t raster_strands(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                             const RasterLayers& layers, GBuffer& out, const Progress& progress) {
  clear_gbuffer(view, layers, out);
  if (layers.coverage && layers.full)
    layers.full->parallel_for_each([&](int x, int y) {
      out.coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)] =
          kFullDepth;
    });
  const AnalyticCells cells = layers.analytic ? choose_cells(scene, view) : AnalyticCells();
  const bool in_cells = cells.per_pixel > 1;
  std::uint64_t strands = 0;
  for (const GroomInstance& groom : scene.grooms) strands += drawn_parts(groom);
  SharedProgress shared(progress, "raster", std::max<std::uint64_t>(1, in_cells ? 2 * strands : strands));
  RasterLayers in_pixels = layers;
  in_pixels.analytic = layers.analytic && !in_cells;
  const std::uint64_t segments = stream_strands(scene, view, numbering, in_pixels, out, shared);
  if (in_cells) {
    GBuffer fine = make_cells(cells, out);
    stream_strands(scene, cells.view, numbering, {.center = false, .analytic = true}, fine, shared);
    average_cells(cells, fine, out);
  }
  finish_gbuffer(layers, out);
  return segments;
}

}  // namespace pelage
