#include <pelage/triangle_mesh.h>

namespace pelage {

Bounds bounds(const TriangleMesh& mesh) {
  Bounds b;
  for (const Vec3 p : mesh.positions) b.extend(p);
  return b;
}

}  // namespace pelage
