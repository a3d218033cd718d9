#include "shade/evaluate.h"

#include "kernel/lanes_scalar.h"

#define PELAGE_LANES_FN inline

namespace pelage {
namespace kernel {
namespace {
#include "shade/evaluate-inl.h"
}  // namespace
}  // namespace kernel

void evaluate_scalar(const ShadeConstants& constants, ShadeBatch& batch) { kernel::shade_evaluate(constants, batch); }

}  // namespace pelage
