// The environment in two forms: a few directional pieces with a spread (for strands, each with its own maps) and nine
// spherical harmonics of irradiance (for opaque surfaces).
#pragma once

#include <pelage/scene.h>

#include <array>
#include <vector>

namespace pelage {

/// A region of the sky, as a light.
struct EnvironmentPiece {
  Vec3 from;        ///< unit direction to the region's center of power
  Vec3 irradiance;  ///< ∫ radiance over its solid angle, W/m² on a surface that faces it
  float spread;     ///< radians, standard deviation of its directions about `from`, per axis
};

/// A piece of the sky as small as anything here looks at it.
struct SkyTexel {
  Vec3 direction;     ///< unit length
  Vec3 power;         ///< radiance · solid angle
  float luminance;    ///< of power
  float solid_angle;  ///< steradians; their sum is 4π
};

/// The environment averaged down to 128 × 64 texels, row by row from straight up. Negative radiance counts as none.
std::vector<SkyTexel> sky_texels(const Environment& environment);

/// Cuts the environment into 2^levels regions of about equal power: median cut (Debevec 2005; references.bib:
/// Debevec2005MedianCut). Bright small sources get small pieces, an even sky even ones. Black pieces are left out.
std::vector<EnvironmentPiece> cut_environment(const Environment& environment, int levels);

/// Coefficients of irradiance over the surface normal: E(n) = Σ c_i·Y_i(n), see kernel/light/irradiance.h.
std::array<Vec3, 9> irradiance_harmonics(const Environment& environment);

}  // namespace pelage
