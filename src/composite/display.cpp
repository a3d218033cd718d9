// The picture for a display, many pixels at a time.
#include <algorithm>
#include <cstring>

#include "composite/composite.h"
#include "core/check.h"
#include "core/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/display.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using wide::Float;
using wide::kFloatTag;

struct Pixels {
  wide::Vec3 color;
  Float alpha;
};

template <bool kAces>
HWY_INLINE Pixels encode(Pixels p) {
  const wide::Mask solid = p.alpha > Float(0.f);
  const wide::Vec3 straight = p.color / select(solid, p.alpha, Float(1.f));
  return {wide::composite_srgb_encode3(kAces ? wide::composite_tone_map_aces(straight) : straight), p.alpha};
}

// `count` RGBA pixels; the remainder after whole lanes goes through a padded copy.
template <bool kAces>
void encode_run(const float* in, std::size_t count, float* out) {
  const auto step = static_cast<std::size_t>(wide::lanes());
  const auto encode_lanes = [](const float* from, float* to) {
    Pixels p;
    hn::LoadInterleaved4(kFloatTag, from, p.color.x.v, p.color.y.v, p.color.z.v, p.alpha.v);
    const Pixels q = encode<kAces>(p);
    hn::StoreInterleaved4(q.color.x.v, q.color.y.v, q.color.z.v, q.alpha.v, kFloatTag, to);
  };
  const std::size_t floats = 4 * step;
  std::size_t i = 0;
  for (; i + step <= count; i += step) {
    const float* from = in + 4 * i;  // a backdrop of one color is encoded once
    if (i > 0 && std::memcmp(from, from - floats, floats * sizeof(float)) == 0)
      std::copy(out + 4 * i - floats, out + 4 * i, out + 4 * i);
    else encode_lanes(from, out + 4 * i);
  }
  if (i == count) return;
  float from[4 * HWY_MAX_BYTES / sizeof(float)] = {}, to[4 * HWY_MAX_BYTES / sizeof(float)];
  std::copy(in + 4 * i, in + 4 * count, from);
  encode_lanes(from, to);
  std::copy(to, to + 4 * (count - i), out + 4 * i);
}

void encode_pixels(const float* in, std::size_t count, bool aces, float* out) {
  aces ? encode_run<true>(in, count, out) : encode_run<false>(in, count, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(encode_pixels);

Image make_display(const Image& linear, ToneMap tone_map) {
  PELAGE_CHECK_EQ(linear.channel_count(), 4u);
  Image display(linear.width, linear.height, linear.channels);
  parallel_for(linear.pixels.size() / 4, 4096, [&](std::size_t first, std::size_t last) {
    HWY_DYNAMIC_DISPATCH(encode_pixels)
    (linear.pixels.data() + 4 * first, last - first, tone_map == ToneMap::kAces, display.pixels.data() + 4 * first);
  });
  return display;
}

}  // namespace pelage
#endif
