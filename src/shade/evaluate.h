// Evaluation of a batch: fast on the active instruction set, or one lane at a time.
#pragma once

#include "frame/light_lookup.h"
#include "shade/batch.h"

namespace pelage {

/// Fills the results of `batch`. Both give the same bits; the second is the reference of tests and benchmarks.
void evaluate(const ShadeConstants& constants, ShadeBatch& batch);
void evaluate_scalar(const ShadeConstants& constants, ShadeBatch& batch);

/// Metres and texels that a mesh must lie in front of a strand to shade it: roots stand in the skin, whose coarse
/// triangles and the map's texels both leave it by millimetres.
inline constexpr ShadowBias kHairBias{0.002f, 1.5f};

}  // namespace pelage
