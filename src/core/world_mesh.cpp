#include "core/world_mesh.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <cmath>

namespace pelage {
namespace {

/// Normals of a similarity transform turn like vectors; only their length changes.
WorldMesh to_world(const MeshInstance& instance) {
  const TriangleMesh& mesh = *instance.mesh;
  WorldMesh world{{}, {}, mesh.uv, mesh.triangles, instance.texture, instance.color};
  world.positions.reserve(mesh.positions.size() + 1);
  for (const Vec3 p : mesh.positions) world.positions.push_back(transform_point(instance.transform, p));
  for (const Vec3 n : mesh.normals) world.normals.push_back(normalize(transform_vector(instance.transform, n)));
  world.positions.emplace_back();
  return world;
}

Vec3 corner_blend(const std::vector<Vec3>& values, const std::array<std::uint32_t, 3>& t, const RayHit& hit) {
  return values[t[0]] * (1 - hit.u - hit.v) + values[t[1]] * hit.u + values[t[2]] * hit.v;
}

/// `p`, moved out of every corner's tangent plane that it lies below, as much as the corner has a share in it: Hanika 2021
/// (references.bib: Hanika2021Terminator).
Vec3 lifted(const WorldMesh& mesh, const std::array<std::uint32_t, 3>& t, const RayHit& hit, Vec3 p) {
  if (mesh.normals.empty()) return p;
  const std::array<float, 3> shares{1 - hit.u - hit.v, hit.u, hit.v};
  Vec3 offset;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 n = mesh.normals[t[k]];
    offset += n * (shares[k] * std::max(dot(mesh.positions[t[k]] - p, n), 0.f));
  }
  return p + offset;
}

/// Bilinear, repeating look-up; texture rows run from the top, v from the bottom.
Vec3 sample_texture(const Image& image, Vec2 uv) {
  const auto fold = [](float t) { return t - std::floor(t); };
  const float x = fold(uv.x) * static_cast<float>(image.width) - 0.5f;
  const float y = (1 - fold(uv.y)) * static_cast<float>(image.height) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y);
  const auto texel = [&](float px, float py) {
    const int ix = (static_cast<int>(px) + image.width) % image.width;
    const int iy = (static_cast<int>(py) + image.height) % image.height;
    const float* c = image.at(ix, iy);
    return image.channel_count() >= 3 ? Vec3(c[0], c[1], c[2]) : Vec3(c[0], c[0], c[0]);
  };
  const Vec3 top = lerp(texel(x0, y0), texel(x0 + 1, y0), x - x0);
  const Vec3 bottom = lerp(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), x - x0);
  return lerp(top, bottom, y - y0);
}

}  // namespace

std::vector<WorldMesh> world_meshes(const std::vector<MeshInstance>& instances) {
  std::vector<WorldMesh> meshes;
  for (const MeshInstance& instance : instances) meshes.push_back(to_world(instance));
  return meshes;
}

Bounds bounds(const WorldMesh& mesh) {
  Bounds box;
  for (std::size_t i = 0; i + 1 < mesh.positions.size(); ++i) box.extend(mesh.positions[i]);
  return box;
}

std::size_t resident_bytes(const std::vector<WorldMesh>& meshes) {
  std::size_t total = 0;
  for (const WorldMesh& m : meshes)
    total += (m.positions.capacity() + m.normals.capacity()) * sizeof(Vec3) + m.uv.capacity() * sizeof(Vec2) +
             m.triangles.capacity() * 3 * sizeof(std::uint32_t);
  return total;
}

void attach(RTCDevice device, RTCScene scene, const WorldMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, sizeof(Vec3),
                             mesh.positions.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             3 * sizeof(std::uint32_t), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void check_device(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error("ray tracing", "Embree", fmt::format("error {} while building", static_cast<int>(error)), "");
}

Surface surface_at(const WorldMesh& mesh, const RayHit& hit) {
  const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.triangle];
  Surface s;
  s.position = corner_blend(mesh.positions, t, hit);
  s.geometric_normal =
      normalize(cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]));
  s.normal = mesh.normals.empty() ? s.geometric_normal : normalize(corner_blend(mesh.normals, t, hit));
  // Files disagree about winding; stored normals are what their artist saw.
  if (dot(s.geometric_normal, s.normal) < 0) s.geometric_normal = -s.geometric_normal;
  s.lifted = lifted(mesh, t, hit, s.position);
  s.color = mesh.color;
  if (mesh.texture && mesh.texture->width > 0 && !mesh.uv.empty()) {
    const Vec2 uv = mesh.uv[t[0]] * (1 - hit.u - hit.v) + mesh.uv[t[1]] * hit.u + mesh.uv[t[2]] * hit.v;
    s.color = s.color * sample_texture(*mesh.texture, uv);
  }
  return s;
}

}  // namespace pelage
