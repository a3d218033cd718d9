// What the coat of an opaque surface reflects of light that comes from everywhere.
#pragma once

#include <array>
#include <cstddef>

namespace pelage {

/// Largest difference of CoatAlbedo from the integral, for alpha in [0.1, 1] and cosines from 0.05 on: the first number, and the
/// second times f0.
inline constexpr float kCoatAlbedoMaxAbsError = 3e-3f, kCoatAlbedoMaxErrorOfMirrors = 0.05f;

/// The integral of shade_ggx() (kernel/shade/surface.h) over the directions of light, tabulated over the eye's cosine.
class CoatAlbedo {
 public:
  /// f0, alpha: as for shade_ggx(); rougher than a mirror.
  CoatAlbedo(float f0, float alpha);

  /// cos_eye: of the eye's angle to the normal, clamped to 0…1.
  float seen_from(float cos_eye) const;

 private:
  static constexpr std::size_t kCells = 32;
  std::array<float, kCells + 1> values_;  ///< at evenly spaced cosines
};

}  // namespace pelage
