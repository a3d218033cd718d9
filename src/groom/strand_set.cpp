#include <pelage/strand_set.h>

namespace pelage {

Bounds bounds(const StrandSet& strands) {
  Bounds b;
  for (const Vec3 p : strands.points) b.extend(p);
  return b;
}

}  // namespace pelage
