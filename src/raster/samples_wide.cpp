// Sample layers, a segment per lane and a pixel at a time: all samples of a pixel share depth and half height, so each
// costs an addition and a comparison, and a pixel's covered samples travel as one mask. The depth test then compares a
// fragment with all samples of its pixel, one cache line of 64-bit keys at 8 samples.
//
// An atomic minimum a sample would cost more than the walk. Instead the fragments of a bunch of segments, neighbors on a
// strand and on the screen, are entered together by a thread that owns their tiles (raster/tile_locks.h).
#include "raster/fragments.h"

#include <hwy/cache_control.h>

#include <algorithm>

#include "frame/sample_positions.h"
#include "raster/keys.h"
#include "raster/tile_locks.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/samples_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "raster/compress-inl.h"
#include "raster/fragments-inl.h"
#include "raster/segment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;
using Uints = hn::Vec<wide::UintTag>;

/// Lowers the samples in `mask` of a pixel that this thread owns to `key`.
template <int kSamples>
HWY_INLINE void enter(PixelKey key, std::uint32_t mask, PixelKey* pixel) {
  const hn::CappedTag<std::uint64_t, kSamples> tag;
  const auto keys = hn::Set(tag, key);
  for (std::size_t s = 0; s < kSamples; s += hn::Lanes(tag)) {
    const std::uint64_t bits = mask >> s;
    const auto covered = hn::LoadMaskBits(tag, reinterpret_cast<const std::uint8_t*>(&bits));
    const auto nearer = hn::And(covered, hn::Lt(keys, hn::Load(tag, pixel + s)));
    hn::BlendedStore(keys, nearer, tag, pixel + s);
  }
}

/// Depth test and minimum of fragments begin … end − 1, whose pixels this thread owns.
template <int kSamples, class Keys>
void enter_all(const Keys& make, const FragmentBuffer& f, std::size_t begin, std::size_t end, PixelKey* keys) {
  constexpr std::size_t kAhead = 24;  // from the second-level cache
  const std::uint32_t *pixel = f.pixel.data(), *id = f.id.data(), *mask = f.mask.data(), *rank = f.rank.data();
  for (std::size_t i = begin; i < end; ++i) {
    hwy::Prefetch(keys + std::size_t{pixel[i + kAhead]} * kSamples);
    enter<kSamples>(make.key(rank[i], id[i]), mask[i], keys + std::size_t{pixel[i]} * kSamples);
  }
}

/// Where fragments wait for their tiles: a group for each bunch of segments.
template <int kSamples, class Keys>
class SampleEntry {
 public:
  SampleEntry(const Keys& make, int width, FragmentBuffer& fragments, TileLocks& locks, PixelKey* keys)
      : make_(make), width_(width), f_(fragments), locks_(locks), keys_(keys) {}

  const Keys& make() const { return make_; }

  /// Fragments since the last group lie in `rect`.
  void close_group(const PixelBounds& rect) {
    if (f_.count == begin_) return;
    groups_[count_++] = {rect, f_.count};
    begin_ = f_.count;
    if (count_ == kMostGroups) flush();
  }
  /// Asks for the keys of fragments that wait, a few after each row: while the walk goes on, they come.
  HWY_INLINE void prefetch() {
    constexpr std::size_t kFew = 6;  // rows append four to seven
    for (std::size_t i = 0; i < kFew; ++i) hwy::Prefetch(keys_ + std::size_t{f_.pixel[asked_ + i]} * kSamples);
    asked_ = std::min(asked_ + kFew, f_.count);
  }
  bool full() const { return f_.count + hn::Lanes(kUint) > FragmentBuffer::kCapacity; }
  /// Enters all groups.
  HWY_NOINLINE void flush() {
    std::fill(&f_.pixel[f_.count], &f_.pixel[f_.count] + FragmentBuffer::kPadding, f_.count > 0 ? f_.pixel[0] : 0);
    std::size_t begin = 0;
    for (std::size_t g = 0; g < count_; begin = groups_[g++].end) enter_group(groups_[g].rect, begin, groups_[g].end);
    f_.count = count_ = begin_ = asked_ = 0;
  }

