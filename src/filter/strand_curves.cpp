#include "filter/strand_curves.h"

#include <hwy/cache_control.h>

#include <algorithm>

#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"

namespace pelage {

GroomCurves::GroomCurves(const Scene& scene, const CameraView& view)
    : scene_(&scene), view_(view), spans_(number_spans(scene)) {}

StrandCurve GroomCurves::curve_of(std::uint32_t primitive) const {
  const SegmentRef ref = find_segment(*scene_, spans_, primitive);
  const StrandSet& set = *scene_->grooms[ref.groom].strands;
  const std::uint32_t spans = span_count(set.basis, set.offsets[ref.strand + 1] - set.offsets[ref.strand]);
  return {primitive - ref.span, ref.groom, ref.strand, static_cast<float>(spans)};
}

void GroomCurves::prefetch(std::uint32_t primitive) const {
  std::size_t groom = 0;
  while (spans_.groom_base[groom + 1] <= primitive) ++groom;
  const StrandSet& set = *scene_->grooms[groom].strands;
  // A primitive's number is that of its first point, but for Bézier spans, which take three.
  if (set.basis != CurveBasis::kBezier) hwy::Prefetch(&set.points[primitive - spans_.groom_base[groom]]);
}

void GroomCurves::load(StrandCurve& curve, std::uint32_t span) const {
  if (curve.span == span) return;
  const GroomInstance& groom = scene_->grooms[curve.groom];
  span_points(*groom.strands, curve.strand, span, curve.control);
  for (Vec3& p : curve.control) p = transform_point(view_.world_to_camera, transform_point(groom.transform, p));
  curve.span = span;
}

bool GroomCurves::at(StrandCurve& curve, float s, CurvePoint& point) const {
  float t = 0;
  load(curve, primitive_at(curve, s, t) - curve.first_primitive);
  const Vec3(&p)[4] = curve.control;
  const CurveBasis basis = scene_->grooms[curve.groom].strands->basis;
  const Vec3 c = kernel::curve_combine(basis_weights(basis, t), p[0], p[1], p[2], p[3]);
  if (!(c.z >= view_.near_plane)) return false;
  point.screen = project(view_, c);
  point.depth = c.z;
  point.tangent = {};
  const Vec3 velocity = kernel::curve_combine(basis_derivative(basis, t), p[0], p[1], p[2], p[3]);
  for (const Vec3 along : {velocity, p[2] - p[1], p[3] - p[0]}) {  // where a curve stands still, that of its surroundings
    if (!(dot(along, along) > 0)) continue;
    const Vec2 moved = project_direction(view_, c, along);
    if (const float pixels = length(moved); pixels > 0) point.tangent = moved * (1 / pixels);
    break;
  }
  return true;
}

float GroomCurves::step(StrandCurve& curve, float s, float depth, float pixels) const {
  float t = 0;
  load(curve, primitive_at(curve, s, t) - curve.first_primitive);
  const Vec3(&p)[4] = curve.control;
  const CurveBasis basis = scene_->grooms[curve.groom].strands->basis;
  const auto end = [&](float u) { return kernel::curve_combine(basis_weights(basis, u), p[0], p[1], p[2], p[3]); };
  const float chord = length(end(1) - end(0));
  return chord > 0 ? pixels / (pixels_per_metre(view_, depth) * chord) : 1;
}

}  // namespace pelage
