#include "light/opacity_map.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/light_lookup.h"
#include "light/light_view.h"
#include "light/strand_lines.h"

namespace pelage {
namespace {

constexpr std::size_t kStrandsPerTask = 64;
/// Spans longer than this many texels are split, so that maps see curves as curves.
constexpr float kTexelsPerSegment = 8;
constexpr int kMaxSegmentsPerSpan = 4;

/// A point of a strand on the map.
struct MapPoint {
  float x, y;      ///< texels
  float z;         ///< metres in front of the light
  float width;     ///< texels
  bool in_front;   ///< z is beyond the near plane
};

MapPoint project(const CameraView& view, Vec3 world, float width) {
  const MapPlace p = place_on_map(view, world);
  return {p.x, p.y, p.z, width * view.focal / (view.perspective && p.in_front ? p.z : 1.f), p.in_front};
}

/// Shortens [t0, t1] to where from + t·step lies in [0, limit]; false when nothing is left.
bool clip_axis(float from, float step, float limit, float& t0, float& t1) {
  if (step == 0) return from >= 0 && from <= limit;
  const float a = -from / step, b = (limit - from) / step;
  t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
  return t0 < t1;
}

/// Calls deposit(x, y, z, amount) for pieces of the segment a–b of at most `step` texels along the longer axis.
/// `amount` is the area of the piece, texels². A band wider than a texel is drawn as parallel lines.
template <class Deposit>
void for_each_piece(const MapPoint& a, const MapPoint& b, int width, int height, float step, const Deposit& deposit) {
  if (!a.in_front || !b.in_front) return;
  const float dx = b.x - a.x, dy = b.y - a.y, reach = std::sqrt(dx * dx + dy * dy);
  const float band = 0.5f * (a.width + b.width);
  if (!(reach > 0) || !(band > 0)) return;
  const int lines = std::clamp(static_cast<int>(std::ceil(band / step)), 1, std::max(width, height));
  for (int line = 0; line < lines; ++line) {
    const float side = band * ((static_cast<float>(line) + 0.5f) / static_cast<float>(lines) - 0.5f) / reach;
    const float x = a.x - dy * side, y = a.y + dx * side;
    float t0 = 0, t1 = 1;
    if (!clip_axis(x, dx, static_cast<float>(width), t0, t1) || !clip_axis(y, dy, static_cast<float>(height), t0, t1))
      continue;
    const float span = t1 - t0;
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::max(std::fabs(dx), std::fabs(dy)) * span / step)));
    const float amount = reach * span * band / (static_cast<float>(lines) * static_cast<float>(pieces));
    for (int i = 0; i < pieces; ++i) {
      const float t = t0 + span * (static_cast<float>(i) + 0.5f) / static_cast<float>(pieces);
      deposit(std::min(static_cast<int>(x + t * dx), width - 1), std::min(static_cast<int>(y + t * dy), height - 1),
              a.z + t * (b.z - a.z), amount);
    }
  }
}

/// Every stride-th strand of all grooms, in parallel, as projected points: body(points) once a strand.
template <class Body>
void for_each_strand(const std::vector<GroomInstance>& grooms, const CameraView& view, std::size_t stride,
                     const Body& body) {
  for (const GroomInstance& groom : grooms) {
    const Bounds box = groom_bounds({groom});
    if (box.empty()) continue;
    const float texel = std::max(texel_size(view, std::max(view.near_plane, to_camera(view, box.center()).z)), 1e-9f);
    const StrandLines lines(groom, std::clamp(static_cast<int>(std::ceil(mean_span_length(groom) / texel / kTexelsPerSegment)),
                                              1, kMaxSegmentsPerSpan));
    const std::size_t drawn = (lines.strand_count() + stride - 1) / stride;
    parallel_for(drawn, kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
      std::vector<Vec3> points;
      std::vector<float> widths;
      std::vector<MapPoint> projected;
      for (std::size_t s = begin; s < end; ++s) {
        points.clear(), widths.clear(), projected.clear();
        lines.append(s * stride, points, widths);
        for (std::size_t i = 0; i < points.size(); ++i) projected.push_back(project(view, points[i], widths[i]));
        body(projected);
      }
    });
  }
}