 private:
  struct Group {
    PixelBounds rect;
    std::size_t end;
  };
  static constexpr std::size_t kMostGroups = 64, kMostTiles = 32;

  HWY_NOINLINE void enter_group(const PixelBounds& rect, std::size_t begin, std::size_t end) {
    if (TileLocks::count(rect) <= kMostTiles)
      return locks_.own(rect, [&] { enter_all<kSamples>(make_, f_, begin, end, keys_); });
    // Long or wide segments: others shall not wait for half the image.
    for (std::size_t i = begin; i < end; ++i) {
      const int pixel = static_cast<int>(f_.pixel[i]), x = pixel % width_, y = pixel / width_;
      locks_.own({x, x, y, y}, [&] { enter_all<kSamples>(make_, f_, i, i + 1, keys_); });
    }
  }

  const Keys make_;
  int width_;
  FragmentBuffer& f_;
  TileLocks& locks_;
  PixelKey* keys_;
  Group groups_[kMostGroups];
  std::size_t count_ = 0, begin_ = 0,
              asked_ = 0;  // groups, first fragment of the open one, first whose keys were not asked for
};

/// One of a band's two caps as the samples of a pixel meet it.
template <int kSamples>
struct CapLanes {
  wide::Vec2 cap;
  Float u, v;             // the point whose cap it is
  Float shift[kSamples];  // rule (2)
  Uints kept_if_past;     // all samples where it is the cap of a, which keeps what is past it; none where it is that of b
};

/// What samples add to the terms of their pixel's center, on the segments of a bunch.
template <int kSamples>
struct SampleLanes {
  Float shift[kSamples], growth[kSamples];  // rule (1)
  Uints bit[kSamples];
  Float above, below;               // how far beyond the band's edges pixels have samples inside
  CapLanes<kSamples> lower, upper;  // at the ends with the smaller and with the larger column
};

/// How far a position in the pixel is off its center, along the major and along the minor axis.
HWY_INLINE wide::Vec2 center_offset(const wide::RasterBand& band, Vec2 position) {
  const Float x(position.x - 0.5f), y(position.y - 0.5f);
  return {select(band.x_major, x, y), select(band.x_major, y, x)};
}

template <int kSamples>
HWY_INLINE void place_cap(const wide::RasterBand& band, Mask is_a, CapLanes<kSamples>& c) {
  c.cap = select(is_a, band.cap_a, band.cap_b);
  c.u = select(is_a, band.u, band.end_u), c.v = select(is_a, band.v, band.end_v);
  c.kept_if_past = hn::IfThenElseZero(hn::RebindMask(kUint, is_a.m), hn::Set(kUint, (1u << kSamples) - 1));
}

template <int kSamples>
HWY_INLINE void place_samples(const wide::RasterBand& band, SampleLanes<kSamples>& o) {
  const Mask forward = band.end_u > band.u;
  place_cap(band, forward, o.lower);
  place_cap(band, !forward, o.upper);
  const auto positions = sample_positions(kSamples);
  Float highest_shift, lowest_shift, most_growth;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const wide::Vec2 offset = center_offset(band, positions[i]);
    o.bit[i] = hn::Set(kUint, 1u << i);
    o.shift[i] = wide::raster_sample_shift(band, offset.x, offset.y);
    o.growth[i] = wide::raster_sample_growth(band, offset.x);
    o.lower.shift[i] = wide::raster_cap_shift(o.lower.cap, offset.x, offset.y);
    o.upper.shift[i] = wide::raster_cap_shift(o.upper.cap, offset.x, offset.y);
    highest_shift = i == 0 ? o.shift[i] : max(highest_shift, o.shift[i]);
    lowest_shift = i == 0 ? o.shift[i] : min(lowest_shift, o.shift[i]);
    most_growth = i == 0 ? o.growth[i] : max(most_growth, o.growth[i]);
  }
  constexpr float kRoundings = 0.02f;
  o.above = most_growth - lowest_shift + Float(kRoundings - 0.5f);
  o.below = most_growth + highest_shift + Float(kRoundings + 0.5f);
}

