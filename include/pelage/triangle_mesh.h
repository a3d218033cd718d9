// Opaque geometry: heads, bodies, props.
#pragma once

#include <pelage/vec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pelage {

/// Indexed triangles, counter-clockwise from outside. Metres, Y up.
struct TriangleMesh {
  std::vector<Vec3> positions;                          ///< [vertex_count]
  std::vector<Vec3> normals;                            ///< [0] (flat) or [vertex_count]; unit length
  std::vector<Vec2> uv;                                 ///< [0] or [vertex_count]; origin bottom left
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< each index < vertex_count
};

Bounds bounds(const TriangleMesh& mesh);

}  // namespace pelage
