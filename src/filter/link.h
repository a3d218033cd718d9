// Strand linking: one sample a pixel misses most of a thin strand; what it missed is found again by walking along the strand
// from the samples that it hit. Huang 2025, §4.1 (references.bib: Huang2025Linking); docs/derivations/linking.md.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pixel_mask.h"
#include "filter/strand_curves.h"
#include "frame/visibility.h"

namespace pelage {

/// A pixel that linking has filled, from the sample of another pixel.
struct Fill {
  std::uint32_t pixel, source;  ///< y·width + x
};

struct Links {
  std::vector<Fill> fills;     ///< those from one source follow each other; the order is the same for any number of threads
  std::size_t candidates = 0;  ///< empty pixels that a strand was chosen for
  std::size_t walks = 0;       ///< from a sample, in one direction
};

/// The box around layer.hair, in screen pixels of the layer.
PixelBox screen_box(const StrandLayer& layer);

/// Fills empty pixels of `layer` with the strands that pass through them. A filled pixel has the color and the thickness of the
/// sample that its walk began at, and the depth, tangent and place of the strand where it is.
///
/// A walk ends at the strand's end, outside the layer, or in a pixel that a sample has hit; it goes on, without filling, where
/// the opaque scene is in front. Of several walks through a pixel the one with the best score fills it, then the nearest, then
/// the one from the first source: the same bits for any number of threads. O(pixels/64 + hair pixels + walks · log strands + steps).
Links link_strands(StrandLayer& layer, const StrandCurves& curves, const LinkSettings& settings);

}  // namespace pelage
