// Compression of several lane vectors by one mask: set lanes to the front, in order. What stands behind them is undefined. Included once per instruction set.
#if defined(PELAGE_COMPRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGE_COMPRESS_INL_H_
#undef PELAGE_COMPRESS_INL_H_
#else
#define PELAGE_COMPRESS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// With GCC 12, Highway 1.0.3's own Compress copies its table (1 KiB on AVX2, 256 bytes on SSE4) to the stack at every call: on
// AVX2 most of the center layer's time. These tables stand still, and all vectors share one look-up.
#if HWY_TARGET == HWY_AVX2
/// For each mask of 8 lanes the numbers of its set lanes, ascending, 4 bits each.
inline constexpr std::array<std::uint32_t, 256> kSetLanes = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t mask = 0; mask < 256; ++mask)
    for (std::uint32_t lane = 0, place = 0; lane < 8; ++lane)
      if (mask >> lane & 1) table[mask] |= lane << (4 * place++);
  return table;
}();

class Compressor {
 public:
  explicit HWY_INLINE Compressor(wide::Mask m) : count_(hn::CountTrue(wide::FloatTag(), m.m)) {
    const wide::UintTag d;
    std::uint8_t bits[8];
    hn::StoreMaskBits(d, hn::RebindMask(d, m.m), bits);
    lanes_ = hn::And(hn::Shr(hn::Set(d, kSetLanes[bits[0]]), hn::ShiftLeft<2>(hn::Iota(d, 0))), hn::Set(d, 7));
  }
  HWY_INLINE std::size_t count() const { return count_; }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<V>(), lanes_));
  }

 private:
  hn::Vec<wide::UintTag> lanes_;
  std::size_t count_;
};
#elif HWY_TARGET == HWY_SSE4
/// For each mask of 4 lanes the bytes of its set lanes, ascending.
struct alignas(16) SetBytes {
  std::uint8_t of[16][16];
};
inline constexpr SetBytes kSetBytes = [] {
  SetBytes table{};
  for (int mask = 0; mask < 16; ++mask)
    for (int lane = 0, place = 0; lane < 4; ++lane)
      if (mask >> lane & 1)
        for (int byte = 0; byte < 4; ++byte) table.of[mask][place++] = static_cast<std::uint8_t>(4 * lane + byte);
  return table;
}();

class Compressor {
 public:
  explicit HWY_INLINE Compressor(wide::Mask m) : count_(hn::CountTrue(wide::FloatTag(), m.m)) {
    const wide::UintTag d;
    std::uint8_t bits[8];
    hn::StoreMaskBits(d, hn::RebindMask(d, m.m), bits);
    bytes_ = hn::Load(kByteTag, kSetBytes.of[bits[0]]);
  }
  HWY_INLINE std::size_t count() const { return count_; }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return hn::BitCast(hn::DFromV<V>(), hn::TableLookupBytes(hn::BitCast(kByteTag, v), bytes_));
  }

 private:
  static constexpr hn::Repartition<std::uint8_t, wide::UintTag> kByteTag{};
  hn::Vec<hn::Repartition<std::uint8_t, wide::UintTag> > bytes_;
  std::size_t count_;
};
#else
class Compressor {
 public:
  explicit HWY_INLINE Compressor(wide::Mask m) : mask_(m) {}
  HWY_INLINE std::size_t count() const { return hn::CountTrue(wide::FloatTag(), mask_.m); }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return hn::Compress(v, hn::RebindMask(hn::DFromV<V>(), mask_.m));
  }

 private:
  wide::Mask mask_;
};
#endif

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
