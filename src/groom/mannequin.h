// The mannequin's mesh and its distance grid, made once per process.
#pragma once

#include <pelage/triangle_mesh.h>

#include "groom/distance_grid.h"

namespace pelage::groom {

struct Mannequin {
  TriangleMesh mesh;
  DistanceGrid grid;  ///< of the same surface; what hair collides with
};
/// Thread-safe; made on first use (about 0.3 s on one core).
const Mannequin& mannequin();

/// Whether `mesh` is mannequin_head(), also after a trip through a text file: same topology, places within 0.1 mm.
bool is_mannequin(const TriangleMesh& mesh);

}  // namespace pelage::groom
