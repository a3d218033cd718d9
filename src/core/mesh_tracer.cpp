#include "core/mesh_tracer.h"

#include <embree3/rtcore.h>
#include <pelage/error.h>

#include <algorithm>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
struct MeshTracer::State {
  std::vector<WorldMesh> meshes;
  Bounds bounds;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void build();
};

void MeshTracer::State::build() {
  device = rtcNewDevice(nullptr);
  if (!device) throw Error("ray tracing", "Embree", "no device could be made", "check the Embree installation");
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  for (const WorldMesh& mesh : meshes) attach(device, scene, mesh);
  arena().execute([&] { rtcCommitScene(scene); });
  check_device(device);
}

MeshTracer::MeshTracer(const std::vector<MeshInstance>& meshes) : state_(std::make_unique<State>()) {
  state_->meshes = world_meshes(meshes);
  bool any = false;
  for (const WorldMesh& mesh : state_->meshes) {
    state_->bounds.extend(pelage::bounds(mesh));
    any = any || !mesh.triangles.empty();
  }
  if (any) state_->build();
}

MeshTracer::~MeshTracer() = default;
MeshTracer::MeshTracer(MeshTracer&&) noexcept = default;
MeshTracer& MeshTracer::operator=(MeshTracer&&) noexcept = default;

bool MeshTracer::empty() const { return state_->scene == nullptr; }
const Bounds& MeshTracer::bounds() const { return state_->bounds; }

std::size_t MeshTracer::bytes() const { return resident_bytes(state_->meshes); }

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

Surface MeshTracer::surface(const RayHit& hit) const { return surface_at(state_->meshes[hit.mesh], hit); }

}  // namespace pelage
