// Mean forward attenuation of a fiber, tabulated once per material: what light loses at each hair on its way through
// hair.
#pragma once

#include <pelage/scene.h>

#include <vector>

#include "kernel/scalar.h"

namespace pelage {

/// a_f(cos θ, σ_a) of one material, for every color: channels and strands differ in σ_a alone.
struct ForwardAttenuationTable {
  std::vector<float> a_f;  ///< [kScatterTableRows · kScatterTableColumns], 0…1; row-major, cos θ by rows

  /// Bilinear, within kScatterTableMaxAbsError of quadrature. cos_theta 0…1, sigma_a ≥ 0. Wide code does the same with
  /// kernel/scatter/table.h and gathers.
  float lookup(float cos_theta, float sigma_a) const {
    const kernel::ScatterTableCell c = kernel::scatter_table_cell(cos_theta, sigma_a);
    const float* v = a_f.data() + static_cast<std::size_t>(c.index);
    const auto columns = static_cast<std::size_t>(kernel::kScatterTableColumns);
    return kernel::scatter_table_mix(c, v[0], v[1], v[columns], v[columns + 1]);
  }
};

/// Mean share of light that goes on into the forward half circle of azimuths; exact to quadrature (double, converged).
/// The model decides the azimuthal lobes: Zhu has its own, Chiang has Marschner's. Zinke 2008, eq. 6; docs/derivations/dual_scattering.md.
double forward_attenuation(const HairMaterial& material, double cos_theta, double sigma_a);

/// Deterministic; about 10 ms of processor time, once for each of the last 64 materials. Safe to call from several threads.
ForwardAttenuationTable forward_attenuation_table(const HairMaterial& material);

}  // namespace pelage
