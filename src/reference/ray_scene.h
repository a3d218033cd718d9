// Strands and meshes in one acceleration structure, and what is found where a ray meets them.
#pragma once

#include <embree3/rtcore.h>
#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/buffer.h"
#include "core/ray.h"
#include "core/world_mesh.h"
#include "reference/path_tracer.h"
#include "reference/silhouette.h"

namespace pelage {

/// Straight pieces that a flat span of a curved basis is cut into: as many as Embree tests at a time anyway.
inline constexpr float kCurveTessellation = 8;

/// Something that a ray met first.
struct SceneHit {
  enum class Kind { kNone, kStrand, kMesh };
  Kind kind = Kind::kNone;
  float distance = INFINITY;    ///< in units of the ray's direction
  std::uint32_t object = 0;     ///< index into Scene::grooms or Scene::meshes
  std::uint32_t primitive = 0;  ///< span of the groom, in RayScene's own order, or triangle
  float u = 0, v = 0;           ///< along the span, 0…1; or barycentric
};

/// A place on a strand's axis, world space.
struct StrandPlace {
  Vec3 axis;         ///< metres
  Vec3 tangent;      ///< unit length, root to tip
  float radius = 0;  ///< metres
};

/// Which strand that is, and where on it.
struct StrandLabel {
  std::uint32_t strand = 0, span = 0;
  float u = 0;  ///< 0 at the root … 1 at the tip
};

/// Is told a strand on a ray.
using StrandVisitor = std::function<void(const SceneHit&)>;

/// World-space copies of all strands and meshes of a scene. Queries are const and thread-safe.
///
/// Every span of a strand is one curve of the strand's basis with its phantom ends, so the curve is the one that
/// frame/segment_lookup.h defines. Its width runs through the same basis, through the widths of the control points.
/// Flat curves nearer than their width to a ray's origin are not met (Embree's guard against self-intersection).
class RayScene {
 public:
  RayScene(const Scene& scene, CurveShape shape);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  SceneHit intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;
  /// Tells every strand on the ray, in any order, a strand that is met n times n times. False where a mesh stands in the way.
  /// Flat curves only: Embree looks for hits of tubes by halving them, and tells the same one many times.
  bool cross_strands(const Ray& ray, const StrandVisitor& visitor) const;

  /// All strands and meshes.
  void add_to(Silhouette& silhouette) const;

  StrandPlace strand_place(const SceneHit& hit) const;
  StrandLabel strand_label(const SceneHit& hit) const;
  Surface surface(const SceneHit& hit) const;

  std::size_t span_total() const;
  std::size_t bytes() const;
  RTCScene embree() const { return scene_; }

 private:
  /// What a hit wants to know of a span.
  struct Span {
    std::uint32_t strand;
    std::uint32_t number, count;  ///< in the strand: which, of how many
  };
  /// Spans of one groom. Control points of a strand stand together, phantoms included. Spans stand as they lie in space: a ray
  /// asks for those around it, wherever their strands are in the file.
  struct Curves {
    CurveBasis basis = CurveBasis::kLinear;
    Buffer<Vec4> points;  ///< world position and radius
    std::vector<Span> spans;
    Buffer<std::uint32_t> first_points;  ///< [spans] of their control points; apart, because rays ask for nothing else
    std::vector<std::uint8_t> flags;     ///< [spans] linear: which neighbors there are

    const Vec4* points_of(std::size_t span) const { return &points[first_points[span]]; }
  };
  static Curves make_curves(const GroomInstance& groom);
  void attach_curves(const Curves& curves);

  CurveShape shape_;
  std::vector<WorldMesh> meshes_;
  std::vector<Curves> grooms_;
  std::vector<std::uint8_t> has_caps_;  ///< [grooms] straight pieces overlap by caps at their ends, which are no further strand
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::size_t embree_bytes_ = 0;
};

}  // namespace pelage
