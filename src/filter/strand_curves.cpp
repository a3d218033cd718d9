#include "filter/strand_curves.h"

#include <algorithm>

#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/segment_lookup.h"

namespace pelage {

GroomCurves::GroomCurves(const Scene& scene, const CameraView& view)
    : scene_(&scene), view_(view), spans_(number_spans(scene)) {}

StrandCurve GroomCurves::curve_of(std::uint32_t primitive) const {
  const SegmentRef ref = find_segment(*scene_, spans_, primitive);
  const StrandSet& set = *scene_->grooms[ref.groom].strands;
  const std::uint32_t spans = span_count(set.basis, set.offsets[ref.strand + 1] - set.offsets[ref.strand]);
  return {primitive - ref.span, ref.groom, ref.strand, static_cast<float>(spans)};
}

StrandSurface GroomCurves::surface(const StrandCurve& curve, float s) const {
  float t = 0;
  const std::uint32_t span = primitive_at(curve, s, t) - curve.first_primitive;
  return surface_at(*scene_, spans_, {curve.groom, curve.strand, span, 0}, t);
}

bool GroomCurves::at(const StrandCurve& curve, float s, CurvePoint& point) const {
  const StrandSurface surface = this->surface(curve, s);
  const Vec3 c = transform_point(view_.world_to_camera, surface.position);
  if (!(c.z >= view_.near_plane)) return false;
  const Vec2 along = project_direction(view_, c, transform_vector(view_.world_to_camera, surface.tangent));
  const float pixels = length(along);
  point.screen = project(view_, c);
  point.depth = c.z;
  point.tangent = pixels > 0 ? along * (1 / pixels) : Vec2();
  return true;
}

float GroomCurves::step(const StrandCurve& curve, float s, float depth, float pixels) const {
  const float begin = std::min(static_cast<float>(static_cast<std::uint32_t>(s)), curve.end - 1);
  const float chord = length(surface(curve, begin + 1).position - surface(curve, begin).position);
  return chord > 0 ? pixels / (pixels_per_metre(view_, depth) * chord) : 1;
}

}  // namespace pelage
