#include "light/splat.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "light/splat.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <atomic>
#include <bit>
#include <cmath>

#include "kernel/wide-inl.h"
#include "kernel/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
namespace {

constexpr std::size_t kMaxLanes = 16;

/// Ends of one segment per lane on the map.
struct Segments {
  Float x, y, z, dx, dy, dz;  ///< texels, texels, metres: start and way to the end
  Float band;                 ///< texels, width
  Float density;
  Mask valid;
};

struct Projected {
  Float x, y, z, scale;
};

HWY_INLINE Projected project(const CameraView& view, const LineBlock& lines, std::size_t j) {
  const Float px = load(lines.x.data() + j), py = load(lines.y.data() + j), pz = load(lines.z.data() + j);
  const auto row = [&](int i) {
    const float* m = view.world_to_camera.m[i];
    return px * Float(m[0]) + py * Float(m[1]) + pz * Float(m[2]) + Float(m[3]);
  };
  Projected p;
  const Float cx = row(0), cy = row(1);
  p.z = row(2);
  p.scale = view.perspective ? Float(view.focal) / max(p.z, Float(view.near_plane)) : Float(view.focal);
  p.x = Float(view.center_x) + p.scale * cx, p.y = Float(view.center_y) + p.scale * cy;
  return p;
}

HWY_INLINE Segments segments_at(const CameraView& view, const LineBlock& lines, std::size_t j) {
  const Projected a = project(view, lines, j), b = project(view, lines, j + 1);
  const Float width = load(lines.width.data() + j);
  Segments s;
  s.x = a.x, s.y = a.y, s.z = a.z;
  s.dx = b.x - a.x, s.dy = b.y - a.y, s.dz = b.z - a.z;
  s.band = width * Float(0.5f) * (a.scale + b.scale);
  const Float near(view.near_plane);
  s.density = load(lines.density.data() + j);
  s.valid = (width > Float(0.0f)) && (a.z >= near) && (b.z >= near) && ((s.dx * s.dx + s.dy * s.dy) > Float(0.0f));
  return s;
}

/// Shortens [t0, t1] to where from + t·way lies in [0, limit].
HWY_INLINE void clip_axis(Float from, Float way, float limit, Float& t0, Float& t1) {
  const Mask moves = abs(way) > Float(1.0e-12f);
  const Float inverse = Float(1.0f) / select(moves, way, Float(1.0f));
  const Float a = -from * inverse, b = (Float(limit) - from) * inverse;
  const Mask beside = (from < Float(0.0f)) || (from > Float(limit));
  t0 = max(t0, select(moves, min(a, b), select(beside, Float(2.0f), Float(0.0f))));
  t1 = min(t1, select(moves, max(a, b), Float(1.0f)));
}

/// Largest lane of v where m, at least 0.
HWY_INLINE int largest(Mask m, Float v) {
  return static_cast<int>(hn::GetLane(hn::MaxOfLanes(FloatTag(), select(m, v, Float(0.0f)).v)));
}
HWY_INLINE Float ceiling(Float v) { return -floor(-v); }

/// Calls body(segments) for all that the map can see, a segment per lane.
template <class Body>
HWY_INLINE void for_each_segments(const CameraView& view, const LineBlock& lines, const Body& body) {
  for (std::size_t j = 0; j < lines.count; j += static_cast<std::size_t>(lanes())) {
    const Segments s = segments_at(view, lines, j);
    if (any(s.valid)) body(s);
  }
}

/// The same segments on a map of `scale` as many texels a side.
HWY_INLINE Segments scaled(const Segments& s, float scale) {
  const Float f(scale);
  return {s.x * f, s.y * f, s.z, s.dx * f, s.dy * f, s.dz, s.band * f, s.density, s.valid};
}

/// Calls body(active, column, row, depth, crossings) for pieces of at most `step` texels on a map of w × h; crossings summed over
/// rays, a texel has 1.
template <class Body>
HWY_INLINE void for_each_piece(const Segments& s, float w, float h, float step, const Body& body) {
  const Float per_step(1 / step);
  const Float last_column(std::ceil(w) - 1), last_row(std::ceil(h) - 1);
  const Float reach = sqrt(s.dx * s.dx + s.dy * s.dy);
  const Float parallel = v_clamp(ceiling(s.band * per_step), Float(1.0f), Float(std::max(1.f, std::max(w, h))));
  const int most_parallel = largest(s.valid, parallel);
  for (int line = 0; line < most_parallel; ++line) {
    const Float side =
        s.band * ((Float(static_cast<float>(line) + 0.5f)) / parallel - Float(0.5f)) / max(reach, Float(1.0e-20f));
    const Float x = s.x - s.dy * side, y = s.y + s.dx * side;
    Float t0(0.0f), t1(1.0f);
    clip_axis(x, s.dx, w, t0, t1), clip_axis(y, s.dy, h, t0, t1);
    const Mask drawn = s.valid && (t0 < t1) && (Float(static_cast<float>(line)) < parallel);
    const Float span = t1 - t0;
    const Float pieces = max(ceiling(max(abs(s.dx), abs(s.dy)) * span * per_step), Float(1.0f));
    const Float stride = span / pieces, area = reach * stride * s.band * s.density / parallel;
    const int most_pieces = largest(drawn, pieces);
    for (int i = 0; i < most_pieces; ++i) {
      const Mask active = drawn && (Float(static_cast<float>(i)) < pieces);
      const Float t = t0 + stride * Float(static_cast<float>(i) + 0.5f);
      body(active, v_clamp(floor(x + t * s.dx), Float(0.0f), last_column), v_clamp(floor(y + t * s.dy), Float(0.0f), last_row),
           s.z + t * s.dz, area);
    }
  }
}

/// Those segments that are drawn into level k.
HWY_INLINE Mask in_level(const SplatTarget& target, const Segments& s, int k) {
  Mask in = s.valid;
  if (k > 0) in = in && (s.band * Float(target.levels[static_cast<std::size_t>(k)].scale) >= Float(kBandTexels));
  if (k + 1 < target.level_count)
    in = in && (s.band * Float(target.levels[static_cast<std::size_t>(k) + 1].scale) < Float(kBandTexels));
  return in;
}

/// Of the texel that begins at (x, y) of level 0, in whole texels.
HWY_INLINE Int origin_index(const SplatTarget& target, Float x, Float y) {
  const Float per_block(1.f / OpacityMap::kOriginBlock);
  return to_int(floor(y * per_block)) * Int(target.origin_columns) + to_int(floor(x * per_block));
}

/// Bits of the lanes that are set, lane 0 lowest.
HWY_INLINE std::uint64_t lane_bits(Mask m) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(FloatTag(), m.m, bytes);
  return bytes[0] | static_cast<std::uint64_t>(bytes[1]) << 8;
}

