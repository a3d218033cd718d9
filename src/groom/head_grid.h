// Signed distances to any mesh, on a grid.
#pragma once

#include <pelage/progress.h>
#include <pelage/triangle_mesh.h>

#include "groom/distance_grid.h"

namespace pelage {

class HeadShape {
 public:
  groom::DistanceGrid grid;
};

namespace groom {

/// Point of triangle abc that is nearest to p, and which part of it that is: bit c is set where corner c has a share of it.
struct NearestOnTriangle {
  Vec3 point;
  unsigned corners = 0;
};
NearestOnTriangle nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

/// Distances to `mesh`, whose indices are in range, at the corners of about `cells` cells along its longest side, and a margin of three around.
/// Signs are those of angle-weighted normals (Bærentzen 2005; references.bib: Baerentzen2005Signed), so an open mesh has an inside behind
/// its surface; a mesh that winds the other way is turned over. Within a cell of the surface distances are exact, farther off they
/// are those to a triangle that is nearest to a neighbor, which is the nearest nearly everywhere.
DistanceGrid mesh_distance(const TriangleMesh& mesh, int cells, const Progress& progress);

}  // namespace groom
}  // namespace pelage
