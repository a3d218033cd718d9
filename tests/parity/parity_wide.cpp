// Wide target of the parity test, compiled once per instruction set.
#include "parity/parity_wide.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "parity/parity_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
#define PELAGE_FN HWY_INLINE
#include "parity/parity.h"
#undef PELAGE_FN

}  // namespace wide

void evaluate(int wanted, const float* inputs, int samples, float* results) {
  using namespace wide;
  int number = 0;
#define PELAGE_PARITY(name, bound, ranges, expression)                                                                       \
  if (wanted == number++) {                                                                                                  \
    for (int i = 0; i < samples; i += lanes()) {                                                                             \
      [[maybe_unused]] const Float a = load(inputs + i), b = load(inputs + samples + i), c = load(inputs + 2 * samples + i), \
                                   d = load(inputs + 3 * samples + i), e = load(inputs + 4 * samples + i),                   \
                                   f = load(inputs + 5 * samples + i), g = load(inputs + 6 * samples + i),                   \
                                   h = load(inputs + 7 * samples + i);                                                       \
      const Vec4 v = parity_result(expression);                                                                              \
      store(v.x, results + i);                                                                                               \
      store(v.y, results + samples + i);                                                                                     \
      store(v.z, results + 2 * samples + i);                                                                                 \
      store(v.w, results + 3 * samples + i);                                                                                 \
    }                                                                                                                        \
  }
#include "parity/parity_cases.inc"
#undef PELAGE_PARITY
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {
HWY_EXPORT(evaluate);
void parity_evaluate_wide(int wanted, const float* inputs, int samples, float* results) {
  HWY_DYNAMIC_DISPATCH(evaluate)(wanted, inputs, samples, results);
}
}  // namespace pelage
#endif
