#include "filter/anisotropic.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/color_weights.h"
#include "filter/kernel_taps.h"

namespace pelage {
namespace {

/// Sums of all of MattePixel, as two vectors of four that any compiler knows how to add.
struct Sums {
  float value[8] = {};
  void add(const MattePixel& m, float weight) {
    const float* const p = &m.r;
    for (int c = 0; c < 8; ++c) value[c] += weight * p[c];
  }
  /// Color and opacity of the weighted mean, the rest as it is in `here`.
  MattePixel mean(const MattePixel& here) const {
    MattePixel m = here;
    const float scale = 1 / value[4];
    m.r = value[0] * scale, m.g = value[1] * scale, m.b = value[2] * scale, m.alpha = value[3] * scale;
    return m;
  }
};

}  // namespace

AnisotropicKernel kernel_for(const PixelBox& hair, const LinkSettings& settings) {
  AnisotropicKernel k;
  k.radius = std::min(settings.kernel_size * std::sqrt(static_cast<float>(hair.width()) * static_cast<float>(hair.height())),
                      AnisotropicKernel::kMostRadius);
  k.aspect = settings.aspect;
  k.sigma_distance = settings.sigma_distance, k.sigma_angle = settings.sigma_angle, k.sigma_color = settings.sigma_color;
  return k;
}

Matte filter_anisotropic(const Matte& m, const AnisotropicKernel& kernel) {
  PELAGE_CHECK(kernel.radius >= 0 && kernel.radius <= AnisotropicKernel::kMostRadius);
  PELAGE_CHECK(m.border >= kernel.reach());
  const KernelTaps all_taps(kernel, m.stride());
  const bool by_color = !std::isinf(kernel.sigma_color);
  Matte out(m.width, m.height, 0);
  out.left = m.left, out.top = m.top, out.exact_coverage = m.exact_coverage, out.hair = m.hair;
  parallel_for(static_cast<std::size_t>(m.height), PixelMask::kRowsPerTask, [&](std::size_t first, std::size_t last) {
    std::vector<float> weights(by_color ? all_taps.most() + kColorWeightPadding : 0);
    m.hair.for_each(first, last, [&](int x, int y) {
      const MattePixel& here = m.at(x, y);
      if (here.tangent() == Vec2()) {
        out.at(x, y) = here;
        return;
      }
      const auto taps = all_taps.of(here.tangent());
      Sums sums;
      if (by_color) {
        color_weights(&here, taps, all_taps.terms(), weights);
        for (std::size_t i = 0; i < taps.size(); ++i) sums.add((&here)[taps[i].offset], weights[i]);
      } else {
        for (const KernelTap& tap : taps) sums.add((&here)[tap.offset], tap.weight);
      }
      out.at(x, y) = sums.mean(here);
    });
  });
  return out;
}

Matte filter_apart(const Matte& m, const AnisotropicKernel& opacity, const AnisotropicKernel& color) {
  Matte result = filter_anisotropic(m, color);
  if (m.exact_coverage || color.radius <= opacity.radius) return result;
  const Matte narrow = filter_anisotropic(m, opacity);
  result.exact_coverage = true;
  m.hair.parallel_for_each([&](int x, int y) { result.at(x, y).coverage = narrow.at(x, y).alpha; });
  return result;
}

}  // namespace pelage
