// How far models of a bundle's scattering are from traced bundles: one place for the benchmark, the plots and the tests.
#pragma once

#include <string>
#include <vector>

#include "reference/fiber_cluster.h"

namespace pelage {

/// A bundle, its hairs and from where it is seen.
struct AggregatePanel {
  std::string name;  ///< family.color.section.density
  ClusterShape shape;
  HairMaterial material;
  float theta_o = 0;
};

/// Both families of lobes, four colors, circles and ellipses of 4 : 1 seen from both sides, dense and sparse.
std::vector<AggregatePanel> aggregate_panels();

struct AggregateModel {
  enum class Kind { kOurs, kHuang, kZhu2023, kZhu2023Narrow };
  enum class Crossings { kHuang, kBuffon };
  std::string name;
  Kind kind = Kind::kOurs;
  Crossings crossings = Crossings::kBuffon;
  kernel::ScatterAggregateTerms terms = kernel::scatter_terms_huang();  ///< of kHuang
};

/// Ours; the paper's with each formula for n, without A_1+, without S, with the densities of dual scattering (d_F = d_B = 0.7) and with
/// fitted constants; the four readings of Zhu 2023.
std::vector<AggregateModel> aggregate_models();

kernel::ScatterBundle bundle_of(const ClusterShape& shape, AggregateModel::Crossings crossings);
/// What a model scatters by cells, as ClusterScattering::energy: of rays that meet a hair.
std::vector<Vec3> model_energies(const AggregatePanel& panel, const AggregateModel& model);

/// Energies over one angle, summed over the other.
struct AggregateProfiles {
  std::vector<Vec3> azimuth;  ///< [kAzimuths] over |φ|
  std::vector<Vec3> lit;      ///< [kInclinations] over θ_i, of |φ| < π/2
  std::vector<Vec3> through;  ///< [kInclinations] over θ_i, of |φ| > π/2
};
AggregateProfiles profiles_of(const std::vector<Vec3>& energies);

/// Sum of |a − b| over all channels over that of b, of each profile.
struct ProfileErrors {
  double azimuth = 0, lit = 0, through = 0;
};
ProfileErrors errors_of(const AggregateProfiles& model, const AggregateProfiles& truth);

/// Of each profile the least error that a reading of Zhu 2023 has.
ProfileErrors best_of_zhu_2023(const AggregatePanel& panel, const AggregateProfiles& truth);

}  // namespace pelage
