#include "light/opacity_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/bounds.h"
#include "core/check.h"
#include "core/parallel.h"
#include "frame/light_lookup.h"
#include "light/light_view.h"
#include "light/sheets.h"

namespace pelage {
namespace {

constexpr std::size_t kStrandsPerTask = 256;
/// Spans longer than this many texels are split, so that maps see curves as curves.
constexpr float kTexelsPerSegment = 8;
/// Threads have sheets of their own where those of level 0 take no more bytes in all; coarser levels take a third of that at most.
constexpr std::size_t kMaxSheetBytes = std::size_t{256} << 20;
/// Crossings beyond this (262,144 strands) saturate: signed conversion is what every instruction set has.
constexpr std::uint32_t kMaxUnits = 0x7fffffff;

/// As many as the view needs that sees the strands largest.
int segments_per_span(const StrandLines& lines, std::span<const CameraView> views) {
  float texels = 0;
  for (const CameraView& view : views) {
    const float z = std::max(view.near_plane, to_camera(view, lines.bounds().center()).z);
    texels = std::max(texels, lines.mean_span() / std::max(texel_size(view, z), 1e-9f));
  }
  return std::clamp(static_cast<int>(std::ceil(std::min(texels, 1e6f) / kTexelsPerSegment)), 1, StrandLines::kMaxSegments);
}

/// The strands of a groom that are drawn.
struct Picked {
  const StrandLines* lines;
  int segments_per_span;
  std::vector<StrandPart> strands;
};

/// Calls body(block) for all strands of all grooms, a few thousand points at a time, in parallel.
template <class Body>
void for_each_block(const std::vector<Picked>& grooms, const Body& body) {
  for (const Picked& groom : grooms) {
    parallel_for(groom.strands.size(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      thread_local LineBlock block;
      for (std::size_t s = begin; s < end;) {
        s = groom.lines->fill(groom.strands, s, end, groom.segments_per_span, block);
        body(block);
      }
    });
  }
}

/// Ends of layers that double in depth; the last is the depth range of the strands.
void place_layers(const Bounds& box, OpacityMap& map) {
  float nearest = INFINITY, farthest = 0;
  for (const Vec3 corner : corners(box)) {
    const float z = to_camera(map.view, corner).z;
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  const float range = std::max(farthest - std::max(nearest, map.view.near_plane), 1e-6f);
  for (std::size_t i = 0; i < OpacityMap::kLayers; ++i)
    map.layer_end[i] = std::ldexp(range, static_cast<int>(i) + 1 - OpacityMap::kLayers);
}

/// From strands inside each layer to strands up to its end.
void accumulate_layers(OpacityMap& map) {
  parallel_for(map.crossings.size() / OpacityMap::kLayers, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::uint32_t* layers = map.crossings.data() + t * OpacityMap::kLayers;
      std::uint32_t any = 0;
      for (int i = 0; i < OpacityMap::kLayers; ++i) any |= layers[i];
      if (any == 0) continue;  // most of the map sees no strand
      std::uint64_t sum = 0;
      for (int i = 0; i < OpacityMap::kLayers; ++i) {
        sum += layers[i];
        layers[i] = static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, kMaxUnits));
      }
    }
  });
}

/// A map while it is drawn.
struct Drawing {
  OpacityMap map;
  Buffer<std::uint32_t> depth_bits;
  SplatTarget target;  // but for its levels' crossings, which are …
  std::vector<Sheets> sheets;

  /// What the calling thread draws into.
  SplatTarget mine() {
    SplatTarget t = target;
    for (std::size_t k = 0; k < sheets.size(); ++k) t.levels[k].crossings = sheets[k].mine();
    return t;
  }
};

std::size_t texels(const SplatLevel& level) {
  return static_cast<std::size_t>(level.columns) * static_cast<std::size_t>(level.rows);
}

/// Texels of the widest band of all.
float widest_band(const std::vector<StrandLines>& grooms, const CameraView& view) {
  float widest = 0;
  for (const StrandLines& lines : grooms) {
    if (lines.bounds().empty()) continue;
    float nearest = INFINITY;
    for (const Vec3 corner : corners(lines.reach())) nearest = std::min(nearest, to_camera(view, corner).z);
    widest = std::max(widest, lines.widest_band() / texel_size(view, std::max(nearest, view.near_plane)));
  }
  return widest;
}

/// Levels 0 … of which the last is the coarsest that a band of `widest` texels is drawn into.
void begin_levels(float widest, Drawing& d) {
  SplatTarget& target = d.target;
  const auto width = static_cast<float>(d.map.view.width), height = static_cast<float>(d.map.view.height);
  target.level_count = 0;
  for (float scale = 1; target.level_count < SplatTarget::kMaxLevels && (scale == 1 || widest * scale >= kBandTexels);
       scale *= 0.5f) {
    const auto k = static_cast<std::size_t>(target.level_count++);
    SplatLevel& level = target.levels[k];
    level.scale = scale, level.width = width * scale, level.height = height * scale;
    level.columns = static_cast<std::int32_t>(std::ceil(level.width)),
    level.rows = static_cast<std::int32_t>(std::ceil(level.height));
    d.sheets.emplace_back(texels(level) * OpacityMap::kLayers, !target.shared);
  }
}

