#include "filter/anisotropic.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/color_weights.h"
#include "filter/kernel_field.h"
#include "filter/kernel_taps.h"

namespace pelage {
namespace {

/// r ∝ side^−0.6: what is best for four and nine samples, and in denoise for any noise (docs/derivations/linking.md).
constexpr float kPixelsForSamples = 0.6f;

/// A weighted sum of pixels, four floats at a time.
struct PixelSum {
  float color[4] = {}, weight = 0;

  void add(const Vec4& c, float w) {
    color[0] += c.x, color[1] += c.y, color[2] += c.z, color[3] += c.w;
    weight += w;
  }
  void add(const Vec4& c, float hair, float w) {
    color[0] += c.x * w, color[1] += c.y * w, color[2] += c.z * w, color[3] += c.w * w;
    weight += hair * w;
  }
};

Vec4 mean(const PixelSum& a, const PixelSum& b) {
  const float scale = 1 / (a.weight + b.weight);
  return {(a.color[0] + b.color[0]) * scale, (a.color[1] + b.color[1]) * scale, (a.color[2] + b.color[2]) * scale,
          (a.color[3] + b.color[3]) * scale};
}

/// The mean of all under a kernel whose weights are 1. Pixels without hair are 0 in all, so that nobody has to ask.
Vec4 flat_mean(const Vec4* color, const float* weight, const KernelTaps& taps) {
  PixelSum before, after;
  before.add(*color, *weight);
  for (const std::int32_t offset : taps.offset) {
    before.add(color[-offset], weight[-offset]);
    after.add(color[offset], weight[offset]);
  }
  return mean(before, after);
}

Vec4 weighted_mean(const Vec4* color, const float* weight, std::span<const std::int32_t> offsets, const float* before_weights,
                   const float* after_weights) {
  PixelSum before, after;
  before.add(*color, *weight);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const std::int32_t offset = offsets[i];
    before.add(color[-offset], weight[-offset], before_weights[i]);
    after.add(color[offset], weight[offset], after_weights[i]);
  }
  return mean(before, after);
}

}  // namespace

AnisotropicKernel kernel_for(const PixelBox& hair, int side, const LinkSettings& settings) {
  AnisotropicKernel k;
  k.adapts = settings.kernel_size == 0;
  const float radius =
      k.adapts ? settings.kernel_radius * std::pow(static_cast<float>(side), -kPixelsForSamples)
               : settings.kernel_size * std::sqrt(static_cast<float>(hair.width()) * static_cast<float>(hair.height()));
  k.radius = std::min(k.adapts ? std::max(radius, KernelVariants::kLeastAxis) : radius, AnisotropicKernel::kMostRadius);
  k.aspect = settings.aspect;
  k.sigma_along = settings.falloff, k.sigma_across = settings.falloff;
  k.sigma_distance = settings.sigma_distance, k.sigma_angle = settings.sigma_angle, k.sigma_color = settings.sigma_color;
  return k;
}

Buffer<Vec4> filter_anisotropic(const Matte& m, const AnisotropicKernel& kernel) {
  PELAGE_CHECK(kernel.radius >= 0 && kernel.radius <= AnisotropicKernel::kMostRadius);
  PELAGE_CHECK(!kernel.adapts || kernel.radius >= KernelVariants::kLeastAxis);
  PELAGE_CHECK(m.border >= kernel.reach());
  const KernelTable table(kernel, m.stride());
  const bool by_color = !std::isinf(kernel.sigma_color);
  Buffer<Vec4> out(m.color.size());
  parallel_for(static_cast<std::size_t>(m.height), PixelMask::kRowsPerTask, [&](std::size_t first, std::size_t last) {
    ColorWeights colors(by_color ? table.most_pairs() : 0);
    KernelField field(m, kernel);
    field.load(static_cast<int>(first), static_cast<int>(last));
    m.hair.for_each(first, last, [&](int x, int y) {
      const std::size_t p = m.index(x, y);
      const Vec4* const color = &m.color[p];
      const float* const weight = &m.weight[p];
      const KernelChoice choice = field.at(x, y);
      if (choice.variant == KernelChoice::kNone) {
        out[p] = *color;
        return;
      }
      const KernelTaps taps = table.of(choice);
      if (table.flat()) {
        out[p] = flat_mean(color, weight, taps);
      } else if (by_color) {
        colors.weigh(color, taps, table.terms());
        out[p] = weighted_mean(color, weight, taps.offset, colors.before.data(), colors.after.data());
      } else {
        out[p] = weighted_mean(color, weight, taps.offset, taps.weight.data(), taps.weight.data());
      }
    });
  });
  return out;
}

Buffer<Vec4> filter_apart(const Matte& m, const AnisotropicKernel& opacity, const AnisotropicKernel& color) {
  Buffer<Vec4> result = filter_anisotropic(m, color);
  if (!m.coverage.empty() || color.radius <= opacity.radius) return result;
  const Buffer<Vec4> narrow = filter_anisotropic(m, opacity);
  m.hair.parallel_for_each([&](int x, int y) {
    Vec4& c = result[m.index(x, y)];
    const float alpha = narrow[m.index(x, y)].w, scale = c.w > 0 ? alpha / c.w : 0;
    c = {c.x * scale, c.y * scale, c.z * scale, alpha};
  });
  return result;
}

}  // namespace pelage
