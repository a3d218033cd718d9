// Strands at equal shares of their length: what clusters, cross-sections and skinning look at.
#pragma once

#include <pelage/lod.h>

#include <cstddef>
#include <span>
#include <vector>

namespace pelage {

/// Every strand as a Catmull-Rom spline of LodHierarchy::kPoints control points, uniform in arc length. Its control points lie on
/// the spline: "the k-th control points" of a cluster are places that belong together.
struct Stations {
  static constexpr std::size_t kPoints = LodHierarchy::kPoints;
  std::vector<Vec3> points;  ///< [strand_count·kPoints] metres; the first is the root, the last the tip, to the bit
  std::vector<float> radii;  ///< [strand_count·kPoints] metres
  std::vector<float>
      strays;  ///< [strand_count·kPoints] how far the strand's curve leaves the spline between the middles of the
               ///< spans around, metres: curls that are finer than the control points
  std::vector<float> lengths;  ///< [strand_count] of the strand's curve, metres

  std::size_t strand_count() const { return points.size() / kPoints; }
  const Vec3* strand(std::size_t s) const { return &points[s * kPoints]; }
  const float* radius(std::size_t s) const { return &radii[s * kPoints]; }
  const float* stray(std::size_t s) const { return &strays[s * kPoints]; }
};

/// The splines with the least sum of squared distances to points of the strands' curves (Huang 2025, section 5.1, step 1).
/// O(points), in parallel; the same for any thread count.
Stations fit_stations(const StrandSet& strands, const Progress& progress);

/// Control points of the uniform cubic B-spline, with StrandSet's clamped ends, that runs through `stations` at its knots. Both
/// [kPoints]; may be the same.
void bspline_through(const Vec3* stations, Vec3* control);

}  // namespace pelage
