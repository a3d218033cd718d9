#include "raster/deferred.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
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
#include "raster/depth_tiles.h"
#include "raster/fragments.h"
#include "raster/gbuffer.h"
#include "raster/tile_locks.h"

namespace pelage {
namespace {

constexpr std::size_t kGrain = 1 << 16;
constexpr std::size_t kGroupsPerTask = 8;
/// Parts that strands of several grooms are drawn in, nearest first; what those before hide is left out. One groom hardly hides
/// bundles of its own.
constexpr std::size_t kParts = 8;

/// What one thread works with; reused from task to task.
struct Worker {
  StrandGroup group;
  StrandBlock block;
  FragmentBuffer fragments;
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
void clear_keys(Buffer<PixelKey>& keys, std::size_t samples, const Buffer<float>& opaque, std::size_t opaque_samples,
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

/// DeferredBuffer::opaque, from keys that are not finished yet.
Buffer<float> opaque_shares(const Buffer<PixelKey>& keys) {
  constexpr float kNone = 2;
  Buffer<float> shares(keys.size());
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool none = deferred::is_strand(keys[i]) || keys[i] == kEmptyPixel;
      shares[i] = none ? kNone : static_cast<float>(deferred::depth_level(keys[i])) * (1 / kernel::kRasterDepthLevels);
    }
  });
  return shares;
}

/// Makes pixels that no strand won empty again.
void finish_keys(Buffer<PixelKey>& keys) {
  parallel_for(keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!deferred::is_strand(keys[i])) keys[i] = kEmptyPixel;
  });
}

/// The layers of one view while strands are drawn into them.
class TargetLayers {
 public:
  /// Clears them.
  TargetLayers(const Scene& scene, std::span<const DeferredGroom> grooms, const DeferredTarget& target,
               const DeferredLayers& layers)
      : target_(target), out_(target.out), layers_(layers), tiles_(out_.view.width, out_.view.height),
        locks_(std::max(1, out_.view.width), std::max(1, out_.view.height)) {
    for (const DeferredGroom& groom : grooms) jobs_.push_back(make_project_job(out_.view, scene.grooms[groom.groom]));
    out_.samples = std::max(1, layers.samples);
    out_.center.release(), out_.conservative.release(), out_.sample_keys.release(), out_.coverage.release();
    out_.opaque.release();
    if (layers.center) clear(out_.center, 1);
    if (layers.conservative) clear(out_.conservative, 1);
    if (layers.samples > 0) clear(out_.sample_keys, static_cast<std::size_t>(out_.samples));
    if (layers.coverage && !empty())
      coverage_.emplace(out_, target.view, target.opaque_depth, static_cast<std::size_t>(out_.samples));
  }

  /// Whether something hides strands before any is drawn.
  bool starts_opaque() const { return !target_.opaque_depth.empty(); }

  /// Strands that lie behind all that is drawn by now are hidden from now on. Nobody may draw meanwhile.
  void update_hidden() {
    if (coverage_ || empty()) return;  // area counts wherever it is
    if (layers_.center) tiles_.update(out_.center, 1);
    else if (layers_.samples > 0) tiles_.update(out_.sample_keys, static_cast<std::size_t>(out_.samples));
  }

  /// Whether the strands of a bundle change no key. Where the center layer hides them, so do the others: the conservative
  /// layer is nowhere farther.
  bool hides(const BundleDraw& bundle, const PreparedHairMesh& mesh) const {
    if (layers_.center && layers_.samples > 0) return false;
    const ProjectJob& job = jobs_[bundle.groom];
    Vec2 low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
    float nearest = INFINITY;
    for (const Vec3 corner : corners(mesh.boxes[bundle.bundle])) {
      const Vec3 p = transform_point(job.to_camera, corner);
      if (!(p.z >= job.view.near_plane)) return false;
      const Vec2 at = project(job.view, p);
      low = {std::min(low.x, at.x), std::min(low.y, at.y)}, high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      nearest = std::min(nearest, p.z);
    }
    nearest *= 1 - 1e-5f;  // for roundings
    const float width = mesh.mesh->width * job.width_scale * bundle.width_scale * pixels_per_metre(job.view, nearest);
    // From its line a band reaches 1.5 radii (kRasterMiterLimit) past its ends and √2 radii aside, and pixels are touched beside it.
    const float reach = 1 + 1.5f * width;
    const float level = kernel::raster_depth_level(nearest, out_.range.near_end, out_.range.levels_per_metre());
    return tiles_.hides({low.x - reach, low.y - reach}, {high.x + reach, high.y + reach}, static_cast<std::uint32_t>(level));
  }

