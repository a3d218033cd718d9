#include <cmath>

#include "filter/anisotropic_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/anisotropic_wide.cpp"
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
#include "filter/anisotropic_rows-inl.h"
}  // namespace
}  // namespace wide

void FilterRowWide(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out) {
  wide::filter_row_any(planes, kernel, y, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {
HWY_EXPORT(FilterRowWide);
void filter_row(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out) {
  HWY_DYNAMIC_DISPATCH(FilterRowWide)(planes, kernel, y, out);
}
}  // namespace pelage
#endif
