#include "reference/ray_scene.h"

#include <pelage/error.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

RTCGeometryType geometry_type(CurveBasis basis, CurveShape shape) {
  const bool flat = shape == CurveShape::kFlat;
  switch (basis) {
    case CurveBasis::kCatmullRom:
      return flat ? RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE : RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE;
    case CurveBasis::kBSpline: return flat ? RTC_GEOMETRY_TYPE_FLAT_BSPLINE_CURVE : RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE;
    case CurveBasis::kBezier: return flat ? RTC_GEOMETRY_TYPE_FLAT_BEZIER_CURVE : RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE;
    case CurveBasis::kLinear: break;
  }
  return flat ? RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE : RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE;
}

/// The point that continues a strand's end (CurveBasis, <pelage/strand_set.h>); radii do not become negative.
Vec4 phantom(Vec4 end, Vec4 next) {
  return {2 * end.x - next.x, 2 * end.y - next.y, 2 * end.z - next.z, std::max(2 * end.w - next.w, 0.f)};
}

/// Radii of a Bézier span run straight from its first to its last control point, as in every renderer of ours.
void straighten_radii(Vec4* points, std::size_t spans) {
  for (std::size_t s = 0; s < spans; ++s, points += 3) {
    points[1].w = points[0].w + (points[3].w - points[0].w) / 3;
    points[2].w = points[0].w + (points[3].w - points[0].w) * 2 / 3;
  }
}

Vec3 position(Vec4 p) { return {p.x, p.y, p.z}; }

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay r;
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z, r.tnear = ray.near;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z, r.tfar = ray.far;
  r.time = 0, r.mask = ~0u, r.id = 0, r.flags = 0;
  return r;
}

/// The ten lowest bits of x, two zeros before each.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// Place of p, relative to a box, on a curve that fills space (Morton's): neighbors on it are neighbors in space.
std::uint32_t place_on_curve(Vec3 p, const Bounds& box) {
  const Vec3 extent = box.extent();
  const float scale = 1023 / std::max({extent.x, extent.y, extent.z, 1e-30f});
  const auto cell = [&](float v, float lowest) {
    const float at = (v - lowest) * scale;
    return spread_bits(at > 0 ? static_cast<std::uint32_t>(std::min(at, 1023.f)) : 0);
  };
  return cell(p.x, box.lower.x) | cell(p.y, box.lower.y) << 1 | cell(p.z, box.lower.z) << 2;
}

/// values[order[i]] for each i.
template <class T>
std::vector<T> arranged(const std::vector<T>& values, const std::vector<std::uint64_t>& order) {
  std::vector<T> result;
  result.reserve(values.size());
  for (const std::uint64_t o : order) result.push_back(values[static_cast<std::uint32_t>(o)]);
  return result;
}

bool count_memory(void* counter, const ssize_t bytes, bool) {
  static_cast<std::atomic<std::int64_t>*>(counter)->fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

}  // namespace

RayScene::Curves RayScene::make_curves(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  const float to_radius = 0.5f * groom.width_scale * similarity_scale(groom.transform);
  const bool phantoms = set.basis == CurveBasis::kCatmullRom || set.basis == CurveBasis::kBSpline;
  Curves c;
  c.basis = set.basis;
  c.points.reserve(set.point_count() + (phantoms ? 2 * set.strand_count() : 0) + 1);
  c.spans.reserve(set.point_count()), c.first_points.reserve(set.point_count());
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    const std::uint32_t begin = set.offsets[s], end = set.offsets[s + 1], spans = span_count(set.basis, end - begin);
    const auto first = static_cast<std::uint32_t>(c.points.size());
    if (phantoms && spans > 0) c.points.emplace_back();
    for (std::uint32_t i = begin; i < end; ++i) {
      const Vec3 p = transform_point(groom.transform, set.points[i]);
      c.points.emplace_back(p.x, p.y, p.z, set.width(i) * to_radius);
    }
    if (phantoms && spans > 0) {
      c.points[first] = phantom(c.points[first + 1], c.points[first + 2]);
      c.points.push_back(phantom(c.points[c.points.size() - 1], c.points[c.points.size() - 2]));
    }
    if (set.basis == CurveBasis::kBezier) straighten_radii(&c.points[first], spans);
    for (std::uint32_t k = 0; k < spans; ++k) {
      c.spans.push_back({static_cast<std::uint32_t>(s), k, spans});
      c.first_points.push_back(first + (set.basis == CurveBasis::kBezier ? 3 * k : k));
      if (set.basis == CurveBasis::kLinear)
        c.flags.push_back(static_cast<std::uint8_t>((k > 0 ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) |
                                                    (k + 1 < spans ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0)));
    }
  }
  c.sort_by_place();
  return c;
}

