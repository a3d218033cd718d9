// The wide target of the parity test, on the instruction set that is active (pelage::set_isa).
#pragma once

namespace pelage {

/// Evaluates case `wanted`. inputs [8][samples], results [4][samples]; samples is a multiple of 64.
void parity_evaluate_wide(int wanted, const float* inputs, int samples, float* results);

}  // namespace pelage
