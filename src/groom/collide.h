// What hair keeps clear of.
#pragma once

#include <algorithm>

#include "groom/distance_grid.h"
#include "groom/sdf.h"

namespace pelage::groom {

/// Moves `p` out to `clearance` metres from the surface of `grid`.
inline Vec3 push_out(const DistanceGrid& grid, Vec3 p, float clearance) {
  const DistanceSample skin = sample_distance(grid, p);
  return skin.distance < clearance ? p + normalize(skin.gradient) * (clearance - skin.distance) : p;
}

/// Where there is no distance field: keeps `p` over the skin around the root, which is taken for a ball as flat as the
/// body of diagonal `size` lets expect.
inline Vec3 keep_above(Vec3 root, Vec3 normal, float size, Vec3 p, float clearance) {
  const Vec3 d = p - root;
  const float lowest = clearance - dot(d, d) * (2 / size);
  const float height = dot(d, normal);
  return height < lowest ? p + normal * (lowest - height) : p;
}

/// Keeps fringe and side hair out of the face: an invisible bulge in front of it. `share` 0…1 of the way out, which
/// leads forward or to the side and never back into the head.
inline Vec3 push_out_of_face(Vec3 p, float share) {
  constexpr Vec3 center(0, -0.060f, 0.135f), radii(0.105f, 0.140f, 0.105f);
  const Vec3 local = p - center;
  const float distance = sd_ellipsoid(local, radii);
  const Vec3 way = Vec3(local.x, local.y, std::max(local.z, 0.01f)) / (radii * radii);
  return distance < 0 ? p - normalize(way) * (distance * share) : p;
}

}  // namespace pelage::groom
