// From the scene's hair material to what the scattering kernels take.
#pragma once

#include <pelage/scene.h>

#include <algorithm>

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

/// Color of a dense tuft of hair with that absorption: what tints the diffuse lobe of kKajiyaKay.
inline Vec3 tuft_color(const HairMaterial& m, Vec3 absorption) {
  return kernel::scatter_tuft_color(absorption, m.beta_azimuthal);
}

/// Sadeghi's lobes before the hair's color. Intensities are scaled down together where they would make light.
inline kernel::ScatterArtistFiber make_artist_fiber(const HairMaterial& m) {
  const ArtistLobes& a = m.artist;
  const float scale = 1 / std::max(1.f, a.r.intensity + a.tt.intensity + a.trt.intensity + a.glint_intensity);
  kernel::ScatterArtistFiber f;
  f.a_r = a.r.color * (a.r.intensity * scale);
  f.a_tt = a.tt.color * (a.tt.intensity * scale);
  f.a_trt = a.trt.color * (a.trt.intensity * scale);
  f.a_glint = a.trt.color * (a.glint_intensity * scale);
  f.shift_r = a.r.shift, f.shift_tt = a.tt.shift, f.shift_trt = a.trt.shift;
  f.width_r = a.r.width, f.width_tt = a.tt.width, f.width_trt = a.trt.width;
  f.around_tt = a.tt_azimuthal_width, f.around_glint = a.glint_width;
  f.glint_angle = a.glint_angle;
  return f;
}

}  // namespace pelage
