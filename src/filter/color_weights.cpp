#include "filter/color_weights.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/color_weights.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {

/// x[i] = exp(−x[i]) · weight[i] for `count` values, with room for a whole vector at the end.
void ExponentialsWide(const float* weight, std::size_t count, float* x) {
  const std::size_t step = static_cast<std::size_t>(wide::lanes());
  for (std::size_t i = 0; i < count; i += step) wide::store(wide::m_exp(wide::Float(0.0f) - wide::load(x + i)), x + i);
  for (std::size_t i = 0; i < count; ++i) x[i] *= weight[i];
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(ExponentialsWide);

constexpr std::size_t kWidestVector = 64;  // floats

ColorWeights::ColorWeights(std::size_t pairs) : before(pairs + kWidestVector), after(pairs + kWidestVector) {}

void ColorWeights::weigh(const Vec4* here, const KernelTaps& taps, const kernel::FilterKernel& terms) {
  const auto exponent = [&](const Vec4& there) {
    return kernel::filter_color_exponent(terms, Vec3(there.x - here->x, there.y - here->y, there.z - here->z));
  };
  for (std::size_t i = 0; i < taps.offset.size(); ++i)
    before[i] = exponent(here[-taps.offset[i]]), after[i] = exponent(here[taps.offset[i]]);
  for (std::vector<float>* weights : {&before, &after})
    HWY_DYNAMIC_DISPATCH(ExponentialsWide)(taps.weight.data(), taps.weight.size(), weights->data());
}

}  // namespace pelage
#endif
