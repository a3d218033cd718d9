// An opaque surface as the path tracer sees it: what raster draws (kernel/shade/surface.h), with a density to sample by.
#pragma once

#include <pelage/vec.h>

#include <array>

#include "reference/fiber_bsdf.h"

namespace pelage {

/// Lambert below a GGX coat, seen from one direction. The interface is FiberBsdf's; its one lobe has the number kLobe.
class SurfaceBsdf {
 public:
  static constexpr int kLobe = 4;

  /// normal: shading normal, unit length, on the eye's side. to_eye: unit length. specular: reflectance at normal incidence.
  SurfaceBsdf(Vec3 normal, Vec3 to_eye, Vec3 color, float specular, float roughness);

  Vec3 evaluate(Vec3 to_light) const;
  Vec3 evaluate_lobe(Vec3 to_light, int lobe) const { return lobe == kLobe ? evaluate(to_light) : Vec3(); }
  float pdf(Vec3 to_light) const;
  FiberSample sample(std::array<float, 4> u) const;
  /// Of the diffuse part, plus the reflectance at normal incidence.
  Vec3 albedo() const { return diffuse_ + Vec3(specular_, specular_, specular_); }

 private:
  Vec3 normal_, tangent_, bitangent_, to_eye_;
  Vec3 diffuse_;  ///< reflectance
  float specular_, roughness_;
  float choose_diffuse_;  ///< probability to sample the diffuse part
};

}  // namespace pelage
