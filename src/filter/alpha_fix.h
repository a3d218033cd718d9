// Alpha fix: a strand that linking made longer by N pixels gets so transparent that it is as bright as the M pixels that were
// hit. Huang 2025, §4.2 (references.bib: Huang2025Linking); docs/derivations/linking.md.
#pragma once

#include <pelage/scene.h>

#include <cstddef>

#include "filter/link.h"
#include "filter/matte.h"
#include "frame/visibility.h"

namespace pelage {

struct AlphaStats {
  std::size_t segments = 0;  ///< that linking has filled pixels of
  std::size_t overflow = 0;  ///< fills whose segment found no place in the table: they were taken back
};

/// The matte of a linked layer, with a border of `border` ≥ 0 empty pixels; each pixel the mean of its visibility pixels.
///
/// LinkAlpha::kCount, eq. 8: the M hit and N filled pixels of a linked segment have α = M/(M+N) and C_hair, the mean color of
/// the M; so the sum of α·C_hair over M ∪ N is that of the colors of M (eq. 10). Pixels of other segments keep their color,
/// with α = 1. A segment is a primitive of the sample that its fills came from.
/// LinkAlpha::kCoverage: α is layer.coverage; pixels keep their colors, and what has area, but no sample, none.
/// LinkAlpha::kNone: α is 1 and pixels keep their colors.
///
/// Background is not mixed in (eq. 9): the matte is laid over what is really there, after the filter. Removes fills that
/// overflow the table from `layer`. Same bits for any number of threads. O(pixels of the layer), most of it clearing the matte.
Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, int border, AlphaStats& stats);

/// Slots of the table: ⌈1.2·W·H⌉ of the box around the layer's hair, eq. 14, but no more than twice the segments that there
/// can be, two walks from a sample each; at least 1.
std::size_t segment_table_size(const StrandLayer& layer, const Links& links);
/// The same with a table of another size: for tests of its overflow.
Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, int border, std::size_t table_size, AlphaStats& stats);

}  // namespace pelage
