#include "groom/mannequin.h"

#include <pelage/grow.h>

#include "core/parallel.h"
#include "groom/head_shape.h"
#include "groom/surface_nets.h"

namespace pelage {
namespace groom {
namespace {

/// Moves `p` onto the surface along its normal (Newton), at most `limit` away from where it was, and returns the normal.
Vec3 settle(Vec3& p, float limit) {
  const Vec3 start = p;
  Vec3 normal = head_normal(p);
  for (int i = 0; i < 3; ++i) {
    const Vec3 moved = p - normal * head_distance(p);
    if (length(moved - start) > limit) break;
    p = moved, normal = head_normal(p);
  }
  return normal;
}

Mannequin make_mannequin() {
  constexpr float kSpacing = 0.0034f;  // about 35,000 triangles
  Mannequin m;
  m.grid = bake_distance(head_distance, kHeadLower, kHeadUpper, kSpacing);
  m.mesh = surface_nets(m.grid);
  const std::size_t count = m.mesh.positions.size();
  m.mesh.normals.resize(count), m.mesh.uv.resize(count);
  parallel_for(count, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      m.mesh.normals[i] = settle(m.mesh.positions[i], 0.5f * kSpacing);
      m.mesh.uv[i] = head_uv(m.mesh.positions[i]);
    }
  });
  return m;
}

}  // namespace

const Mannequin& mannequin() {
  static const Mannequin made = make_mannequin();
  return made;
}

bool is_mannequin(const TriangleMesh& mesh) {
  const TriangleMesh& head = mannequin().mesh;
  if (mesh.positions.size() != head.positions.size() || mesh.triangles != head.triangles) return false;
  for (std::size_t i = 0; i < head.positions.size(); ++i)
    if (!(length(mesh.positions[i] - head.positions[i]) < 1e-4f)) return false;
  return true;
}

}  // namespace groom

TriangleMesh mannequin_head() { return groom::mannequin().mesh; }

}  // namespace pelage
