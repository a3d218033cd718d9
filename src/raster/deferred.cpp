#include "raster/deferred.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "assemble/strand_block.h"
#include "core/bounds.h"
#include "core/check.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/camera_view.h"
#include "groom/hairmesh/prepared.h"
#include "groom/hairmesh/strand_group.h"
#include "raster/coverage.h"
#include "raster/fragments.h"
#include "raster/gbuffer.h"
#include "raster/tile_locks.h"

namespace pelage {
namespace {

constexpr std::size_t kGrain = 1 << 16;
constexpr std::size_t kGroupsPerTask = 8;

/// What one thread works with; reused from task to task.
struct Worker {
  StrandGroup group;
  ScreenBlock block;
  FragmentBuffer at_centers, touching;
  ScreenBlock runs;
  CoverageScratch coverage;
};

/// Sixteen strands of a bundle, or what is left of it.
struct GroupDraw {
  std::uint32_t bundle;  // of the selection
  std::uint32_t first;
};

std::vector<GroupDraw> groups_of(const LodSelection& selection) {
  std::vector<GroupDraw> groups;
  groups.reserve(selection.strands / StrandGroup::kLanes + selection.bundles.size());
  for (std::size_t b = 0; b < selection.bundles.size(); ++b)
    for (std::uint32_t s = 0; s < selection.bundles[b].strands; s += StrandGroup::kLanes)
      groups.push_back({static_cast<std::uint32_t>(b), s});
  return groups;
}

/// What raster reads of a bundle.
class Strands {
 public:
  Strands(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection, const CameraView& view)
      : grooms_(grooms), selection_(selection) {
    for (std::size_t g = 0; g < grooms.size(); ++g)
      jobs_.push_back(make_strand_block_job(scene, view, grooms[g], g, grooms.size()));
  }

  /// Makes and assembles one group. Returns its segments.
  std::size_t assemble(const GroupDraw& g, Worker& worker) const {
    const BundleDraw& draw = selection_.bundles[g.bundle];
    const BundleCage& cage = grooms_[draw.groom].mesh->cages[draw.bundle];
    const std::size_t count = std::min<std::size_t>(StrandGroup::kLanes, draw.strands - g.first);
    make_strands(cage, g.first, count, draw.points, worker.group);
    assemble_group(worker.group, jobs_[draw.groom], draw.width_scale, worker.block);
    return count * (draw.points - 1);
  }