void lower_to(std::uint32_t& value, std::uint32_t bits) {
  std::atomic_ref<std::uint32_t> shared(value);
  std::uint32_t seen = shared.load(std::memory_order_relaxed);
  while (bits < seen && !shared.compare_exchange_weak(seen, bits, std::memory_order_relaxed)) {
  }
}

HWY_INLINE void lower_depths(const SplatTarget& target, Mask active, Float column, Float row, Float z) {
  const Int at = origin_index(target, column, row);
  const Float seen(hn::BitCast(FloatTag(), gather_shared(target.first_depth, at).v));
  std::uint64_t bits = lane_bits(active && (z < seen));
  if (bits == 0) return;
  alignas(64) std::int32_t index[kMaxLanes];
  alignas(64) float depth[kMaxLanes];
  store(at, index), store(z, depth);
  for (; bits != 0; bits &= bits - 1) {
    const int lane = std::countr_zero(bits);
    lower_to(target.first_depth[index[lane]], std::bit_cast<std::uint32_t>(depth[lane]));
  }
}

HWY_INLINE void add_crossings(const SplatTarget& target, const SplatLevel& level, Mask active, Float column, Float row, Float z,
                              Float area) {
  const Float texels(1 / level.scale);
  const Int origin = origin_index(target, column * texels, row * texels);
  const Float d = z - Float(hn::BitCast(FloatTag(), gather(target.first_depth, origin).v));
  Float layer(0.0f);
  for (std::size_t i = 0; i + 1 < OpacityMap::kLayers; ++i)
    layer = layer + select(d > Float(target.layer_end[i]), Float(1.0f), Float(0.0f));
  const Int texel = to_int(row) * Int(level.columns) + to_int(column);
  alignas(64) std::int32_t index[kMaxLanes], amount[kMaxLanes];
  store(texel * Int(OpacityMap::kLayers) + to_int(layer), index);
  store(to_int(area * Float(target.units) + Float(0.5f)), amount);
  const auto for_each_active = [&](const auto& add) {
    for (std::uint64_t bits = lane_bits(active); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      add(level.crossings[index[lane]], static_cast<std::uint32_t>(amount[lane]));
    }
  };
  if (target.shared)
    for_each_active([](std::uint32_t& to, std::uint32_t n) { std::atomic_ref(to).fetch_add(n, std::memory_order_relaxed); });
  else for_each_active([](std::uint32_t& to, std::uint32_t n) { to += n; });
}

}  // namespace
}  // namespace wide

void SplatDepths(const LineBlock& lines, const SplatTarget& target) {
  using namespace wide;
  const SplatLevel& map = target.levels[0];
  for_each_segments(target.view, lines, [&](const Segments& s) {
    for_each_piece(s, map.width, map.height, OpacityMap::kOriginBlock,
                   [&](Mask active, Float column, Float row, Float z, Float) { lower_depths(target, active, column, row, z); });
  });
}

void SplatCrossings(const LineBlock& lines, const SplatTarget& target) {
  using namespace wide;
  for_each_segments(target.view, lines, [&](const Segments& s) {
    for (int k = 0; k < target.level_count; ++k) {
      const SplatLevel& level = target.levels[static_cast<std::size_t>(k)];
      Segments here = scaled(s, level.scale);
      here.valid = in_level(target, s, k);
      if (!any(here.valid)) continue;
      for_each_piece(here, level.width, level.height, 1, [&](Mask active, Float column, Float row, Float z, Float area) {
        add_crossings(target, level, active, column, row, z, area);
      });
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {
HWY_EXPORT(SplatDepths);
HWY_EXPORT(SplatCrossings);
void splat_depths(const LineBlock& lines, const SplatTarget& target) { HWY_DYNAMIC_DISPATCH(SplatDepths)(lines, target); }
void splat_crossings(const LineBlock& lines, const SplatTarget& target) { HWY_DYNAMIC_DISPATCH(SplatCrossings)(lines, target); }
}  // namespace pelage
#endif
