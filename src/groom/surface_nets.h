// Triangles of an implicit surface.
#pragma once

#include <pelage/triangle_mesh.h>

#include "groom/distance_grid.h"

namespace pelage::groom {

/// Closed mesh of the zero set of `grid` by naive surface nets (Gibson 1998; references.bib: Gibson1998SurfaceNets): one
/// vertex per cell that the surface crosses, one quad per crossed grid edge. Positions and triangles only.
///
/// The surface must stay one cell away from the grid's border. Vertices lie at the mean of the cell's edge crossings.
TriangleMesh surface_nets(const DistanceGrid& grid);

}  // namespace pelage::groom
