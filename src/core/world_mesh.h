// The opaque meshes of a scene in world space: what rays are traced against, and the surface where they hit.
#pragma once

#include <embree3/rtcore.h>
#include <pelage/scene.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/ray.h"

namespace pelage {

/// What shading needs to know of a hit.
struct Surface {
  Vec3 position;  ///< metres, world
  Vec3 lifted;    ///< metres, world; where the smooth surface is that `normal` belongs to, on its outer side: there rays
                  ///< toward lights begin, or facets would shade each other where light grazes
  Vec3 normal;    ///< shading normal, unit length, on the side that the triangle's winding calls outside
  Vec3 geometric_normal;  ///< the triangle's own, unit length, same side as `normal`
  Vec3 color;             ///< diffuse reflectance, linear
};

/// A mesh in world space. Positions are padded by one: Embree reads 16 bytes at the last vertex.
struct WorldMesh {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uv;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::shared_ptr<const Image> texture;
  Vec3 color;
};

std::vector<WorldMesh> world_meshes(const std::vector<MeshInstance>& instances);

/// Box of the vertices.
Bounds bounds(const WorldMesh& mesh);
/// Bytes held by the arrays.
std::size_t resident_bytes(const std::vector<WorldMesh>& meshes);

/// Makes the triangles a geometry of `scene`; its number is the next free one. `mesh` must outlive the scene.
void attach(RTCDevice device, RTCScene scene, const WorldMesh& mesh);

/// Throws Error where the device has met one since the last call.
void check_device(RTCDevice device);

/// The surface at a hit of the mesh.
Surface surface_at(const WorldMesh& mesh, const RayHit& hit);

}  // namespace pelage
