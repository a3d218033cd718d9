#include "reference/ray_scene.h"

#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/strand_part.h"
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

/// Balls in whose hull a span lies, given its control points: those of the same curve in Bézier's basis.
std::array<Vec4, 4> hull(CurveBasis basis, const Vec4* p) {
  switch (basis) {
    case CurveBasis::kLinear: return {p[0], p[1], p[0], p[1]};
    case CurveBasis::kCatmullRom: {
      const auto inner = [](Vec4 end, Vec4 from, Vec4 to) {
        return Vec4(end.x + (to.x - from.x) / 6, end.y + (to.y - from.y) / 6, end.z + (to.z - from.z) / 6,
                    end.w + (to.w - from.w) / 6);
      };
      return {p[1], inner(p[1], p[0], p[2]), inner(p[2], p[3], p[1]), p[2]};
    }
    case CurveBasis::kBSpline:
    case CurveBasis::kBezier: break;
  }
  return {p[0], p[1], p[2], p[3]};
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

/// The spans that begin with these control points, as they lie along that curve.
std::vector<std::uint32_t> order_in_space(const std::vector<Vec4>& points, const std::vector<std::uint32_t>& first_points) {
  Bounds box;
  for (const Vec4& p : points) box.extend(position(p));
  std::vector<std::uint64_t> order;  // place on the curve, then the span that stands there
  order.reserve(first_points.size());
  for (std::size_t i = 0; i < first_points.size(); ++i) {
    const Vec3 middle = (position(points[first_points[i]]) + position(points[first_points[i] + 1])) * 0.5f;
    order.push_back(std::uint64_t{place_on_curve(middle, box)} << 32 | i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> result;
  result.reserve(order.size());
  for (const std::uint64_t o : order) result.push_back(static_cast<std::uint32_t>(o));
  return result;
}

/// Appends a strand's control points, between phantoms where its basis wants them: world position and radius.
void add_world_points(const GroomInstance& groom, std::uint32_t strand, std::vector<Vec4>& points) {
  const StrandSet& set = *groom.strands;
  const std::uint32_t begin = set.offsets[strand], end = set.offsets[strand + 1], spans = span_count(set.basis, end - begin);
  const bool phantoms = spans > 0 && (set.basis == CurveBasis::kCatmullRom || set.basis == CurveBasis::kBSpline);
  const float to_radius = 0.5f * groom.width_scale * similarity_scale(groom.transform);
  const std::size_t first = points.size();
  if (phantoms) points.emplace_back();
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vec3 p = transform_point(groom.transform, set.points[i]);
    points.emplace_back(p.x, p.y, p.z, set.width(i) * to_radius);
  }
  if (phantoms) {
    points[first] = phantom(points[first + 1], points[first + 2]);
    points.push_back(phantom(points[points.size() - 1], points[points.size() - 2]));
  }
  if (set.basis == CurveBasis::kBezier) straighten_radii(&points[first], spans);
}

bool count_memory(void* counter, const ssize_t bytes, bool) {
  static_cast<std::atomic<std::int64_t>*>(counter)->fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

}  // namespace

RayScene::Curves RayScene::make_curves(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  Curves c;
  c.basis = set.basis;
  std::vector<Vec4> points;  // of all strands, phantoms included
  std::vector<Span> spans;
  std::vector<std::uint32_t> first_points;
  for (std::size_t i = 0; i < drawn_parts(groom); ++i) {
    const StrandPart part = drawn_part(groom, i);
    const auto first = static_cast<std::uint32_t>(points.size());
    add_world_points(groom, part.strand, points);
    const std::uint32_t count = whole_strand(set, part.strand).spans;
    for (std::uint32_t k = part.first_span; k < part.first_span + part.spans; ++k) {
      spans.push_back({part.strand, k, count});
      first_points.push_back(first + k * points_per_span(set.basis));
    }
  }
  c.points.resize(points.size()), c.first_points.resize(spans.size()), c.spans.reserve(spans.size());
  std::copy(points.begin(), points.end(), c.points.begin());
  for (const std::uint32_t span : order_in_space(points, first_points)) {
    c.first_points[c.spans.size()] = first_points[span];
    c.spans.push_back(spans[span]);
    const Span& s = c.spans.back();
    if (set.basis == CurveBasis::kLinear)
      c.flags.push_back(static_cast<std::uint8_t>((s.number > 0 ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) |
                                                  (s.number + 1 < s.count ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0)));
  }
  return c;
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

/// One ray's query; Embree hands the context back, so it comes first.
struct RayScene::QueryContext {
  RTCIntersectContext embree;
  const Passage* passage;
};

std::optional<float> RayScene::meet_thick(const ThickGeometry& thick, const RTCIntersectContext* context, std::uint32_t piece,
                                          const RTCRay& ray) {
  const Passage& passage = *reinterpret_cast<const QueryContext*>(context)->passage;
  const SceneHit& left = passage.leaving;
  const bool leaving = left.kind == SceneHit::Kind::kThickHair && left.object == thick.groom &&
                       thick.curves->strand(left.primitive) == thick.curves->strand(piece);
  const Ray r{{ray.org_x, ray.org_y, ray.org_z},
              {ray.dir_x, ray.dir_y, ray.dir_z},
              leaving ? std::max(ray.tnear, passage.outside) : ray.tnear,
              ray.tfar};
  const RandomBits bits = pcg4d(passage.key.x, passage.key.y + thick.groom, passage.key.z + piece, passage.key.w);
  return thick.curves->meet(piece, r, uniform_from_bits(bits.x));
}

void RayScene::attach_thick(ThickGeometry& thick) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(thick.curves->piece_count()));
  rtcSetGeometryUserData(geometry, &thick);
  const auto bounds = [](const RTCBoundsFunctionArguments* args) {
    const Bounds b = static_cast<const ThickGeometry*>(args->geometryUserPtr)->curves->bounds(args->primID);
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
  };
  const auto intersect = [](const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    const auto& thick_hairs = *static_cast<const ThickGeometry*>(args->geometryUserPtr);
    auto& query = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const std::optional<float> met = meet_thick(thick_hairs, args->context, args->primID, query.ray);
    if (!met) return;
    query.ray.tfar = *met;
    query.hit.geomID = thick_hairs.geometry, query.hit.primID = args->primID, query.hit.instID[0] = args->context->instID[0];
    query.hit.u = query.hit.v = 0;
  };
  const auto occluded = [](const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (meet_thick(*static_cast<const ThickGeometry*>(args->geometryUserPtr), args->context, args->primID, ray))
      ray.tfar = -INFINITY;
  };
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  rtcCommitGeometry(geometry);
  thick.geometry = rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

RayScene::RayScene(const Scene& scene, CurveShape shape) : shape_(shape), meshes_(world_meshes(scene.meshes)) {
  for (const GroomInstance& groom : scene.grooms) {
    const auto number = static_cast<std::uint32_t>(grooms_.size());
    grooms_.push_back(groom.sections ? Curves() : make_curves(groom));
    thick_.push_back({groom.sections ? std::make_unique<const ThickCurves>(groom) : nullptr, 0, number});
    has_caps_.push_back(groom.strands->basis == CurveBasis::kLinear);
  }
  device_ = rtcNewDevice(nullptr);
  if (!device_) throw Error("ray tracing", "Embree", "no device could be made", "check the Embree installation");
  std::atomic<std::int64_t> memory{0};
  rtcSetDeviceMemoryMonitorFunction(device_, count_memory, &memory);
  scene_ = rtcNewScene(device_);
  // Robust rays do not slip through between two triangles; strands have no such seams, and their rays are 5 % quicker without.
  rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION |
                                                      (meshes_.empty() ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST)));
  for (const WorldMesh& mesh : meshes_) attach(device_, scene_, mesh);
  for (std::size_t g = 0; g < grooms_.size(); ++g)
    if (thick_[g].curves) attach_thick(thick_[g]);
    else attach_curves(grooms_[g]);
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

SceneHit RayScene::intersect(const Ray& ray, const Passage& passage) const {
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  QueryContext context{{}, &passage};
  rtcInitIntersectContext(&context.embree);
  rtcIntersect1(scene_, &context.embree, &query);
  SceneHit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const auto meshes = static_cast<std::uint32_t>(meshes_.size());
  const bool mesh = query.hit.geomID < meshes;
  hit.distance = query.ray.tfar;
  hit.object = mesh ? query.hit.geomID : query.hit.geomID - meshes;
  hit.primitive = query.hit.primID, hit.u = query.hit.u, hit.v = query.hit.v;
  const ThickCurves* thick = mesh ? nullptr : thick_[hit.object].curves.get();
  hit.kind = mesh ? SceneHit::Kind::kMesh : thick ? SceneHit::Kind::kThickHair : SceneHit::Kind::kStrand;
  if (thick) hit.u = thick->share_along(hit.primitive, ray.origin + ray.direction * hit.distance);
  return hit;
}

bool RayScene::occluded(const Ray& ray, const Passage& passage) const {
  RTCRay query = embree_ray(ray);
  QueryContext context{{}, &passage};
  rtcInitIntersectContext(&context.embree);
  rtcOccluded1(scene_, &context.embree, &query);
  return query.tfar < 0;
}

Passage RayScene::passage_from(const SceneHit& hit, const Ray& ray, RandomBits key) const {
  if (hit.kind != SceneHit::Kind::kThickHair) return {key, {}, 0};
  return {key, hit, thick_[hit.object].curves->way_out(hit.primitive, ray.origin, ray.direction)};
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

void RayScene::add_to(Silhouette& silhouette) const {
  for (const Curves& c : grooms_)
    for (std::size_t span = 0; span < c.spans.size(); ++span) silhouette.add(hull(c.basis, c.points_of(span)));
  for (const ThickGeometry& thick : thick_)
    for (std::size_t piece = 0; thick.curves && piece < thick.curves->piece_count(); ++piece)
      silhouette.add(std::array{thick.curves->ball(piece)});
  const auto ball = [](Vec3 p) { return Vec4(p.x, p.y, p.z, 0); };
  for (const WorldMesh& mesh : meshes_)
    for (const std::array<std::uint32_t, 3>& t : mesh.triangles)
      silhouette.add(std::array{ball(mesh.positions[t[0]]), ball(mesh.positions[t[1]]), ball(mesh.positions[t[2]])});
}

StrandPlace RayScene::strand_place(const SceneHit& hit) const {
  const Curves& c = grooms_[hit.object];
  const Vec4* p = c.points_of(hit.primitive);
  StrandPlace place;
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

StrandLabel RayScene::strand_label(const SceneHit& hit) const {
  if (const ThickCurves* thick = thick_[hit.object].curves.get()) {
    const std::uint32_t strand = thick->strand(hit.primitive), number = thick->number(hit.primitive);
    return {strand, number / kThickTessellation,
            (static_cast<float>(number) + hit.u) / static_cast<float>(thick->pieces_of_strand(hit.primitive))};
  }
  const Span& span = grooms_[hit.object].spans[hit.primitive];
  return {span.strand, span.number, (static_cast<float>(span.number) + hit.u) / static_cast<float>(span.count)};
}

Surface RayScene::surface(const SceneHit& hit) const {
  return surface_at(meshes_[hit.object], RayHit{hit.distance, hit.object, hit.primitive, hit.u, hit.v});
}

std::size_t RayScene::span_total() const {
  std::size_t total = 0;
  for (const Curves& c : grooms_) total += c.spans.size();
  for (const ThickGeometry& thick : thick_) total += thick.curves ? thick.curves->span_count() : 0;
  return total;
}

std::size_t RayScene::bytes() const {
  std::size_t total = embree_bytes_ + resident_bytes(meshes_);
  for (const Curves& c : grooms_)
    total += c.points.bytes() + c.first_points.bytes() + capacity_bytes(c.spans) + capacity_bytes(c.flags);
  for (const ThickGeometry& thick : thick_) total += thick.curves ? thick.curves->bytes() : 0;
  return total;
}

}  // namespace pelage
