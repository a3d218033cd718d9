// Strands and meshes in one acceleration structure, and what is found where a ray meets them.
#pragma once

#include <embree3/rtcore.h>
#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/buffer.h"
#include "core/ray.h"
#include "core/rng.h"
#include "core/world_mesh.h"
#include "reference/path_tracer.h"
#include "reference/silhouette.h"
#include "reference/thick_curves.h"

namespace pelage {

/// Straight pieces that a flat span of a curved basis is cut into: as many as Embree tests at a time anyway.
inline constexpr float kCurveTessellation = 8;

/// Something that a ray met first.
struct SceneHit {
  enum class Kind { kNone, kStrand, kThickHair, kMesh };
  Kind kind = Kind::kNone;
  float distance = INFINITY;    ///< in units of the ray's direction
  std::uint32_t object = 0;     ///< index into Scene::grooms or Scene::meshes
  std::uint32_t primitive = 0;  ///< span of the groom, in RayScene's own order, piece of a thick hair, or triangle
  float u = 0, v = 0;           ///< along the span or piece, 0…1; or barycentric
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

/// What a ray through thick hairs brings along.
struct Passage {
  RandomBits key{};  ///< random numbers of this ray: whether it meets a fiber of a hair is a pure function of them and the hair
  SceneHit leaving{};  ///< a thick hair that the ray leaves, or none: it is not met nearer than `outside`
  float outside = 0;   ///< in units of the ray's direction
};

/// Is told a strand on a ray.
using StrandVisitor = std::function<void(const SceneHit&)>;

/// World-space copies of all strands and meshes of a scene. Queries are const and thread-safe.
///
/// Every span of a strand is one curve of the strand's basis with its phantom ends, so the curve is the one that
/// frame/segment_lookup.h defines. Its width runs through the same basis, through the widths of the control points.
/// Flat curves nearer than their width to a ray's origin are not met (Embree's guard against self-intersection).
/// Grooms with GroomInstance::sections are ThickCurves, which rays pass by chance.
class RayScene {
 public:
  RayScene(const Scene& scene, CurveShape shape);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  SceneHit intersect(const Ray& ray, const Passage& passage = {}) const;
  bool occluded(const Ray& ray, const Passage& passage = {}) const;
  /// A ray's passage out of the thick hair that `hit` tells; of anything else it leaves nothing.
  Passage passage_from(const SceneHit& hit, const Ray& ray, RandomBits key) const;
  /// Tells every strand on the ray, in any order, a strand that is met n times n times. False where a mesh stands in the way.
  /// Flat curves only: Embree looks for hits of tubes by halving them, and tells the same one many times.
  bool cross_strands(const Ray& ray, const StrandVisitor& visitor) const;

  /// All strands and meshes.
  void add_to(Silhouette& silhouette) const;

  StrandPlace strand_place(const SceneHit& hit) const;
  /// Of a thick hair.
  ThickPlace thick_place(const SceneHit& hit) const { return thick_[hit.object].curves->place(hit.primitive, hit.u); }
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
  /// What Embree hands back where a ray comes near thick hairs.
  struct ThickGeometry {
    std::unique_ptr<const ThickCurves> curves;  ///< or null: the groom has strands
    std::uint32_t geometry = 0;                 ///< its number in Embree's scene
    std::uint32_t groom = 0;
  };
  struct QueryContext;
  static Curves make_curves(const GroomInstance& groom);
  void attach_curves(const Curves& curves);
  void attach_thick(ThickGeometry& thick);
  static std::optional<float> meet_thick(const ThickGeometry& thick, const RTCIntersectContext* context, std::uint32_t piece,
                                         const RTCRay& ray);

  CurveShape shape_;
  std::vector<WorldMesh> meshes_;
  std::vector<Curves> grooms_;          ///< of those with thick hairs nothing
  std::vector<ThickGeometry> thick_;    ///< [grooms]
  std::vector<std::uint8_t> has_caps_;  ///< [grooms] straight pieces overlap by caps at their ends, which are no further strand
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::size_t embree_bytes_ = 0;
};

}  // namespace pelage
