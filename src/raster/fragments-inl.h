// What fragments become in a layer of keys, and the depth test on their way there. Included once per instruction set.
#if defined(PELAGE_FRAGMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGE_FRAGMENTS_INL_H_
#undef PELAGE_FRAGMENTS_INL_H_
#else
#define PELAGE_FRAGMENTS_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "frame/deferred.h"
#include "kernel/wide-inl.h"
#include "raster/compress-inl.h"
#include "raster/fragments.h"
#include "raster/keys.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {

/// Keys of strands that are kept: PixelKey of frame/frame.h.
struct SegmentKeys {
  HWY_INLINE hn::Vec<wide::UintTag> rank(wide::Float depth) const { return hn::BitCast(kUint, depth.v); }
  /// s: how far along the major axis from where the segment starts.
  HWY_INLINE hn::Vec<wide::UintTag> id(const SegmentLanes& w, wide::Float) const { return w.id; }
  HWY_INLINE PixelKey key(std::uint32_t rank, std::uint32_t id) const { return static_cast<PixelKey>(rank) << 32 | id; }
};

/// In the id of a fragment of a strand that is gone after this: it covers its pixel's center.
inline constexpr std::uint32_t kCoversCenter = 1u << 31;

/// Keys of strands that are gone after this: DeferredBuffer of frame/deferred.h. Payload is that of the nearer end.
struct DeferredKeys {
  float near_end, levels_per_metre;
  std::uint32_t stride;
  const std::uint32_t *payload_high, *payload_low;
  HWY_INLINE hn::Vec<wide::UintTag> rank(wide::Float depth) const {
    const wide::Float level = wide::raster_depth_level(depth, wide::Float(near_end), wide::Float(levels_per_metre));
    return hn::ShiftLeft<8>(hn::BitCast(kUint, hn::ConvertTo(kInt, level.v)));
  }
  HWY_INLINE hn::Vec<wide::UintTag> id(const SegmentLanes& w, wide::Float s) const {
    const wide::Float du = w.band.end_u - w.band.u;
    const wide::Mask second = select(du < wide::Float(0.0f), -s, s) > abs(du) * wide::Float(0.5f);
    return hn::IfThenElse(hn::RebindMask(kUint, second.m), hn::Add(w.id, hn::Set(kUint, stride)), w.id);
  }
  HWY_INLINE PixelKey key(std::uint32_t rank, std::uint32_t id) const {
    const std::uint32_t point = id & ~kCoversCenter;
    return static_cast<PixelKey>(rank | payload_high[point]) << 32 | payload_low[point];
  }
};

HWY_INLINE DeferredKeys deferred_keys(const ScreenBlock& block, const DepthRange& range) {
  return {range.near_end, range.levels_per_metre(), static_cast<std::uint32_t>(block.stride), block.payload_high.data(),
          block.payload_low.data()};
}

/// Bit l of the result tells whether fragment l may pass the depth test of its key as it is now.
HWY_INLINE std::uint64_t passing(const std::uint32_t* pixel, const std::uint32_t* rank, const PixelKey* keys) {
  std::uint64_t bits = 0;
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  for (std::size_t l = 0; l < hn::Lanes(kUint); ++l) {
    const PixelKey now = __atomic_load_n(keys + pixel[l], __ATOMIC_RELAXED);
    bits |= std::uint64_t{now >= static_cast<PixelKey>(rank[l]) << 32} << l;
  }
#else
  // Keys may change under the gather. A stale half is larger than the present one, and only lets more through.
  const auto index = hn::BitCast(kInt, hn::Add(hn::ShiftLeft<1>(hn::LoadU(kUint, pixel)), hn::Set(kUint, 1)));
  const auto current = hn::GatherIndex(kUint, reinterpret_cast<const std::uint32_t*>(keys), index);
  const auto behind = hn::Lt(current, hn::LoadU(kUint, rank));
  hn::StoreMaskBits(kUint, hn::Not(behind), reinterpret_cast<std::uint8_t*>(&bits));
#endif
  return bits;
}

/// Of the vector of fragments from i on, those that are in the buffer, as bits.
HWY_INLINE std::uint64_t used_lanes(const FragmentBuffer& f, std::size_t i) {
  return f.count - i < hn::Lanes(kUint) ? (std::uint64_t{1} << (f.count - i)) - 1 : ~std::uint64_t{0};
}