/// Lanes of which rule (3) may cut off what the caps keep. At distance d beyond its point a cap c keeps nothing of the band
/// where (c.x + m c.y) d > |c.y| (H + |dh/du| d). What holds at one distance holds farther out; rule (3) begins at `limit`.
template <int kSamples>
HWY_INLINE Mask cut_by_ends(const wide::RasterBand& band, const SampleLanes<kSamples>& o) {
  const Float half = max(band.half, wide::raster_band_half(band, band.end_u - band.u));
  const Float sign = select(band.end_u > band.u, Float(1.0f), Float(-1.0f));
  const auto cut = [&](const CapLanes<kSamples>& c, Float limit) {
    constexpr float kRoundings = 0.005f;
    const Float along = sign * (c.cap.x + band.slope * c.cap.y);
    const Float needed =
        abs(c.cap.y) * (half + abs(band.half_slope) * limit) + (abs(c.cap.x) + abs(c.cap.y)) * Float(kRoundings);
    return !(along * limit >= needed);
  };
  return cut(o.lower, o.lower.u - band.first) || cut(o.upper, band.last - o.upper.u);
}

HWY_INLINE Uints with_bit(Uints mask, Mask m, Uints bit) {
  return hn::IfThenElse(hn::RebindMask(kUint, m.m), hn::Or(mask, bit), mask);
}
HWY_INLINE Mask nonzero(Uints mask) { return {hn::RebindMask(kFloat, hn::Ne(mask, hn::Zero(kUint)))}; }

/// The pixels of which a bunch may cover samples; x1 < 0 where there are none.
template <int kSamples>
HWY_INLINE PixelBounds reached_pixels(const SegmentLanes& w, const SampleLanes<kSamples>& o) {
  // Edges are straight, so the outermost rows are those of the first or of the last column. One row more is for roundings.
  Float lowest(1.0e9f), highest(-1.0f);
  for (const Float column : {w.column, w.last}) {
    const Float s = column + Float(0.5f) - w.band.u;
    const Float center = wide::raster_band_center(w.band, s), half = wide::raster_band_half(w.band, s);
    lowest = min(lowest, center - (half + o.below));
    highest = max(highest, center + (half + o.above));
  }
  lowest = max(floor(lowest) - Float(1.0f), Float(0.0f));
  highest = min(ceil(highest) + Float(1.0f), w.rows - Float(1.0f));
  const Mask x = w.band.x_major, drawn = w.column <= w.last && lowest <= highest;
  const auto least = [&](Float f) {
    return static_cast<int>(hn::GetLane(hn::MinOfLanes(kFloat, select(drawn, f, Float(1.0e9f)).v)));
  };
  const auto most = [&](Float f) {
    return static_cast<int>(hn::GetLane(hn::MaxOfLanes(kFloat, select(drawn, f, Float(-1.0f)).v)));
  };
  return {least(select(x, w.column, lowest)), most(select(x, w.last, highest)), least(select(x, lowest, w.column)),
          most(select(x, highest, w.last))};
}

template <class Entry>
HWY_NOINLINE void make_room(const PixelBounds& reached, Entry& entry) {
  entry.close_group(reached);
  entry.flush();
}

/// Those samples in `mask` of the pixels at (u, v) that the cap keeps.
template <int kSamples>
HWY_INLINE Uints kept_by_cap(const CapLanes<kSamples>& c, const Uints* bit, Float u, Float v, Uints mask) {
  const Float side = wide::raster_cap_side(c.cap, u, v, c.u, c.v);
  Uints before = hn::Zero(kUint);
  for (int i = 0; i < kSamples; ++i) before = with_bit(before, wide::raster_before_cap(side, c.shift[i]), bit[i]);
  return hn::And(mask, hn::Xor(before, c.kept_if_past));
}