void RayScene::Curves::sort_by_place() {
  Bounds box;
  for (const Vec4& p : points) box.extend(position(p));
  std::vector<std::uint64_t> order;  // place on the curve, then the span that stands there
  order.reserve(spans.size());
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Vec3 middle = (position(points[first_points[i]]) + position(points[first_points[i] + 1])) * 0.5f;
    order.push_back(std::uint64_t{place_on_curve(middle, box)} << 32 | i);
  }
  std::sort(order.begin(), order.end());
  spans = arranged(spans, order);
  first_points = arranged(first_points, order);
  if (!flags.empty()) flags = arranged(flags, order);
}

void RayScene::attach_curves(const Curves& c) {
  RTCGeometry geometry = rtcNewGeometry(device_, geometry_type(c.basis, shape_));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, c.points.data(), 0, sizeof(Vec4),
                             c.points.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, c.first_points.data(), 0,
                             sizeof(std::uint32_t), c.first_points.size());
  if (!c.flags.empty())
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, c.flags.data(), 0, 1, c.flags.size());
  if (c.basis != CurveBasis::kLinear && shape_ == CurveShape::kFlat)
    rtcSetGeometryTessellationRate(geometry, kCurveTessellation);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

RayScene::RayScene(const Scene& scene, CurveShape shape) : shape_(shape), meshes_(world_meshes(scene.meshes)) {
  for (const GroomInstance& groom : scene.grooms) {
    grooms_.push_back(make_curves(groom));
    has_caps_.push_back(groom.strands->basis == CurveBasis::kLinear);
  }
  device_ = rtcNewDevice(nullptr);
  if (!device_) throw Error("ray tracing", "Embree", "no device could be made", "check the Embree installation");
  std::atomic<std::int64_t> memory{0};
  rtcSetDeviceMemoryMonitorFunction(device_, count_memory, &memory);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT |
                                                      RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  for (const WorldMesh& mesh : meshes_) attach(device_, scene_, mesh);
  for (const Curves& curves : grooms_) attach_curves(curves);
  arena().execute([&] { rtcCommitScene(scene_); });
  rtcSetDeviceMemoryMonitorFunction(device_, nullptr, nullptr);
  embree_bytes_ = static_cast<std::size_t>(std::max<std::int64_t>(memory, 0));
  try {
    check_device(device_);
  } catch (...) {
    rtcReleaseScene(scene_), rtcReleaseDevice(device_);
    throw;
  }
}

RayScene::~RayScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

SceneHit RayScene::intersect(const Ray& ray) const {
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &query);
  SceneHit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const auto meshes = static_cast<std::uint32_t>(meshes_.size());
  const bool mesh = query.hit.geomID < meshes;
  hit.kind = mesh ? SceneHit::Kind::kMesh : SceneHit::Kind::kStrand;
  hit.distance = query.ray.tfar;
  hit.object = mesh ? query.hit.geomID : query.hit.geomID - meshes;
  hit.primitive = query.hit.primID, hit.u = query.hit.u, hit.v = query.hit.v;
  return hit;
}

