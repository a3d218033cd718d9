#include "filter/reconnect_taps.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/reconnect_taps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "kernel/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;

constexpr std::size_t kLanes = ReconnectTaps::kLanes;

/// kLanes sums as whole vectors.
struct Sums {
  static constexpr std::size_t kVectors = kLanes;  // at most, with one lane
  Float r[kVectors], g[kVectors], b[kVectors], w[kVectors], hits[kVectors], seen[kVectors];
};

float total(const Float* sums, std::size_t vectors) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  HWY_ALIGN float parts[kLanes];
  for (std::size_t v = 0; v < vectors; ++v) store(sums[v], parts + v * lanes);
  for (std::size_t step = kLanes / 2; step > 0; step /= 2)
    for (std::size_t i = 0; i < step; ++i) parts[i] += parts[i + step];
  return parts[0];
}

/// e^−x, nearly.
HWY_INLINE Float falling(Float x) {
  const Float one(1.0f);
  return one / (one + x * (one + x * (Float(0.5f) + x * Float(1.0f / 6.0f))));
}

template <bool kColor>
TapSums Sum(const ReconnectTaps& taps, const ReconnectPixels& m, const ReconnectStrand& s) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes()), vectors = kLanes / lanes;
  const Float none(0.0f);
  Sums sums;
  for (Float* sum : {sums.r, sums.g, sums.b, sums.w, sums.hits, sums.seen}) std::fill(sum, sum + vectors, none);
  const Float r0(*m.r), g0(*m.g), b0(*m.b);
  for (std::size_t i = 0; i < taps.count; i += kLanes)
    for (std::size_t v = 0; v < vectors; ++v) {
      const std::size_t at = i + v * lanes;
      const wide::Int offset = wide::load(taps.offset + at);
      const Float depth = wide::gather(m.depth, offset), weight = wide::load(taps.weight + at);
      const Float expected = Float(s.depth) + Float(s.slope) * wide::load(taps.along + at);
      const Mask opaque = depth < none, hit = depth < Float(kNoDepth) && !opaque;
      sums.hits[v] = sums.hits[v] + select(hit, weight, none);
      sums.seen[v] = sums.seen[v] + select(opaque && Float(-1.0f) - depth < expected, none, weight);
      const Mask alike = hit && abs(depth - expected) <= Float(s.tolerance);
      if (!wide::any(alike)) continue;
      const Float r = wide::gather(m.r, offset), g = wide::gather(m.g, offset), b = wide::gather(m.b, offset);
      Float w = select(alike, weight, none);
      if constexpr (kColor) {
        const Float dr = r - r0, dg = g - g0, db = b - b0;
        w = w * falling((dr * dr + dg * dg + db * db) * Float(s.color_scale));
      }
      sums.r[v] = sums.r[v] + r * w, sums.g[v] = sums.g[v] + g * w;
      sums.b[v] = sums.b[v] + b * w, sums.w[v] = sums.w[v] + w;
    }
  return {{total(sums.r, vectors), total(sums.g, vectors), total(sums.b, vectors), total(sums.w, vectors)},
          total(sums.hits, vectors),
          total(sums.seen, vectors)};
}

TapSums SumTaps(const ReconnectTaps& taps, const ReconnectPixels& middle, const ReconnectStrand& strand) {
  return strand.color_scale > 0 ? Sum<true>(taps, middle, strand) : Sum<false>(taps, middle, strand);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(SumTaps);

TapSums sum_taps(const ReconnectTaps& taps, const ReconnectPixels& middle, const ReconnectStrand& strand) {
  return HWY_DYNAMIC_DISPATCH(SumTaps)(taps, middle, strand);
}

}  // namespace pelage
#endif
