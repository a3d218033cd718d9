#include "frame/visibility.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <cmath>

#include "frame/camera_view.h"

namespace pelage {

SegmentNumbering number_spans(const Scene& scene) {
  SegmentNumbering spans;
  std::uint64_t count = 0;
  for (const GroomInstance& groom : scene.grooms) {
    spans.groom_base.push_back(static_cast<std::uint32_t>(count));
    spans.subdivisions.push_back(1);
    count += groom.strands->point_count();
    if (count > VisibilitySample::kMaxPrimitive)
      throw Error("groom", groom.name, fmt::format("{} spans, more than the 30 bits of a visibility sample can name", count),
                  "use another method than link, or split the scene");
  }
  spans.groom_base.push_back(static_cast<std::uint32_t>(count));
  return spans;
}

void mark_hair(StrandLayer& layer) {
  layer.hair = {layer.width, layer.height, [&](std::size_t p) { return layer.visibility[p].is_hair(); }};
}

Vec4 Behind::at(std::size_t p) const {
  if (!color.empty()) return color[p];
  const bool mesh = !depth.empty() && depth[p] < INFINITY;
  const Vec3 c = mesh ? opaque_color(opaque, p) : backdrop.pixels.empty() ? backdrop.color : backdrop.pixels[p];
  return {c.x, c.y, c.z, mesh ? 1.f : backdrop.alpha};
}

VisibilityPacker::VisibilityPacker(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering)
    : scene_(scene), view_(view), numbering_(numbering), spans_(number_spans(scene)) {}

StrandSample VisibilityPacker::sample(const SegmentRef& segment, float t, const StrandSurface& surface) const {
  const Vec3 c = transform_point(view_.world_to_camera, surface.position);
  const Vec2 along = project_direction(view_, c, transform_vector(view_.world_to_camera, surface.tangent));
  const float pixels = length(along), subdivisions = static_cast<float>(numbering_.subdivisions[segment.groom]);
  const std::uint32_t span =
      spans_.groom_base[segment.groom] + scene_.grooms[segment.groom].strands->offsets[segment.strand] + segment.span;
  const float on_span = (static_cast<float>(segment.k) + t) / subdivisions;
  return {pack_visibility(pixels > 0 ? along * (1 / pixels) : Vec2(), on_span, span, false),
          surface.width * pixels_per_metre(view_, c.z)};
}

}  // namespace pelage
