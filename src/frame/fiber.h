// From the scene's hair material to what the scattering kernels take.
#pragma once

#include <pelage/scene.h>

#include "kernel/scalar.h"

namespace pelage {

/// Absorption of a strand per fiber radius. `strand_color` is used for ColorSource::kStrand alone.
inline Vec3 fiber_absorption(const HairMaterial& m, Vec3 strand_color) {
  switch (m.color_source) {
    case HairMaterial::ColorSource::kMelanin: return kernel::scatter_melanin(m.eumelanin, m.pheomelanin);
    case HairMaterial::ColorSource::kRgb: return kernel::scatter_absorption(m.color, m.beta_azimuthal);
    case HairMaterial::ColorSource::kStrand: break;
  }
  return kernel::scatter_absorption(strand_color, m.beta_azimuthal);
}

/// The fiber of a strand of color `strand_color`. Pure; thread-safe.
inline kernel::ScatterFiber make_fiber(const HairMaterial& m, Vec3 strand_color) {
  return kernel::scatter_fiber(m.eta, m.beta_longitudinal, m.beta_azimuthal, m.cuticle_tilt, m.specular_gain,
                               fiber_absorption(m, strand_color));
}

}  // namespace pelage
