#include "filter/color_weights.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/color_weights.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {

/// weights[i] = exp(−weights[i]) · taps[i].weight for `count` taps.
void ExponentialsWide(const KernelTap* taps, std::size_t count, float* weights) {
  const std::size_t step = static_cast<std::size_t>(wide::lanes());
  for (std::size_t i = 0; i < count; i += step)
    wide::store(wide::m_exp(wide::Float(0.0f) - wide::load(weights + i)), weights + i);
  for (std::size_t i = 0; i < count; ++i) weights[i] *= taps[i].weight;
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(ExponentialsWide);

void color_weights(const MattePixel* here, std::span<const KernelTap> taps, const kernel::FilterKernel& terms,
                   std::span<float> weights) {
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const MattePixel& m = here[taps[i].offset];
    weights[i] = kernel::filter_color_exponent(terms, Vec3(m.r - here->r, m.g - here->g, m.b - here->b));
  }
  HWY_DYNAMIC_DISPATCH(ExponentialsWide)(taps.data(), taps.size(), weights.data());
}

}  // namespace pelage
#endif
