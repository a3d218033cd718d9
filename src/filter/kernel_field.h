// Which kernel of the orientation-aware filter each pixel takes: thick strands need less smoothing than thin ones, and hair whose
// directions differ another shape; docs/derivations/linking.md.
#pragma once

#include <pelage/vec.h>

#include <cstddef>
#include <vector>

#include "filter/anisotropic.h"
#include "filter/matte.h"

namespace pelage {

/// The variants of a kernel that adapts, for hair by its thickness w, pixels, and by how much directions around a pixel agree
/// (0 not at all … 1). For one that doesn't there is only variant 0, the kernel itself.
///
/// The major axis is r·√(w₀/w) for w > w₀ = kThin: samples of thick strands are less noisy, and there is more to see of each. The
/// axes are kLeastAxis at least. Where directions differ, both change so that the ellipse becomes a circle of the same area.
struct KernelVariants {
  static constexpr float kThin = 0.1f;    ///< w₀, pixels
  static constexpr float kLeastAxis = 1;  ///< of both axes, pixels; r of a kernel that adapts is no less
  static constexpr int kSizes = 7;        ///< w from w₀ on, by factors of two
  static constexpr int kShapes = 5;       ///< agreement from 0 to 1, in steps of a quarter

  static int count(const AnisotropicKernel& kernel) { return kernel.adapts ? kSizes * kShapes : 1; }
  static int of(float thickness, float agreement);
  static AnisotropicKernel kernel(const AnisotropicKernel& thin, int variant);
};

/// A kernel of a table: its variant, and the cell of directions that it lies along.
struct KernelChoice {
  static constexpr int kNone = -1;
  int variant = kNone, direction = 0;
};

/// Kernels of the pixels of some rows of a matte. Scratch of one thread.
class KernelField {
 public:
  static constexpr int kReach = 2;  ///< pixels around one that count for its direction, x and y

  KernelField(const Matte& matte, const AnisotropicKernel& kernel);
  /// Looks at the hair in and around rows first ≤ y < last, before they are asked for.
  void load(int first, int last);
  /// Of a pixel of matte.hair; none where nothing is known of its direction.
  KernelChoice at(int x, int y) const;

 private:
  const Matte& matte_;
  bool adapts_;
  int first_ = 0;           // row that the sums begin with
  std::vector<Vec4> hair_;  // of one row, kReach pixels more on either side: direction (doubled), thickness, 1; 0 without hair
  std::vector<Vec4> sums_;  // [row − first_ + kReach][width] of those within kReach in x
};

}  // namespace pelage