  /// The strands of `w.group`, packed into `w.block`.
  void draw(const BundleDraw& bundle, Worker& w) {
    if (empty()) return;
    const ScreenBlock& block = project_group(w.group, jobs_[bundle.groom], bundle.width_scale, w.block);
    const int width = out_.view.width, height = out_.view.height;
    if (layers_.center)
      raster_deferred(block, out_.range, width, height, w.fragments, out_.center.data(),
                      layers_.conservative ? out_.conservative.data() : nullptr);
    if (layers_.samples > 0)
      raster_deferred_samples(block, out_.range, width, height, layers_.samples, w.fragments, locks_, out_.sample_keys.data());
    if (coverage_) coverage_->draw(block, w);
  }

  /// Makes pixels that no strand won empty again.
  void finish() {
    const bool opaque = !target_.opaque_depth.empty();
    if (opaque && layers_.conservative) out_.opaque = opaque_shares(out_.center);
    if (opaque)
      for (Buffer<PixelKey>* keys : {&out_.center, &out_.conservative, &out_.sample_keys}) finish_keys(*keys);
    if (coverage_) out_.coverage = coverage_->finish();
  }

 private:
  bool empty() const { return out_.view.width == 0 || out_.view.height == 0; }
  void clear(Buffer<PixelKey>& keys, std::size_t samples) const {
    clear_keys(keys, samples, target_.opaque_depth, static_cast<std::size_t>(out_.samples), target_.view, out_);
  }

  DeferredTarget target_;
  DeferredBuffer& out_;
  DeferredLayers layers_;
  std::vector<ProjectJob> jobs_;  // by groom
  DepthTiles tiles_;
  TileLocks locks_;
  std::optional<CoverageLayer> coverage_;
};

/// The views that may see a bundle, a bit each.
std::uint32_t seen_by(const std::deque<TargetLayers>& views, const BundleDraw& bundle, const PreparedHairMesh& mesh) {
  std::uint32_t seen = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    if ((bundle.views >> v & 1) && !views[v].hides(bundle, mesh)) seen |= 1u << v;
  return seen;
}

}  // namespace

void place_deferred(const Scene& scene, std::span<const DeferredGroom> grooms, const LodSelection& selection,
                    std::size_t number, const CameraView& view, DeferredBuffer& out) {
  bool any = false;
  float nearest = INFINITY, farthest = 0, left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY;
  for (const BundleDraw& draw : selection.bundles) {
    if (!(draw.views >> number & 1)) continue;
    any = true;
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
                                 std::span<const DeferredTarget> targets, const DeferredLayers& layers,
                                 const Progress& progress) {
  PELAGE_CHECK(layers.samples == 0 || layers.samples == 2 || layers.samples == 4 || layers.samples == 8);
  PELAGE_CHECK(layers.center || !layers.conservative);
  PELAGE_CHECK(!targets.empty() && targets.size() <= kMostViews);
  std::vector<PayloadJob> payloads;
  for (std::size_t g = 0; g < grooms.size(); ++g)
    payloads.push_back({scene.grooms[grooms[g].groom].transform, uv_cells(g, grooms.size())});
  std::deque<TargetLayers> views;
  for (const DeferredTarget& target : targets) views.emplace_back(scene, grooms, target, layers);

  const std::vector<GroupDraw> groups = groups_of(selection);
  tbb::enumerable_thread_specific<Worker> workers;
  std::atomic<std::uint64_t> segments{0};
  SharedProgress shared(progress, "raster", std::max<std::size_t>(1, groups.size()));
  const std::size_t parts = grooms.size() > 1 ? kParts : 1;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t first = groups.size() * part / parts, last = groups.size() * (part + 1) / parts;
    for (TargetLayers& view : views)
      if (part > 0 || view.starts_opaque()) view.update_hidden();
    parallel_for(last - first, kGroupsPerTask, [&](std::size_t begin, std::size_t end) {
      Worker& w = workers.local();
      std::uint64_t made = 0;
      std::uint32_t seen = 0;  // bit v: by view v, of the bundle before
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const BundleDraw& draw = selection.bundles[groups[i].bundle];
        const PreparedHairMesh& mesh = *grooms[draw.groom].mesh;
        if (i == first + begin || groups[i].bundle != groups[i - 1].bundle) seen = seen_by(views, draw, mesh);
        if (seen == 0) continue;
        const std::size_t strands = std::min<std::size_t>(StrandGroup::kLanes, draw.strands - groups[i].first);
        make_strands(mesh.cages[draw.bundle], groups[i].first, strands, draw.points, w.group);
        pack_group(w.group, payloads[draw.groom], w.block);
        for (std::size_t v = 0; v < views.size(); ++v)
          if (seen >> v & 1) views[v].draw(draw, w);
        made += strands * (draw.points - 1);
      }
      segments.fetch_add(made, std::memory_order_relaxed);
      shared.add(end - begin);
    });
  }
  for (TargetLayers& view : views) view.finish();
  return segments;
}

}  // namespace pelage
