// Subpixel morphological anti-aliasing, SMAA 1x (references.bib: Jimenez2012Smaa): edges of the picture become lines, and pixels are
// mixed by the area that the lines cut off them.
//
// Included: luma edges with local contrast adaptation (section 3.2 of the paper), search for the ends of an edge pixel by
// pixel, the orthogonal patterns with exact areas instead of a precomputed texture, rounding of true corners (section 3.3),
// blending in linear light. Left out: diagonal patterns (section 3.4), and what the other variants add over time and samples.
#pragma once

#include <pelage/image.h>

#include "core/buffer.h"
#include "filter/resample.h"
#include "frame/frame.h"

namespace pelage {

/// The defaults are those of the authors' preset "ultra".
struct SmaaSettings {
  float threshold = 0.05f;        ///< contrast of encoded brightness between neighbors to be an edge
  float contrast_adaptation = 2;  ///< an edge with one this many times as strong beside it is none
  int search_steps = 64;          ///< pixels that an edge is followed to either side
  float corner_rounding = 0.25f;  ///< 0…1: how much of the blending is kept at true corners
};

/// What one pixel takes of its neighbors: shares 0…½ of the area. At most one of an opposite pair usually counts.
struct SmaaShares {
  float left = 0, right = 0, up = 0, down = 0;
};

/// Signed area between an edge and the line it stands for, in pixel `left` of left + 1 + right along it: `above` and `below`
/// are the parts on either side. The line's ends are at the heights `start` and `end`, each 0 or ±½ pixel: where the
/// contour goes up or down there. Ends on different sides: a straight line; else straight to the middle, where it meets
/// the edge. Exact.
struct EdgeArea {
  float above = 0, below = 0;
};
EdgeArea smaa_area(int left, int right, float start, float end);

/// [h·w] what each pixel of the encoded picture `display` (R, G, B, A) takes of its neighbors. O(pixels · search_steps) at
/// worst, rows in parallel.
Buffer<SmaaShares> smaa_shares(const Image& display, const SmaaSettings& settings = {});

/// `image` (R, G, B, A) with every pixel mixed with its neighbors: across rows or across columns, whichever is stronger.
/// Straight pictures are taken as sRGB-encoded and mixed in linear light. O(pixels), rows in parallel.
Image smaa_blend(const Image& image, const Buffer<SmaaShares>& shares, AlphaKind alpha);

}  // namespace pelage
