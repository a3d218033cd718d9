// A hair mesh for a groom that has none: its strands gathered into bundles, a cage around each, and operators for what a cage
// cannot follow.
#pragma once

#include <pelage/hair_mesh.h>
#include <pelage/progress.h>
#include <pelage/strand_set.h>

#include <cstddef>
#include <cstdint>

namespace pelage {

/// What to fit. fit_hair_mesh() throws an Error that names the setting and its range when one is outside it.
struct HairMeshFitSettings {
  std::uint32_t bundles = 0;     ///< 1…65536, four columns each; 0: as many as `bytes` hold
  std::uint32_t layers = 10;     ///< of a column, 2…64
  std::uint32_t bytes = 20000;   ///< of the binary file, about, 1000…100,000,000; where `bundles` is 0
  std::uint32_t styles = 4;      ///< that bundles share, 1…64
  std::uint32_t sample = 30000;  ///< strands that are looked at, 1…1,000,000; spread evenly over the groom's
  std::uint32_t seed = 1;        ///< of the clusters and of the new strands
  bool operators = true;         ///< false: the cage alone
  bool occlusion = true;         ///< bake_occlusion() at the end
};

/// How near the fit comes. Distances in metres.
struct HairMeshFitReport {
  std::uint64_t strands = 0;  ///< of the groom, and of the hair mesh
  std::uint32_t sampled = 0, bundles = 0, layers = 0, vertices = 0, styles = 0;
  double size = 0;  ///< diagonal of the box of the sampled strands

  /// From points of the groom's strands to the cage's base strand of the same place (u, v) at the same w.
  double base_rms = 0, base_p95 = 0;
  /// The same, in parts: what varies slowly along a strand (over half of it or more), and the curls and frizz above that.
  double slow_rms = 0, fast_rms = 0;
  /// How far the operators move the hair mesh's strands off their base: about base_rms where they stand for what is missing.
  double operator_rms = 0;
  /// Area that the groom and the hair mesh both cover over that which either does, mean of the views along three axes.
  double silhouette_overlap = 0;
};

/// A hair mesh of as many strands as `strands`, whose cage follows them and whose operators have the amounts, frequencies and
/// variations that they have on the average of each style. Strands are not those of the groom one by one: their number, place
/// and shape are alike. Colors and transparency are not kept. The same bits for any thread count.
///
/// Throws Error where there are no strands, or more than 2²⁰ a bundle. Seconds for 100,000 strands.
HairMesh fit_hair_mesh(const StrandSet& strands, const HairMeshFitSettings& settings = {}, HairMeshFitReport* report = nullptr,
                       const Progress& progress = {});

}  // namespace pelage
