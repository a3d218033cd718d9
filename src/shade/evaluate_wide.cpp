#include "shade/evaluate.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/evaluate_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"
#include "kernel/lanes-inl.h"

#ifndef PELAGE_LANES_FN
#define PELAGE_LANES_FN HWY_INLINE
#endif

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
namespace {
#include "shade/evaluate-inl.h"
}  // namespace
}  // namespace wide

void EvaluateWide(const ShadeConstants& constants, ShadeBatch& batch) { wide::shade_evaluate(constants, batch); }

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {
HWY_EXPORT(EvaluateWide);
void evaluate(const ShadeConstants& constants, ShadeBatch& batch) { HWY_DYNAMIC_DISPATCH(EvaluateWide)(constants, batch); }
}  // namespace pelage
#endif