bool RayScene::occluded(const Ray& ray) const {
  RTCRay query = embree_ray(ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &query);
  return query.tfar < 0;
}

namespace {

/// What the filter of cross_strands() is told; Embree hands the context back, so it comes first.
struct CrossingContext {
  RTCIntersectContext embree;
  const StrandVisitor* visitor;
  std::uint32_t meshes;
  const std::uint8_t* has_caps;
};

/// Lets strands pass and tells them; meshes stop the ray. One ray a call, because the query is one.
void pass_strands(const RTCFilterFunctionNArguments* args) {
  const auto* context = reinterpret_cast<const CrossingContext*>(args->context);
  if (args->valid[0] == 0) return;
  RTCRayN* ray = args->ray;
  RTCHitN* hit = args->hit;
  const std::uint32_t geometry = RTCHitN_geomID(hit, 1, 0);
  if (geometry < context->meshes) return;
  args->valid[0] = 0;
  const float u = RTCHitN_u(hit, 1, 0);
  if (context->has_caps[geometry - context->meshes] && (u == 0 || u == 1)) return;
  (*context->visitor)({SceneHit::Kind::kStrand, RTCRayN_tfar(ray, 1, 0), geometry - context->meshes, RTCHitN_primID(hit, 1, 0),
                       u, RTCHitN_v(hit, 1, 0)});
}

}  // namespace

bool RayScene::cross_strands(const Ray& ray, const StrandVisitor& visitor) const {
  PELAGE_CHECK(shape_ == CurveShape::kFlat);
  CrossingContext context;
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = pass_strands;
  context.visitor = &visitor;
  context.meshes = static_cast<std::uint32_t>(meshes_.size());
  context.has_caps = has_caps_.data();
  RTCRay query = embree_ray(ray);
  rtcOccluded1(scene_, &context.embree, &query);
  return query.tfar >= 0;
}

StrandPlace RayScene::strand_place(const SceneHit& hit) const {
  const Curves& c = grooms_[hit.object];
  const Span& span = c.spans[hit.primitive];
  const Vec4* p = &c.points[c.first_points[hit.primitive]];
  StrandPlace place;
  place.strand = span.strand, place.span = span.number;
  place.u = (static_cast<float>(span.number) + hit.u) / static_cast<float>(span.count);
  if (c.basis == CurveBasis::kLinear) {
    place.axis = lerp(position(p[0]), position(p[1]), hit.u);
    place.radius = p[0].w + (p[1].w - p[0].w) * hit.u;
    place.tangent = normalize(position(p[1]) - position(p[0]));
  } else {
    const Vec4 w = basis_weights(c.basis, hit.u), d = basis_derivative(c.basis, hit.u);
    const auto blend = [&](Vec4 k) {
      return kernel::curve_combine(k, position(p[0]), position(p[1]), position(p[2]), position(p[3]));
    };
    place.axis = blend(w);
    place.radius = p[0].w * w.x + p[1].w * w.y + p[2].w * w.z + p[3].w * w.w;
    place.tangent = normalize(blend(d));
    if (!(dot(place.tangent, place.tangent) > 0)) place.tangent = normalize(position(p[2]) - position(p[1]));
  }
  if (!(dot(place.tangent, place.tangent) > 0)) place.tangent = {0, 1, 0};
  return place;
}

Surface RayScene::surface(const SceneHit& hit) const {
  return surface_at(meshes_[hit.object], RayHit{hit.distance, hit.object, hit.primitive, hit.u, hit.v});
}

std::size_t RayScene::span_total() const {
  std::size_t total = 0;
  for (const Curves& c : grooms_) total += c.spans.size();
  return total;
}

std::size_t RayScene::bytes() const {
  std::size_t total = embree_bytes_ + resident_bytes(meshes_);
  for (const Curves& c : grooms_)
    total += capacity_bytes(c.points) + capacity_bytes(c.spans) + capacity_bytes(c.first_points) + capacity_bytes(c.flags);
  return total;
}

}  // namespace pelage