/// Atomic minimum of the fragments from i on that `bits` name.
template <class Keys>
HWY_INLINE void enter_lanes(const Keys& make, const FragmentBuffer& f, std::size_t i, std::uint64_t bits, PixelKey* keys) {
  for (; bits != 0; bits &= bits - 1) {
    const std::size_t l = i + static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    atomic_min(keys[f.pixel[l]], make.key(f.rank[l], f.id[l]));
  }
}

/// enter(i) for each vector of fragments; prefetch(i) for each fragment long before. Empties the buffer.
template <class Prefetch, class Enter>
HWY_INLINE void flush(FragmentBuffer& f, const Prefetch& prefetch, const Enter& enter) {
  const std::size_t lanes = hn::Lanes(kUint), count = f.count, ahead = FragmentBuffer::kPadding - lanes;
  std::fill(&f.pixel[count], &f.pixel[count] + FragmentBuffer::kPadding, 0u);
  for (std::size_t i = 0; i < count && i < ahead; ++i) prefetch(i);
  for (std::size_t i = 0; i < count; i += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) prefetch(i + ahead + l);
    enter(i);
  }
  f.count = 0;
}

/// Depth test and atomic minimum of everything in the buffer, which is empty afterwards.
template <class Keys>
HWY_NOINLINE void flush_fragments(const Keys& make, FragmentBuffer& f, PixelKey* keys) {
  flush(
      f, [&](std::size_t i) { hwy::Prefetch(keys + f.pixel[i]); },
      [&](std::size_t i) { enter_lanes(make, f, i, passing(&f.pixel[i], &f.rank[i], keys) & used_lanes(f, i), keys); });
}

/// The same for both layers of deferred rasterization: all fragments touch their pixels, and those with kCoversCenter in their id
/// cover the center, too.
HWY_NOINLINE inline void flush_both(const DeferredKeys& make, FragmentBuffer& f, PixelKey* center, PixelKey* conservative) {
  flush(
      f,
      [&](std::size_t i) {
        hwy::Prefetch(conservative + f.pixel[i]);
        hwy::Prefetch((f.id[i] & kCoversCenter ? center : conservative) + f.pixel[i]);
      },
      [&](std::size_t i) {
        const std::uint64_t used = used_lanes(f, i);
        enter_lanes(make, f, i, passing(&f.pixel[i], &f.rank[i], conservative) & used, conservative);
        std::uint64_t covers = 0;
        const auto flags = hn::BitCast(kInt, hn::LoadU(kUint, &f.id[i]));  // kCoversCenter is their sign
        hn::StoreMaskBits(kInt, hn::Lt(flags, hn::Zero(kInt)), reinterpret_cast<std::uint8_t*>(&covers));
        enter_lanes(make, f, i, covers & used, center);  // few of a thin strand's
      });
}

/// Whether another vector of fragments may be too many.
HWY_INLINE bool is_full(const FragmentBuffer& f) { return f.count + hn::Lanes(kUint) > FragmentBuffer::kCapacity; }

/// Appends the lanes in `m` to a buffer that is not full.
HWY_INLINE void append(wide::Mask m, hn::Vec<wide::UintTag> pixel, hn::Vec<wide::UintTag> rank, hn::Vec<wide::UintTag> id,
                       FragmentBuffer& f) {
  const Compressor compress(m);
  hn::StoreU(compress(pixel), kUint, &f.pixel[f.count]);
  hn::StoreU(compress(rank), kUint, &f.rank[f.count]);
  hn::StoreU(compress(id), kUint, &f.id[f.count]);
  f.count += compress.count();
}

/// Appends the lanes in `m`; flushes before where there is no room.
template <class Keys>
HWY_INLINE void append_fragments(const Keys& make, wide::Mask m, hn::Vec<wide::UintTag> pixel, hn::Vec<wide::UintTag> rank,
                                 hn::Vec<wide::UintTag> id, FragmentBuffer& f, PixelKey* keys) {
  if (is_full(f)) flush_fragments(make, f, keys);
  append(m, pixel, rank, id, f);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
