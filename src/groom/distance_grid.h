// A distance field sampled once and looked up many times; also the input of the mesher.
#pragma once

#include <pelage/vec.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage::groom {

/// Samples of a signed distance at the corners of cubic cells; x runs fastest.
struct DistanceGrid {
  Vec3 origin;                  ///< place of sample (0, 0, 0), metres
  float spacing = 1;            ///< metres
  int nx = 0, ny = 0, nz = 0;   ///< samples per axis, each ≥ 2
  std::vector<float> distance;  ///< [nz·ny·nx] metres, negative inside

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(x);
  }
  Vec3 place(int x, int y, int z) const {
    return origin + Vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) * spacing;
  }
};

/// Samples `field` on the cells that cover [lower, upper].
DistanceGrid bake_distance(float (*field)(Vec3), Vec3 lower, Vec3 upper, float spacing);

struct DistanceSample {
  float distance;  ///< metres
  Vec3 gradient;   ///< not normalised
};
/// Trilinear distance and its gradient; outside the grid the nearest border value plus the distance to the box.
DistanceSample sample_distance(const DistanceGrid& grid, Vec3 p);

}  // namespace pelage::groom