 private:
  std::span<const DeferredGroom> grooms_;
  const LodSelection& selection_;
  std::vector<StrandBlockJob> jobs_;
};

/// The strands of `block` one after the other, as raster_coverage() takes them.
void lay_out_runs(const ScreenBlock& block, ScreenBlock& runs) {
  const std::size_t size = block.x.size(), points = block.count / block.stride;
  if (runs.x.size() < size) {
    for (Buffer<float>* b : {&runs.x, &runs.y, &runs.depth, &runs.radius, &runs.cap_x, &runs.cap_y})
      b->resize(size), b->fill(1.f);
    runs.id.resize(size), runs.id.fill(ScreenBlock::kNoSegment);
  }
  runs.count = 0, runs.stride = 1;
  for (std::size_t strand = 0; strand < block.stride; ++strand) {
    if (block.stride > 1 && block.id[strand] == ScreenBlock::kNoSegment) continue;  // a lane without a strand
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t from = i * block.stride + strand, to = runs.count++;
      runs.x[to] = block.x[from], runs.y[to] = block.y[from], runs.depth[to] = block.depth[from];
      runs.radius[to] = block.radius[from], runs.cap_x[to] = block.cap_x[from], runs.cap_y[to] = block.cap_y[from];
      runs.id[to] = block.id[from] == ScreenBlock::kNoSegment ? ScreenBlock::kNoSegment : static_cast<std::uint32_t>(to);
    }
  }
}

/// The layer of areas while it is drawn.
class CoverageLayer {
 public:
  /// Of the part of the picture in `out`; hair behind all opaque samples of a pixel is hidden.
  CoverageLayer(const DeferredBuffer& out, const CameraView& picture, const Buffer<float>& opaque, std::size_t opaque_samples)
      : tiles_(out.view.width, out.view.height) {
    const auto width = static_cast<std::size_t>(out.view.width), height = static_cast<std::size_t>(out.view.height);
    if (!opaque.empty()) area_.opaque_depth.resize(width * height);
    for (std::size_t y = 0; y < height && !opaque.empty(); ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t row = (y + static_cast<std::size_t>(out.top)) * static_cast<std::size_t>(picture.width);
        const float* depth = &opaque[(row + x + static_cast<std::size_t>(out.left)) * opaque_samples];
        area_.opaque_depth[y * width + x] = *std::max_element(depth, depth + opaque_samples);
      }
    clear_gbuffer(out.view, kLayers, area_);
  }
  void draw(const ScreenBlock& block, Worker& worker) {
    if (block.stride > 1) lay_out_runs(block, worker.runs);
    raster_coverage(block.stride > 1 ? worker.runs : block, worker.coverage, tiles_, area_);
  }
  Buffer<float> finish() {
    finish_gbuffer(kLayers, area_);
    Buffer<float> covered(area_.coverage.size());
    parallel_for(covered.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) covered[p] = analytic_coverage(area_, p);
    });
    return covered;
  }

 private:
  static constexpr RasterLayers kLayers{.center = false, .coverage = true};
  GBuffer area_;
  FullTiles tiles_;
};

/// Keys before any strand: nothing, or the opaque scene.
void clear(Buffer<PixelKey>& keys, std::size_t samples, const Buffer<float>& opaque, std::size_t opaque_samples,
           const CameraView& picture, const DeferredBuffer& out) {
  const auto width = static_cast<std::size_t>(out.view.width), height = static_cast<std::size_t>(out.view.height);
  keys.resize(width * height * samples);
  const auto key_of = [&](float depth) {
    if (!(depth < out.range.far_end)) return kEmptyPixel;
    const float level = kernel::raster_depth_level(depth, out.range.near_end, out.range.levels_per_metre());
    return static_cast<PixelKey>(level) << 40 | deferred::kPayload;
  };
  parallel_for(height, std::max<std::size_t>(1, kGrain / (width * samples + 1)), [&](std::size_t first, std::size_t last) {
    PixelKey* to = &keys[first * width * samples];
    if (opaque.empty()) return std::fill(to, to + (last - first) * width * samples, kEmptyPixel);
    for (std::size_t y = first; y < last; ++y) {
      const std::size_t row = (y + static_cast<std::size_t>(out.top)) * static_cast<std::size_t>(picture.width) +
                              static_cast<std::size_t>(out.left);
      const float* depth = &opaque[row * opaque_samples];
      for (std::size_t x = 0; x < width; ++x, depth += opaque_samples)
        if (samples == opaque_samples)
          for (std::size_t s = 0; s < samples; ++s) *to++ = key_of(depth[s]);
        else *to++ = key_of(*std::max_element(depth, depth + opaque_samples));
    }
  });
}

/// Makes pixels that no strand won empty again.
void finish(Buffer<PixelKey>& keys) {
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!deferred::is_strand(keys[i])) keys[i] = kEmptyPixel;
  });
}

}  // namespace

