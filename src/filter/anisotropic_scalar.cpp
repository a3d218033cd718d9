#include <cmath>

#include "filter/anisotropic_rows.h"
#include "kernel/lanes_scalar.h"

#define PELAGE_LANES_FN inline

namespace pelage {
namespace kernel {
namespace {
#include "filter/anisotropic_rows-inl.h"
}  // namespace
}  // namespace kernel

void filter_row_scalar(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out) {
  kernel::filter_row_any(planes, kernel, y, out);
}

}  // namespace pelage