/// Bits of the samples in the columns around `u` that lie between the ends of their bands.
template <int kSamples>
HWY_INLINE Uints between_ends(const wide::RasterBand& band, const SampleLanes<kSamples>& o, Float u) {
  const auto positions = sample_positions(kSamples);
  Uints inside = hn::Zero(kUint);
  for (std::size_t i = 0; i < kSamples; ++i)
    inside = with_bit(inside, wide::raster_between_ends(band, u + center_offset(band, positions[i]).x), o.bit[i]);
  return inside;
}

/// What may cut samples off a column, besides the lateral edges: kAll are both caps and the ends.
enum class Cuts { kNone, kLower, kUpper, kAll };

/// `t`, to be read from memory where it is used. Otherwise the compiler keeps terms of samples in registers all through a
/// loop, more than there are, and copies them to the stack and back for every column.
template <class T>
HWY_INLINE const T& in_memory(const T& t) {
  const T* place = &t;
  asm("" : "+r"(place));
  return *place;
}

/// One column of each lane: appends the pixels with covered samples.
template <int kSamples, Cuts kCuts, class Entry>
HWY_INLINE void visit_column(const SegmentLanes& w, const SampleLanes<kSamples>& lanes, Float column, Mask on_band,
                             FragmentBuffer& f, const PixelBounds& reached, Entry& entry) {
  const wide::RasterBand& band = w.band;
  const Float u = column + Float(0.5f), s = u - band.u;
  const Float center = wide::raster_band_center(band, s), half = wide::raster_band_half(band, s);
  // Rows beyond which no sample is covered, with a margin for roundings.
  const Float highest = min(floor(center + (half + lanes.above)), w.rows - Float(1.0f));
  Float row = max(ceil(center - (half + lanes.below)), Float(0.0f));
  Mask open = on_band && row <= highest;
  if (!wide::any(open)) return;
  const Uints rank = entry.make().rank(wide::raster_band_depth(band, s)), id = entry.make().id(w, s);
  const Uints inside = kCuts == Cuts::kAll ? between_ends(band, lanes, u) : hn::Zero(kUint);
  Uints pixel = pixel_in_column(w, first_in_column(w, column), row);
  Float reach[kSamples];  // the right side of raster_sample_covered()
  for (int i = 0; i < kSamples; ++i) reach[i] = half + lanes.growth[i];
  do {
    const SampleLanes<kSamples>& o = in_memory(lanes);
    const Float v = row + Float(0.5f), above_center = v - center;
    Uints mask = hn::Zero(kUint);
    for (int i = 0; i < kSamples; ++i) mask = with_bit(mask, abs(above_center + o.shift[i]) <= reach[i], o.bit[i]);
    mask = hn::IfThenElseZero(hn::RebindMask(kUint, open.m), mask);
    if (kCuts == Cuts::kLower || kCuts == Cuts::kAll) mask = kept_by_cap(o.lower, o.bit, u, v, mask);
    if (kCuts == Cuts::kUpper || kCuts == Cuts::kAll) mask = kept_by_cap(o.upper, o.bit, u, v, mask);
    if (kCuts == Cuts::kAll) mask = hn::And(mask, inside);
    if (entry.full()) make_room(reached, entry);
    const Compressor compress(nonzero(mask));
    hn::StoreU(compress(pixel), kUint, &f.pixel[f.count]);
    hn::StoreU(compress(rank), kUint, &f.rank[f.count]);
    hn::StoreU(compress(id), kUint, &f.id[f.count]);
    hn::StoreU(compress(mask), kUint, &f.mask[f.count]);
    f.count += compress.count();
    entry.prefetch();
    row = row + Float(1.0f);
    pixel = hn::Add(pixel, w.row_step);
    open = open && row <= highest;
  } while (wide::any(open));
}

HWY_INLINE Float max_of_lanes(Float a) { return hn::MaxOfLanes(kFloat, a.v); }

