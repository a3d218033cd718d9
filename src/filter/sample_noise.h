// How noisy the light of samples is, and how wide a filter that asks for.
#pragma once

#include "frame/hair_samples.h"

namespace pelage {

/// Mean squared difference of color between neighboring samples of one strand, over that between neighbors of different strands or of
/// a strand and what is behind it: about 0 where color follows from the place on the strand, 1 where it is as random as which
/// strand a sample meets. Within 0…1; 0 where no strand has neighbors. Deterministic; O(pixels).
float color_noise(const HairSamples& samples);

/// How many times as long as for opacity the orientation-aware filter has to be to bring colors of this noise nearest to those of many
/// samples: docs/denoise.md has the measurements that it is fitted to.
float kernel_scale_for_noise(float noise);

}  // namespace pelage
