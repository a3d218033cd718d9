#include "groom/mannequin.h"

#include <pelage/grow.h>

#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "groom/head_shape.h"
#include "groom/scalp.h"
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

/// The mesher works on a warped grid whose cells are finest at the face: 3 mm there, 5 mm at the back, 10 mm at the
/// shoulders' ends. Monotone in every axis.
Vec3 warp(Vec3 q) {
  const float side = q.x + 60 * q.x * q.x * q.x, height = q.y + 28 * q.y * q.y * q.y, depth = q.z + 2.2f * q.z * q.z;
  return {side, height - 0.035f, 0.115f - depth};
}
constexpr Vec3 kWarpedLower{-0.116f, -0.166f, -0.012f}, kWarpedUpper{0.116f, 0.130f, 0.190f};

float warped_head_distance(Vec3 q) { return head_distance(warp(q)); }

Mannequin make_mannequin() {
  Mannequin m;
  m.grid = bake_distance(head_distance, kHeadLower, kHeadUpper, 0.0034f);
  m.mesh = surface_nets(bake_distance(warped_head_distance, kWarpedLower, kWarpedUpper, 0.0030f));
  // warp() turns z around, and with it every triangle.
  for (auto& triangle : m.mesh.triangles) std::swap(triangle[1], triangle[2]);
  const std::size_t count = m.mesh.positions.size();
  m.mesh.normals.resize(count), m.mesh.uv.resize(count);
  parallel_for(count, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      m.mesh.positions[i] = warp(m.mesh.positions[i]);
      m.mesh.normals[i] = settle(m.mesh.positions[i], 0.003f);
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

bool grown_on_mannequin(const StrandSet& strands) {
  constexpr std::size_t kLooks = 512;            // roots looked at, all over the groom
  constexpr float kSkin = 2e-3f, kEdge = 4e-3f;  // metres: chords of the mesh, and its triangles across the hairline
  const std::size_t count = strands.strand_count(), stride = count / kLooks + 1;
  for (std::size_t i = 0; i < count; i += stride) {
    const Vec3 root = strands.points[strands.offsets[i]];
    if (!(std::abs(groom::head_distance(root)) < kSkin && groom::hairline_distance(root) > -kEdge)) return false;
  }
  return count > 0;
}

}  // namespace pelage
