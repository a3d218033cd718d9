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

  void add(const Vec4& c, float hair, float w) {
    color[0] += c.x * w, color[1] += c.y * w, color[2] += c.z * w, color[3] += c.w * w;
    weight += hair * w;
  }
  /// Two pixels of one weight.
  void add(const Vec4& a, const Vec4& b, float w) {
    color[0] += (a.x + b.x) * w, color[1] += (a.y + b.y) * w, color[2] += (a.z + b.z) * w, color[3] += (a.w + b.w) * w;
  }
  Vec4 mean() const {
    const float scale = 1 / weight;
    return {color[0] * scale, color[1] * scale, color[2] * scale, color[3] * scale};
  }
};

/// The mean under a kernel that is the same on either side. Pixels without hair are 0 in all, so that nobody has to ask; where
/// there are none, `inside` says so, and the sum of the weights is known.
Vec4 symmetric_mean(const Vec4* color, const float* weight, const KernelTaps& taps, bool inside) {
  PixelSum sum;
  sum.add(*color, *weight, 1);
  if (inside) {
    for (std::size_t i = 0; i < taps.offset.size(); ++i) sum.add(color[-taps.offset[i]], color[taps.offset[i]], taps.weight[i]);
    sum.weight = taps.sum;
    return sum.mean();
  }
  for (std::size_t i = 0; i < taps.offset.size(); ++i) {
    const std::int32_t offset = taps.offset[i];
    sum.add(color[-offset], color[offset], taps.weight[i]);
    sum.weight += (weight[-offset] + weight[offset]) * taps.weight[i];
  }
  return sum.mean();
}

/// The mean under a kernel that depends on color.
Vec4 mean_by_color(const Vec4* color, const float* weight, std::span<const std::int32_t> offsets, const ColorWeights& weights) {
  PixelSum sum;
  sum.add(*color, *weight, 1);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const std::int32_t offset = offsets[i];
    sum.add(color[-offset], weight[-offset], weights.before[i]);
    sum.add(color[offset], weight[offset], weights.after[i]);
  }
  return sum.mean();
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
  const PixelMask inside = m.hair.shrunk(kernel.reach());
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
      if (by_color) {
        colors.weigh(color, taps, table.terms());
        out[p] = mean_by_color(color, weight, taps.offset, colors);
      } else {
        out[p] = symmetric_mean(color, weight, taps, inside.contains(x, y));
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
