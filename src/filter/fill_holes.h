// Guesses pixels from those around them: pull and push over a pyramid.
#pragma once

#include <pelage/vec.h>

#include <cstdint>

#include "core/buffer.h"

namespace pelage {

/// Gives every pixel of `values` that is not `known` the mean of the known ones around it: over 2×2 pixels where these are known
/// in part, else smoothly over larger squares (Gortler 1996, references.bib: Gortler1996Lumigraph). Unchanged where none is known.
/// Sizes [height·width]. Same bits for any number of threads; O(pixels).
void fill_holes(Buffer<Vec4>& values, const Buffer<std::uint8_t>& known, int width, int height);

}  // namespace pelage
