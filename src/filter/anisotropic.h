// Orientation-aware filter: smooths hair along its strands. Huang 2025, §4.3 (references.bib: Huang2025Linking), and the form of
// Lipp 2026, eq. 9 and 10 (references.bib: Lipp2026Deferred), as one kernel; docs/derivations/linking.md.
#pragma once

#include <pelage/scene.h>

#include <cmath>

#include "filter/matte.h"

namespace pelage {

/// Around a pixel with tangent T, a pixel that is `along` T and `across` it away, off by d = √(along² + across²), by θ from
/// the direction of T and by Δ in color, weighs
///   exp(−(d/r)²/σ_d² − θ²/σ_θ² − Δ²/σ_c² − along²/2σ∥² − across²/2σ⊥²)  where  (along/r)² + (across/ρr)² ≤ 1,
/// and nothing elsewhere. The first three are eq. 11 of Huang 2025, the last two eq. 9 of Lipp 2026; a σ of INFINITY takes a
/// term out.
struct AnisotropicKernel {
  float radius = 7;     ///< r, pixels, 0…kMostRadius; like the minor axis, it counts as half a pixel at least
  float aspect = 0.3f;  ///< ρ, 0…1
  float sigma_distance = INFINITY, sigma_angle = INFINITY, sigma_color = INFINITY;
  float sigma_along = INFINITY, sigma_across = INFINITY;  ///< σ∥ in units of r, σ⊥ in units of ρr
  /// Whether each pixel takes, along the mean direction of the hair around it, the variant for it (filter/kernel_field.h).
  bool adapts = false;

  static constexpr float kMostRadius = 64;
  /// Pixels in x and y within which all weights are: what the border of a matte has to be.
  int reach() const { return static_cast<int>(radius); }
};

/// The kernel of `settings` for hair in this box of screen pixels that `side`² visibility pixels each were rendered for. Where k
/// is given, r = k·√(Bx·By) with the sides of the box, eq. 13. Else a kernel that adapts, with r = kernel_radius·side^−0.6: more
/// samples need fewer pixels. r is kMostRadius at most.
AnisotropicKernel kernel_for(const PixelBox& hair, int side, const LinkSettings& settings);

/// Weighted means (eq. 12) of color and opacity over the hair around every pixel of m.hair, at Matte::index(); other pixels are
/// undefined. A pixel without a tangent stays as it is. m.border ≥ kernel.reach(). Same bits for any number of threads and any
/// instruction set. O(hair pixels · pixels inside the ellipse).
Buffer<Vec4> filter_anisotropic(const Matte& m, const AnisotropicKernel& kernel);

/// Opacity by one kernel, color by another one that is as wide or wider: what covers a pixel is as certain as ever where light is
/// noisy, and its edges stay. Where the matte has an exact opacity, the picture gets that. m.border ≥ the reach of both.
Buffer<Vec4> filter_apart(const Matte& m, const AnisotropicKernel& opacity, const AnisotropicKernel& color);

}  // namespace pelage
