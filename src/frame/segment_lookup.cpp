#include "frame/segment_lookup.h"

#include <algorithm>

#include "core/check.h"
#include "frame/camera_view.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

/// The four control points that a span blends, and the widths at its two ends.
struct Span {
  Vec3 p[4];
  float width[2];
};

Span load_span(const StrandSet& set, std::uint32_t strand, std::uint32_t span) {
  Span r;
  span_points(set, strand, span, r.p);
  const std::uint32_t stride = points_per_span(set.basis), first = set.offsets[strand] + stride * span;
  r.width[0] = set.width(first), r.width[1] = set.width(first + stride);
  return r;
}

Vec3 blend(const Span& s, Vec4 w) { return kernel::curve_combine(w, s.p[0], s.p[1], s.p[2], s.p[3]); }

Vec3 direction(const Span& s, CurveBasis basis, float t) {
  for (const Vec3 d : {blend(s, basis_derivative(basis, t)), s.p[2] - s.p[1], s.p[3] - s.p[0]})
    if (dot(d, d) > 0) return d;
  return {0, 1, 0};
}

/// The share of a strand that is drawn at `local` of the span of `s`.
float share_on(const std::vector<float>& shares, const StrandSet& set, const SegmentRef& s, float local) {
  constexpr float kLeast = 1e-6f;
  const std::size_t stride = points_per_span(set.basis), i = set.offsets[s.strand] + s.span * stride;
  return std::max(shares[i] + (shares[i + stride] - shares[i]) * local, kLeast);
}

/// The strand that point `place` of a set belongs to.
std::uint32_t find_strand(const std::vector<std::uint32_t>& offsets, std::uint32_t place) {
  const std::uint64_t strands = offsets.size() - 1;
  const std::uint64_t guess = std::min(place * strands / offsets.back(), strands - 1);
  if (offsets[guess] <= place && place < offsets[guess + 1]) return static_cast<std::uint32_t>(guess);
  return static_cast<std::uint32_t>(std::upper_bound(offsets.begin(), offsets.end(), place) - offsets.begin() - 1);
}

}  // namespace

void span_points(const StrandSet& set, std::uint32_t strand, std::uint32_t span, Vec3 (&p)[4]) {
  const std::uint32_t begin = set.offsets[strand], end = set.offsets[strand + 1];
  if (set.basis == CurveBasis::kBezier) {
    for (std::uint32_t i = 0; i < 4; ++i) p[i] = set.points[begin + 3 * span + i];
    return;
  }
  const std::uint32_t i = begin + span;
  p[1] = set.points[i], p[2] = set.points[i + 1];
  p[0] = i > begin ? set.points[i - 1] : p[1] * 2.f - p[2];
  p[3] = i + 2 < end ? set.points[i + 2] : p[2] * 2.f - p[1];
}

SegmentRef find_segment(const Scene& scene, const SegmentNumbering& numbering, std::uint32_t id) {
  const auto& base = numbering.groom_base;
  PELAGE_CHECK(!base.empty() && id < base.back());
  SegmentRef r;
  r.groom = static_cast<std::uint32_t>(std::upper_bound(base.begin(), base.end(), id) - base.begin() - 1);
  const std::uint32_t subdivisions = numbering.subdivisions[r.groom];
  const std::uint32_t local = id - base[r.groom], place = local / subdivisions;
  r.k = local % subdivisions;
  const auto& offsets = scene.grooms[r.groom].strands->offsets;
  r.strand = find_strand(offsets, place);
  r.span = place - offsets[r.strand];
  return r;
}

StrandSurface surface_at(const Scene& scene, const SegmentNumbering& numbering, const SegmentRef& s, float t) {
  const GroomInstance& groom = scene.grooms[s.groom];
  const StrandSet& set = *groom.strands;
  const Span span = load_span(set, s.strand, s.span);
  const float local = (static_cast<float>(s.k) + t) / static_cast<float>(numbering.subdivisions[s.groom]);
  const std::uint32_t spans = span_count(set.basis, set.offsets[s.strand + 1] - set.offsets[s.strand]);
  StrandSurface r;
  r.position = transform_point(groom.transform, blend(span, basis_weights(set.basis, local)));
  r.tangent = normalize(transform_vector(groom.transform, direction(span, set.basis, local)));
  r.u = (static_cast<float>(s.span) + local) / static_cast<float>(spans);
  r.width = (span.width[0] + (span.width[1] - span.width[0]) * local) * groom.width_scale * similarity_scale(groom.transform);
  if (groom.shares) r.width /= share_on(*groom.shares, set, s, local);
  return r;
}

float locate_on_segment(const Scene& scene, const SegmentNumbering& numbering, const CameraView& view, const SegmentRef& s,
                        float x, float y) {
  const GroomInstance& groom = scene.grooms[s.groom];
  const Span span = load_span(*groom.strands, s.strand, s.span);
  const float step = 1.f / static_cast<float>(numbering.subdivisions[s.groom]);
  const auto end = [&](float k) {
    const Vec3 p = blend(span, basis_weights(groom.strands->basis, k * step));
    return transform_point(view.world_to_camera, transform_point(groom.transform, p));
  };
  const Vec3 a = end(static_cast<float>(s.k)), b = end(static_cast<float>(s.k + 1));
  // Seen from (x, y), a point p of camera space is off by q(p) = (center − (x, y))·w + focal·p.xy pixels times w, with
  // w = p.z (perspective) or 1. q is linear along the chord. Of q(t)/w(t) the part along the projected chord vanishes
  // at the nearest place, which leaves one linear equation, free of divisions by a depth that may not be positive.
  const auto offset = [&](Vec3 p) {
    const float w = view.perspective ? p.z : 1.f;
    return Vec2((view.center_x - x) * w + view.focal * p.x, (view.center_y - y) * w + view.focal * p.y);
  };
  const Vec2 qa = offset(a), qb = offset(b);
  const float wa = view.perspective ? a.z : 1.f, wb = view.perspective ? b.z : 1.f;
  const Vec2 along = qb * wa - qa * wb;  // parallel to the projected chord
  const float da = dot(qa, along), db = dot(qb, along);
  if (!(std::fabs(da - db) > 0)) return 0.5f;
  return std::clamp(da / (da - db), 0.f, 1.f);
}

Finish strand_finish(const GroomInstance& groom, std::uint32_t strand, float u) {
  const Vec2 uv = groom.strands->root_uv.empty() ? Vec2() : groom.strands->root_uv[strand];
  return mapped_finish(groom, {uv.x, uv.y, u});
}

Vec3 strand_color(const GroomInstance& groom, std::uint32_t strand, std::uint32_t span) {
  const StrandSet& set = *groom.strands;
  if (set.colors.empty()) return groom.material.color;
  if (set.colors.size() == set.strand_count()) return set.colors[strand];
  const std::uint32_t stride = points_per_span(set.basis);
  return set.colors[set.offsets[strand] + span * stride];
}

}  // namespace pelage