/// What level k + 1 has is what each of its four texels of level k has: expectations know no area.
void add_coarser(const SplatLevel& coarse, const std::uint32_t* coarse_crossings, const SplatLevel& fine,
                 std::uint32_t* crossings) {
  parallel_for(static_cast<std::size_t>(fine.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::uint32_t* from = coarse_crossings + row / 2 * static_cast<std::size_t>(coarse.columns) * OpacityMap::kLayers;
      std::uint32_t* to = crossings + row * static_cast<std::size_t>(fine.columns) * OpacityMap::kLayers;
      for (std::size_t column = 0; column < static_cast<std::size_t>(fine.columns); ++column)
        for (std::size_t i = 0; i < OpacityMap::kLayers; ++i)
          to[column * OpacityMap::kLayers + i] += from[column / 2 * OpacityMap::kLayers + i];
    }
  });
}

Drawing begin_drawing(const CameraView& view, const Bounds& box, float widest, std::size_t strand_stride, bool shared) {
  Drawing d;
  d.map.view = view;
  place_layers(box, d.map);
  const std::size_t columns = origin_columns(view);
  const std::size_t rows = static_cast<std::size_t>((view.height + OpacityMap::kOriginBlock - 1) / OpacityMap::kOriginBlock);
  d.depth_bits.resize(columns * rows);
  fill_parallel(d.depth_bits.data(), d.depth_bits.size(), std::bit_cast<std::uint32_t>(INFINITY));
  d.target.shared = shared;
  begin_levels(widest, d);
  d.target.view = view, d.target.layer_end = d.map.layer_end;
  d.target.origin_columns = static_cast<std::int32_t>(columns);
  d.target.first_depth = d.depth_bits.data();
  d.target.units = static_cast<float>(strand_stride) / OpacityMap::kCrossingUnit;
  return d;
}

OpacityMap end_drawing(Drawing d) {
  auto k = static_cast<std::size_t>(d.target.level_count) - 1;
  for (d.map.crossings = d.sheets[k].sum(); k > 0; --k) {
    Buffer<std::uint32_t> finer = d.sheets[k - 1].sum();
    add_coarser(d.target.levels[k], d.map.crossings.data(), d.target.levels[k - 1], finer.data());
    d.map.crossings.swap(finer);
  }
  accumulate_layers(d.map);
  d.map.first_depth.resize(d.depth_bits.size());
  for (std::size_t i = 0; i < d.depth_bits.size(); ++i) d.map.first_depth[i] = std::bit_cast<float>(d.depth_bits[i]);
  return std::move(d.map);
}

/// Whether sheets of all threads would take too much memory.
bool share_sheets(std::span<const CameraView> views) {
  std::size_t bytes = 0;
  for (const CameraView& view : views)
    bytes += sizeof(std::uint32_t) * OpacityMap::kLayers * static_cast<std::size_t>(view.width) *
             static_cast<std::size_t>(view.height);
  return bytes * static_cast<std::size_t>(arena().max_concurrency()) > kMaxSheetBytes;
}

}  // namespace

std::vector<OpacityMap> build_opacity_maps(const std::vector<StrandLines>& grooms, std::span<const CameraView> views,
                                           const OpacitySettings& settings) {
  PELAGE_CHECK(settings.strand_stride >= 1);
  const Bounds box = bounds(grooms);
  if (box.empty()) return std::vector<OpacityMap>(views.size());
  const bool shared = share_sheets(views);
  std::vector<Drawing> drawings;
  for (const CameraView& view : views)
    drawings.push_back(begin_drawing(view, box, widest_band(grooms, view), settings.strand_stride, shared));
  std::vector<Picked> picked;
  for (const StrandLines& lines : grooms)
    if (!views.empty() && !lines.bounds().empty())
      picked.push_back({&lines, segments_per_span(lines, views), lines.pick(settings.strand_stride, views.front())});
  // Strands become lines once for all views; the lines stay in the cache.
  for_each_block(picked, [&](const LineBlock& block) {
    for (const Drawing& d : drawings) splat_depths(block, d.target);
  });
  for_each_block(picked, [&](const LineBlock& block) {
    for (Drawing& d : drawings) splat_crossings(block, d.mine());
  });
  std::vector<OpacityMap> maps;
  for (Drawing& d : drawings) maps.push_back(end_drawing(std::move(d)));
  return maps;
}

OpacityMap build_opacity_map(const std::vector<StrandLines>& grooms, const CameraView& view, const OpacitySettings& settings) {
  return std::move(build_opacity_maps(grooms, {&view, 1}, settings).front());
}

}  // namespace pelage
