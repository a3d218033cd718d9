// Sample layers, a segment per lane and a pixel at a time: all samples of a pixel share depth and half height, so each
// costs an addition and a comparison, and a pixel's covered samples travel as one mask. The depth test then compares a
// fragment with all samples of its pixel, one cache line of 64-bit keys at 8 samples.
#include "raster/fragments.h"

#include <hwy/cache_control.h>

#include <algorithm>

#include "raster/keys.h"
#include "frame/sample_positions.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/samples_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "raster/compress-inl.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;
using Uints = hn::Vec<wide::UintTag>;

const wide::FloatTag kFloat{};
const wide::UintTag kUint{};

/// Bit s tells whether `key` is smaller than key s of its pixel, as they are now.
template <int kSamples>
HWY_INLINE std::uint32_t nearer(PixelKey key, const PixelKey* pixel) {
  std::uint32_t bits = 0;
#if HWY_TARGET == HWY_AVX3
  const hn::CappedTag<std::uint64_t, kSamples> tag;
  const auto keys = hn::Set(tag, key);
  for (std::size_t s = 0; s < kSamples; s += hn::Lanes(tag)) {
    std::uint8_t some = 0;
    hn::StoreMaskBits(tag, hn::Lt(keys, hn::LoadU(tag, pixel + s)), &some);
    bits |= static_cast<std::uint32_t>(some) << s;
  }
#else
  for (int s = 0; s < kSamples; ++s)
    bits |= static_cast<std::uint32_t>(key < __atomic_load_n(pixel + s, __ATOMIC_RELAXED)) << s;
#endif
  return bits;
}

/// Depth test and atomic minimum of everything in the buffer, which is empty afterwards.
template <int kSamples>
void flush(FragmentBuffer& f, PixelKey* keys) {
  constexpr std::size_t kAhead = 16;
  const auto pixel_keys = [&](std::size_t i) { return keys + std::size_t{f.pixel[i]} * kSamples; };
  std::fill(&f.pixel[f.count], &f.pixel[f.count] + FragmentBuffer::kPadding, f.count > 0 ? f.pixel[0] : 0);
  for (std::size_t i = 0; i < std::min(kAhead, f.count); ++i) hwy::Prefetch(pixel_keys(i));
  for (std::size_t i = 0; i < f.count; ++i) {
    hwy::Prefetch(pixel_keys(i + kAhead));
    PixelKey* const pixel = pixel_keys(i);
    const PixelKey key = pixel_key(f.depth[i], f.id[i]);
    for (std::uint32_t bits = f.mask[i] & nearer<kSamples>(key, pixel); bits != 0; bits &= bits - 1)
      atomic_min(pixel[hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)], key);
  }
  f.count = 0;
}

/// Sample positions as the lanes of a bunch need them.
struct SampleOffsets {
  Float u[kMaxSamples], v[kMaxSamples];  // from the pixel's center, along each lane's axes
  Float shift[kMaxSamples], growth[kMaxSamples];
};

/// One column of each lane: appends the pixels with covered samples.
template <int kSamples>
HWY_INLINE void visit_column(const SegmentLanes& w, const SampleOffsets& o, Float column, FragmentBuffer& f, PixelKey* keys) {
  const wide::RasterBand& band = w.band;
  const Float u = column + Float(0.5f), s = u - band.u;
  const Float center = wide::raster_band_center(band, s), half = wide::raster_band_half(band, s);
  const Float highest = min(wide::raster_highest_row(band, center, half), w.rows - Float(1.0f));
  Float row = max(wide::raster_lowest_row(band, center, half), Float(0.0f));
  for (Mask open = column <= w.last && row <= highest; wide::any(open); open = open && row <= highest) {
    const Float v = row + Float(0.5f), above_center = v - center;
    Uints mask = hn::Zero(kUint);
    for (int i = 0; i < kSamples; ++i) {
      const Mask covered = wide::raster_sample_covered(above_center, o.shift[i], half, o.growth[i]);
      mask = hn::Or(mask, hn::IfThenElseZero(hn::RebindMask(kUint, covered.m), hn::Set(kUint, 1u << i)));
    }
    mask = hn::IfThenElseZero(hn::RebindMask(kUint, open.m), mask);
    const Float side_a = wide::raster_cap_side(band.cap_a, u, v, band.u, band.v);
    const Float side_b = wide::raster_cap_side(band.cap_b, u, v, band.end_u, band.end_v);
    const Mask cut = open && !wide::raster_pixel_between_caps(band, side_a, side_b, u);
    if (wide::any(cut)) {
      Uints between = hn::Zero(kUint);
      for (int i = 0; i < kSamples; ++i) {
        const Mask inside = wide::raster_sample_between_caps(band, side_a, side_b, u, o.u[i], o.v[i]);
        between = hn::Or(between, hn::IfThenElseZero(hn::RebindMask(kUint, inside.m), hn::Set(kUint, 1u << i)));
      }
      mask = hn::IfThenElse(hn::RebindMask(kUint, cut.m), hn::And(mask, between), mask);
    }
    const auto some = hn::Ne(mask, hn::Zero(kUint));
    if (!hn::AllFalse(kUint, some)) {
      if (f.count + hn::Lanes(kUint) > FragmentBuffer::kCapacity) flush<kSamples>(f, keys);
      const Compressor compress(Mask{hn::RebindMask(wide::kFloatTag, some)});
      hn::StoreU(compress(pixels_at(w, column, row)), kUint, &f.pixel[f.count]);
      hn::StoreU(compress(hn::BitCast(kUint, wide::raster_band_depth(band, s).v)), kUint,
                 reinterpret_cast<std::uint32_t*>(&f.depth[f.count]));
      hn::StoreU(compress(w.id), kUint, &f.id[f.count]);
      hn::StoreU(compress(mask), kUint, &f.mask[f.count]);
      f.count += compress.count();
    }
    row = row + Float(1.0f);
  }
}

template <int kSamples>
void samples_of_block(const ScreenBlock& block, int width, int height, FragmentBuffer& f, PixelKey* keys) {
  const auto positions = sample_positions(kSamples);
  SegmentLanes w;
  SampleOffsets o;
  for (std::size_t j = 0; j + 1 < block.count; j += hn::Lanes(kUint)) {
    if (!load_segments(block, j, width, height, 0.0f, 1.0f, w)) continue;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const Float x(positions[i].x - 0.5f), y(positions[i].y - 0.5f);
      o.u[i] = select(w.band.x_major, x, y), o.v[i] = select(w.band.x_major, y, x);
      o.shift[i] = wide::raster_sample_shift(w.band, o.u[i], o.v[i]);
      o.growth[i] = wide::raster_sample_growth(w.band, o.u[i]);
    }
    for (Float column = w.column; wide::any(column <= w.last); column = column + Float(1.0f))
      visit_column<kSamples>(w, o, column, f, keys);
  }
  flush<kSamples>(f, keys);
}

void Samples(const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& f, PixelKey* keys) {
  switch (samples) {
    case 1: return samples_of_block<1>(block, width, height, f, keys);
    case 2: return samples_of_block<2>(block, width, height, f, keys);
    case 4: return samples_of_block<4>(block, width, height, f, keys);
    case 8: return samples_of_block<8>(block, width, height, f, keys);
    case 16: return samples_of_block<16>(block, width, height, f, keys);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Samples);

void raster_samples(const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& fragments, PixelKey* keys) {
  HWY_DYNAMIC_DISPATCH(Samples)(block, width, height, samples, fragments, keys);
}

}  // namespace pelage
#endif