void place_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                    const CameraView& view, DeferredBuffer& out) {
  float nearest = INFINITY, farthest = 0, left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY;
  for (const BundleDraw& draw : selection.bundles) {
    const Affine to_camera = compose(view.world_to_camera, scene.grooms[grooms[draw.groom].groom].transform);
    for (const Vec3 corner : corners(grooms[draw.groom].mesh->boxes[draw.bundle])) {
      const Vec3 p = transform_point(to_camera, corner);
      nearest = std::min(nearest, p.z), farthest = std::max(farthest, p.z);
      const bool seen = p.z >= view.near_plane;
      const Vec2 at = seen ? project(view, p) : Vec2();
      left = std::min(left, seen ? at.x : 0), top = std::min(top, seen ? at.y : 0);
      right = std::max(right, seen ? at.x : static_cast<float>(view.width));
      bottom = std::max(bottom, seen ? at.y : static_cast<float>(view.height));
    }
  }
  constexpr float kMargin = 2;  // of widened strands; pixels
  const auto clamped = [](float x, int most) { return static_cast<int>(std::clamp(x, 0.f, static_cast<float>(most))); };
  const bool any = !selection.bundles.empty();
  out.left = any ? clamped(std::floor(left - kMargin), view.width) : 0;
  out.top = any ? clamped(std::floor(top - kMargin), view.height) : 0;
  out.view = view;
  out.view.width = any ? clamped(std::ceil(right + kMargin), view.width) - out.left : 0;
  out.view.height = any ? clamped(std::ceil(bottom + kMargin), view.height) - out.top : 0;
  out.view.center_x -= static_cast<float>(out.left), out.view.center_y -= static_cast<float>(out.top);
  nearest = std::max(nearest, view.near_plane);
  out.range = any ? DepthRange{nearest, std::max(farthest, nearest * 1.000001f + 1e-6f)} : DepthRange{};
}

std::uint64_t raster_hair_meshes(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                                 const CameraView& view, const DeferredLayers& layers, const Buffer<float>& opaque_depth,
                                 DeferredBuffer& out, const Progress& progress) {
  PELAGE_CHECK(layers.samples == 0 || layers.samples == 2 || layers.samples == 4 || layers.samples == 8);
  PELAGE_CHECK(layers.center || !layers.conservative);
  const int width = out.view.width, height = out.view.height;
  out.samples = std::max(1, layers.samples);
  const auto samples = static_cast<std::size_t>(out.samples);
  out.center.release(), out.conservative.release(), out.sample_keys.release(), out.coverage.release();
  if (layers.center) clear(out.center, 1, opaque_depth, samples, view, out);
  if (layers.conservative) clear(out.conservative, 1, opaque_depth, samples, view, out);
  if (layers.samples > 0) clear(out.sample_keys, samples, opaque_depth, samples, view, out);
  if (width == 0 || height == 0) return 0;

  const std::vector<GroupDraw> groups = groups_of(selection);
  const Strands strands(scene, grooms, selection, out.view);
  TileLocks locks(width, height);
  tbb::enumerable_thread_specific<Worker> workers;
  std::optional<CoverageLayer> coverage;
  if (layers.coverage) coverage.emplace(out, view, opaque_depth, samples);
  std::atomic<std::uint64_t> segments{0};
  SharedProgress shared(progress, "raster", std::max<std::size_t>(1, groups.size()));
  parallel_for(groups.size(), kGroupsPerTask, [&](std::size_t begin, std::size_t end) {
    Worker& w = workers.local();
    std::uint64_t drawn = 0;
    for (std::size_t i = begin; i < end; ++i) {
      drawn += strands.assemble(groups[i], w);
      if (layers.center)
        raster_deferred(w.block, out.range, width, height, w.at_centers, w.touching, out.center.data(),
                        layers.conservative ? out.conservative.data() : nullptr);
      if (layers.samples > 0)
        raster_deferred_samples(w.block, out.range, width, height, layers.samples, w.at_centers, locks, out.sample_keys.data());
      if (coverage) coverage->draw(w.block, w);
    }
    segments.fetch_add(drawn, std::memory_order_relaxed);
    shared.add(end - begin);
  });
  if (!opaque_depth.empty())
    for (Buffer<PixelKey>* keys : {&out.center, &out.conservative, &out.sample_keys}) finish(*keys);
  if (coverage) out.coverage = coverage->finish();
  return segments;
}

}  // namespace pelage
