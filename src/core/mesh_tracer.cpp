#include "core/mesh_tracer.h"

#include <embree3/rtcore.h>
#include <pelage/error.h>

#include <algorithm>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

/// A mesh in world space. Positions are padded: Embree reads 16 bytes at the last vertex.
struct WorldMesh {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uv;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::shared_ptr<const Image> texture;
  Vec3 color;
};

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

struct MeshTracer::State {
  std::vector<WorldMesh> meshes;
  Bounds bounds;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void attach(const WorldMesh& mesh);
  void build();
};

void MeshTracer::State::attach(const WorldMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, sizeof(Vec3),
                             mesh.positions.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             3 * sizeof(std::uint32_t), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void MeshTracer::State::build() {
  device = rtcNewDevice(nullptr);
  if (!device) throw Error("ray tracing", "Embree", "no device could be made", "check the Embree installation");
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  for (const WorldMesh& mesh : meshes) attach(mesh);
  arena().execute([&] { rtcCommitScene(scene); });
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw Error("ray tracing", "Embree", fmt::format("error {} while building", static_cast<int>(error)), "");
}

MeshTracer::MeshTracer(const std::vector<MeshInstance>& meshes) : state_(std::make_unique<State>()) {
  bool any = false;
  for (const MeshInstance& instance : meshes) {
    state_->meshes.push_back(to_world(instance));
    const WorldMesh& mesh = state_->meshes.back();
    for (std::size_t i = 0; i + 1 < mesh.positions.size(); ++i) state_->bounds.extend(mesh.positions[i]);
    any = any || !mesh.triangles.empty();
  }
  if (any) state_->build();
}

MeshTracer::~MeshTracer() = default;
MeshTracer::MeshTracer(MeshTracer&&) noexcept = default;

bool MeshTracer::empty() const { return state_->scene == nullptr; }
const Bounds& MeshTracer::bounds() const { return state_->bounds; }

std::size_t MeshTracer::bytes() const {
  std::size_t total = 0;
  for (const WorldMesh& m : state_->meshes)
    total += (m.positions.capacity() + m.normals.capacity()) * sizeof(Vec3) + m.uv.capacity() * sizeof(Vec2) +
             m.triangles.capacity() * 3 * sizeof(std::uint32_t);
  return total;
}

namespace {

/// Fills the structure-of-arrays packet; lanes beyond the rays are masked out.
void load_packet(std::span<const Ray> rays, RTCRay16& packet, int (&valid)[MeshTracer::kPacket]) {
  PELAGE_CHECK_LE(rays.size(), MeshTracer::kPacket);
  for (std::size_t i = 0; i < MeshTracer::kPacket; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const Ray ray = i < rays.size() ? rays[i] : Ray{{}, {0, 0, 1}};
    packet.org_x[i] = ray.origin.x, packet.org_y[i] = ray.origin.y, packet.org_z[i] = ray.origin.z;
    packet.dir_x[i] = ray.direction.x, packet.dir_y[i] = ray.direction.y, packet.dir_z[i] = ray.direction.z;
    packet.tnear[i] = ray.near, packet.tfar[i] = ray.far;
    packet.time[i] = 0, packet.mask[i] = ~0u, packet.id[i] = 0, packet.flags[i] = 0;
  }
}

}  // namespace

void MeshTracer::trace(std::span<const Ray> rays, std::span<RayHit> hits) const {
  PELAGE_CHECK_EQ(rays.size(), hits.size());
  std::fill(hits.begin(), hits.end(), RayHit{});
  if (empty()) return;
  alignas(64) RTCRayHit16 packet;
  alignas(64) int valid[kPacket];
  load_packet(rays, packet.ray, valid);
  std::fill(std::begin(packet.hit.geomID), std::end(packet.hit.geomID), RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, state_->scene, &context, &packet);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = {packet.ray.tfar[i], packet.hit.geomID[i], packet.hit.primID[i], packet.hit.u[i], packet.hit.v[i]};
  }
}

void MeshTracer::occluded(std::span<const Ray> rays, std::span<bool> result) const {
  PELAGE_CHECK_EQ(rays.size(), result.size());
  std::fill(result.begin(), result.end(), false);
  if (empty()) return;
  alignas(64) RTCRay16 packet;
  alignas(64) int valid[kPacket];
  load_packet(rays, packet, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, state_->scene, &context, &packet);
  for (std::size_t i = 0; i < rays.size(); ++i) result[i] = packet.tfar[i] < 0;
}

Surface MeshTracer::surface(const RayHit& hit) const {
  const WorldMesh& mesh = state_->meshes[hit.mesh];
  const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.triangle];
  Surface s;
  s.position = corner_blend(mesh.positions, t, hit);
  s.geometric_normal =
      normalize(cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]));
  s.normal = mesh.normals.empty() ? s.geometric_normal : normalize(corner_blend(mesh.normals, t, hit));
  // Files disagree about winding; stored normals are what their artist saw.
  if (dot(s.geometric_normal, s.normal) < 0) s.geometric_normal = -s.geometric_normal;
  s.color = mesh.color;
  if (mesh.texture && mesh.texture->width > 0 && !mesh.uv.empty()) {
    const Vec2 uv = mesh.uv[t[0]] * (1 - hit.u - hit.v) + mesh.uv[t[1]] * hit.u + mesh.uv[t[2]] * hit.v;
    s.color = s.color * sample_texture(*mesh.texture, uv);
  }
  return s;
}

}  // namespace pelage
