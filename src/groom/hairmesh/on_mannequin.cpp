#include <pelage/hair_mesh_styles.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "groom/head_shape.h"
#include "groom/scalp.h"

namespace pelage {

bool grown_on_mannequin(const HairMesh& mesh) {
  constexpr float kSkin = 9e-3f, kEdge = 12e-3f;  // metres: chords of quads, and quads across the hairline
  constexpr std::size_t kStray = 20;              // one root of so many: corners of fitted meshes
  constexpr float kRoots = 2000;
  const float share = std::min(1.f, kRoots / static_cast<float>(strand_count(mesh)));
  const StrandSet strands = expand(mesh, {.points = 2, .share = share});
  std::size_t elsewhere = 0;
  for (std::size_t s = 0; s < strands.strand_count(); ++s) {
    const Vec3 root = strands.points[strands.offsets[s]];
    elsewhere += !(std::abs(groom::head_distance(root)) < kSkin && groom::hairline_distance(root) > -kEdge);
  }
  return elsewhere * kStray <= strands.strand_count();
}

}  // namespace pelage