/// All columns of a bunch.
template <int kSamples, class Entry>
HWY_INLINE void visit_segments(const SegmentLanes& w, const SampleLanes<kSamples>& o, FragmentBuffer& f,
                               const PixelBounds& reached, Entry& entry) {
  const wide::Vec2 uncut = wide::raster_uncut_columns(w.band);
  const Mask ends = cut_by_ends(w.band, o);
  // Caps cut the columns at either end of a segment. So that few steps have to look at them, most at one of the two, lanes
  // begin in step, then wait for the longest, and end in step.
  constexpr int kHead = 2;
  const Float body = w.column + Float(static_cast<float>(kHead));
  const int most = static_cast<int>(hn::GetLane(max_of_lanes(w.last - body).v));
  for (int i = -kHead; i <= most; ++i) {
    const Float column = i < 0 ? w.column + Float(static_cast<float>(i + kHead)) : w.last - Float(static_cast<float>(most - i));
    const Mask on_band = i < 0 ? column <= w.last : column >= body;
    const Mask at_lower = on_band && column < uncut.x, at_upper = on_band && column > uncut.y;
    const bool lower = wide::any(at_lower), upper = wide::any(at_upper);
    if (!lower && !upper) visit_column<kSamples, Cuts::kNone>(w, o, column, on_band, f, reached, entry);
    else if ((lower && upper) || wide::any(ends && (at_lower || at_upper)))
      visit_column<kSamples, Cuts::kAll>(w, o, column, on_band, f, reached, entry);
    else if (lower) visit_column<kSamples, Cuts::kLower>(w, o, column, on_band, f, reached, entry);
    else visit_column<kSamples, Cuts::kUpper>(w, o, column, on_band, f, reached, entry);
  }
}

template <int kSamples, class Keys>
void samples_of_block(const Keys& make, const ScreenBlock& block, int width, int height, FragmentBuffer& f, TileLocks& locks,
                      PixelKey* keys) {
  SampleEntry<kSamples, Keys> entry(make, width, f, locks, keys);
  SegmentLanes w;
  SampleLanes<kSamples> o;
  for (std::size_t j = 0; j + block.stride < block.count; j += hn::Lanes(kUint)) {
    if (!load_segments(block, j, width, height, 0.0f, 1.0f, w)) continue;
    place_samples(w.band, o);
    const PixelBounds reached = reached_pixels(w, o);
    if (reached.x1 < 0) continue;
    visit_segments(w, o, f, reached, entry);
    entry.close_group(reached);
  }
  entry.flush();
}

template <class Keys>
void samples_by_count(const Keys& make, const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& f,
                      TileLocks& locks, PixelKey* keys) {
  switch (samples) {
    case 1: return samples_of_block<1>(make, block, width, height, f, locks, keys);
    case 2: return samples_of_block<2>(make, block, width, height, f, locks, keys);
    case 4: return samples_of_block<4>(make, block, width, height, f, locks, keys);
    case 8: return samples_of_block<8>(make, block, width, height, f, locks, keys);
    case 16: return samples_of_block<16>(make, block, width, height, f, locks, keys);
  }
}

void Samples(const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& f, TileLocks& locks,
             PixelKey* keys) {
  samples_by_count(SegmentKeys(), block, width, height, samples, f, locks, keys);
}

void DeferredSamples(const ScreenBlock& block, const DepthRange& range, int width, int height, int samples, FragmentBuffer& f,
                     TileLocks& locks, PixelKey* keys) {
  samples_by_count(deferred_keys(block, range), block, width, height, samples, f, locks, keys);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Samples);
HWY_EXPORT(DeferredSamples);

void raster_samples(const ScreenBlock& block, int width, int height, int samples, FragmentBuffer& fragments, TileLocks& locks,
                    PixelKey* keys) {
  HWY_DYNAMIC_DISPATCH(Samples)(block, width, height, samples, fragments, locks, keys);
}

void raster_deferred_samples(const ScreenBlock& block, const DepthRange& range, int width, int height, int samples,
                             FragmentBuffer& fragments, TileLocks& locks, PixelKey* keys) {
  HWY_DYNAMIC_DISPATCH(DeferredSamples)(block, range, width, height, samples, fragments, locks, keys);
}

}  // namespace pelage
#endif
