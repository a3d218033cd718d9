// The strands that a hair mesh is fitted to, by arc length.
#pragma once

#include <pelage/progress.h>
#include <pelage/strand_set.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage {

/// A sample of a groom as polylines of equally many points, uniform in arc length. Strands of no length are left out.
struct FitStrands {
  static constexpr std::size_t kPoints = 128;
  std::vector<Vec3> points;    ///< [count][kPoints] metres
  std::vector<float> lengths;  ///< [count] metres
  std::vector<float> widths;   ///< [count][kWidths] diameters, metres, uniform in arc length
  std::vector<Vec3> groom_uv;  ///< [count] place in the groom, 0…1; z is 0
  double size = 0;             ///< diagonal of their box, metres
  static constexpr std::size_t kWidths = 9;

  std::size_t count() const { return lengths.size(); }
  const Vec3* strand(std::size_t s) const { return &points[s * kPoints]; }
  /// Point at share `t` 0…1 of the strand's length.
  Vec3 at(std::size_t s, float t) const;
};

/// `most` strands at most, spread evenly over the groom. The place in the groom is root_uv where there is one in 0…1, else the
/// place of the root in the box of all roots, seen from above.
FitStrands sample_strands(const StrandSet& set, std::uint32_t most, const Progress& progress);

}  // namespace pelage