/// Lowers `value` to `depth`, both positive: their bits are ordered like the numbers.
void lower_to(std::uint32_t& value, float depth) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(depth);
  std::atomic_ref<std::uint32_t> shared(value);
  std::uint32_t seen = shared.load(std::memory_order_relaxed);
  while (bits < seen && !shared.compare_exchange_weak(seen, bits, std::memory_order_relaxed)) {}
}

void find_first_depths(const std::vector<GroomInstance>& grooms, std::size_t stride, OpacityMap& map) {
  const CameraView& view = map.view;
  const std::size_t row = origin_columns(view);
  const std::size_t rows = static_cast<std::size_t>((view.height + OpacityMap::kOriginBlock - 1) / OpacityMap::kOriginBlock);
  Buffer<std::uint32_t> bits(row * rows);
  bits.fill(std::bit_cast<std::uint32_t>(INFINITY));
  for_each_strand(grooms, view, stride, [&](const std::vector<MapPoint>& strand) {
    for (std::size_t i = 0; i + 1 < strand.size(); ++i)
      for_each_piece(strand[i], strand[i + 1], view.width, view.height, OpacityMap::kOriginBlock,
                     [&](int x, int y, float z, float) {
                       lower_to(bits[static_cast<std::size_t>(y / OpacityMap::kOriginBlock) * row +
                                     static_cast<std::size_t>(x / OpacityMap::kOriginBlock)], z);
                     });
  });
  map.first_depth.resize(bits.size());
  for (std::size_t i = 0; i < bits.size(); ++i) map.first_depth[i] = std::bit_cast<float>(bits[i]);
}

/// Ends of layers that double in depth; the last is the depth range of the strands.
void place_layers(const Bounds& box, OpacityMap& map) {
  float nearest = INFINITY, farthest = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z};
    const float z = to_camera(map.view, corner).z;
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  const float range = std::max(farthest - std::max(nearest, map.view.near_plane), 1e-6f);
  for (std::size_t i = 0; i < OpacityMap::kLayers; ++i)
    map.layer_end[i] = std::ldexp(range, static_cast<int>(i) + 1 - OpacityMap::kLayers);
}

void count_crossings(const std::vector<GroomInstance>& grooms, std::size_t stride, OpacityMap& map) {
  const CameraView& view = map.view;
  const std::size_t texels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const std::size_t row = origin_columns(view);
  map.crossings.resize(texels * OpacityMap::kLayers);
  parallel_for(map.crossings.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    std::fill(map.crossings.begin() + begin, map.crossings.begin() + end, 0u);
  });
  const float units = static_cast<float>(stride) / OpacityMap::kCrossingUnit;
  for_each_strand(grooms, view, stride, [&](const std::vector<MapPoint>& strand) {
    for (std::size_t i = 0; i + 1 < strand.size(); ++i)
      for_each_piece(strand[i], strand[i + 1], view.width, view.height, 1, [&](int x, int y, float z, float amount) {
        const std::size_t block = static_cast<std::size_t>(y / OpacityMap::kOriginBlock) * row + static_cast<std::size_t>(x / OpacityMap::kOriginBlock);
        const std::size_t texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
        const int layer = layer_of(map, z - map.first_depth[block]);
        std::atomic_ref(map.crossings[texel * OpacityMap::kLayers + static_cast<std::size_t>(layer)])
            .fetch_add(static_cast<std::uint32_t>(amount * units + 0.5f), std::memory_order_relaxed);
      });
  });
}

/// From strands inside each layer to strands up to its end.
void accumulate_layers(OpacityMap& map) {
  parallel_for(map.crossings.size() / OpacityMap::kLayers, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::uint32_t* layers = map.crossings.data() + t * OpacityMap::kLayers;
      for (int i = 1; i < OpacityMap::kLayers; ++i) layers[i] += layers[i - 1];
    }
  });
}

}  // namespace

OpacityMap build_opacity_map(const std::vector<GroomInstance>& grooms, const CameraView& view,
                             const OpacitySettings& settings) {
  PELAGE_CHECK(settings.strand_stride >= 1);
  OpacityMap map;
  const Bounds box = groom_bounds(grooms);
  if (box.empty()) return map;
  map.view = view;
  place_layers(box, map);
  find_first_depths(grooms, settings.strand_stride, map);
  count_crossings(grooms, settings.strand_stride, map);
  accumulate_layers(map);
  return map;
}

}  // namespace pelage
