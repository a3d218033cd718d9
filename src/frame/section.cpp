#include "frame/section.h"

#include <cmath>

#include "frame/camera_view.h"

namespace pelage {

SectionExtent section_extent(Vec3 major, Vec3 minor, Vec3 along, Vec3 to_eye) {
  const auto reach = [&](Vec3 axis) { return 2 * std::hypot(dot(major, axis), dot(minor, axis)); };
  const Vec3 side = cross(along, to_eye);
  const float sine = length(side);
  if (!(sine > 1e-6f * length(along) * length(to_eye))) return {2 * length(major), 2 * length(minor)};
  const Vec3 across = side / sine;
  return {reach(across), reach(normalize(cross(across, along)))};
}

SeenBundle bundle_at(const Scene& scene, const SegmentNumbering& numbering, const SegmentRef& s, float t,
                     const StrandSurface& surface, Vec3 to_eye) {
  const GroomInstance& groom = scene.grooms[s.groom];
  const ThickSections& all = *groom.sections;
  const std::size_t stride = points_per_span(groom.strands->basis), i = groom.strands->offsets[s.strand] + s.span * stride;
  const float local = (static_cast<float>(s.k) + t) / static_cast<float>(numbering.subdivisions[s.groom]);
  const auto between = [&](const auto& values) { return values[i] + (values[i + stride] - values[i]) * local; };
  const auto axis = [&](const std::vector<Vec3>& axes) { return transform_vector(groom.transform, between(axes)); };
  SeenBundle b;
  b.fibers = between(all.fibers);
  b.radius = 0.5f * between(all.diameters) * groom.width_scale * similarity_scale(groom.transform);
  b.spread = between(all.spreads);
  b.extent = section_extent(axis(all.major), axis(all.minor), surface.tangent, to_eye);
  return b;
}

}  // namespace pelage
