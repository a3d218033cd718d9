#include "reference/thick_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frame/strand_part.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr float kThinnest = 1e-12f;  ///< square metres: sections of less area than this are not met

/// Share of a disc of radius 1 on one side of a line at the signed distance x from its center.
float disc_share(float x) {
  const float at = std::clamp(x, -1.f, 1.f);
  return 0.5f + (at * std::sqrt(1 - at * at) + std::asin(at)) / std::numbers::pi_v<float>;
}

/// Chance of one fiber of radius r, with its center anywhere in an ellipse that shows the half width `wide` (and with its hull in it), to
/// lie on a line at the offset y from the ellipse's axis.
float chance_to_meet(float y, float r, float wide) {
  const float room = wide - r;
  if (!(room > 1e-3f * r)) return std::fabs(y) <= r ? 1.f : 0.f;
  return disc_share((y + r) / room) - disc_share((y - r) / room);
}

}  // namespace

ThickCurves::ThickCurves(const GroomInstance& groom) {
  for (std::size_t i = 0; i < drawn_parts(groom); ++i)
    if (const StrandPart part = drawn_part(groom, i); part.spans > 0) add_part(groom, part);
}

void ThickCurves::add_part(const GroomInstance& groom, const StrandPart& part) {
  const StrandSet& set = *groom.strands;
  const ThickSections& all = *groom.sections;
  const std::uint32_t begin = set.offsets[part.strand], last = set.offsets[part.strand + 1] - 1;
  const std::uint32_t first = first_point(set, part), end = first + part.spans;
  const float fiber_scale = groom.width_scale * similarity_scale(groom.transform);
  const auto number = static_cast<std::uint32_t>(parts_.size());
  parts_.push_back({part, last - begin, part_of_.size()});
  for (std::uint32_t i = first; i <= end; ++i) {
    const Vec3 p1 = set.points[i], p2 = set.points[std::min(i + 1, last)];
    const Vec3 p0 = i > begin ? set.points[i - 1] : p1 * 2.f - p2;
    const Vec3 p3 = i + 2 <= last ? set.points[i + 2] : p2 * 2.f - p1;
    for (std::uint32_t k = 0; k < (i < end ? kThickTessellation : 1); ++k) {
      const float t = static_cast<float>(k) / kThickTessellation;
      const auto curve = [&](Vec4 w) { return kernel::curve_combine(w, p0, p1, p2, p3); };
      const auto between = [&](const auto& v) { return i < last ? v[i] + (v[i + 1] - v[i]) * t : v[i]; };
      const bool tip = i == last && i > begin;
      const Vec3 along = tip ? p1 - p0 : curve(basis_derivative(CurveBasis::kCatmullRom, t));
      rings_.push_back(
          {transform_point(groom.transform, curve(basis_weights(CurveBasis::kCatmullRom, t))),
           normalize(transform_vector(groom.transform, along)), transform_vector(groom.transform, between(all.major)),
           transform_vector(groom.transform, between(all.minor)), between(all.fibers), between(all.diameters) * fiber_scale,
           between(all.spreads), all.twists.empty() ? 0 : between(all.twists) / similarity_scale(groom.transform)});
      if (i < end) part_of_.push_back(number);
    }
  }
}

std::size_t ThickCurves::bytes() const {
  return rings_.capacity() * sizeof(Ring) + part_of_.capacity() * sizeof(std::uint32_t) + parts_.capacity() * sizeof(Part);
}

Bounds ThickCurves::bounds(std::size_t piece) const {
  const Ring* r = &ring(piece);
  const Vec3 axis = normalize(r[1].center - r[0].center);
  Bounds box;
  const Vec3 major = (r[0].major + r[1].major) * 0.5f, minor = (r[0].minor + r[1].minor) * 0.5f;
  for (int end = 0; end < 2; ++end) {
    // The end is an ellipse in the plane: the section's axes, moved along the piece.
    const float cosine = std::max(std::fabs(dot(axis, r[end].tangent)), 0.1f);
    const Vec3 x = major - axis * (dot(major, r[end].tangent) / cosine),
               y = minor - axis * (dot(minor, r[end].tangent) / cosine);
    const Vec3 half = Vec3(std::hypot(x.x, y.x), std::hypot(x.y, y.y), std::hypot(x.z, y.z)) * 1.0001f;
    box.extend(r[end].center - half), box.extend(r[end].center + half);
  }
  return box;
}

Vec4 ThickCurves::ball(std::size_t piece) const {
  const Bounds box = bounds(piece);
  const Vec3 c = box.center();
  return {c.x, c.y, c.z, 0.5f * length(box.extent())};
}

// In the coordinates x, y of an ellipse center + x·major + y·minor, its hull is the unit circle, whatever the angle between both
// axes. Places are taken relative to the ray's nearest one, so that no digits are lost to its origin.
std::optional<ThickCurves::Chord> ThickCurves::chord(std::size_t piece, Vec3 origin, Vec3 direction) const {
  const Ring* r = &ring(piece);
  const Vec3 axis = normalize(r[1].center - r[0].center);
  const Vec3 major = (r[0].major + r[1].major) * 0.5f, minor = (r[0].minor + r[1].minor) * 0.5f;
  const float area = dot(axis, cross(major, minor));  // over π
  const float speed2 = dot(direction, direction);
  if (!(std::fabs(area) > kThinnest) || !(speed2 > 0)) return {};
  const float middle = dot((r[0].center + r[1].center) * 0.5f - origin, direction) / speed2;
  const Vec3 from = origin + direction * middle - r[0].center;
  const Vec3 to_x = cross(minor, axis) / area, to_y = cross(axis, major) / area;
  const float x = dot(from, to_x), y = dot(from, to_y), dx = dot(direction, to_x), dy = dot(direction, to_y);
  const float d2 = dx * dx + dy * dy, turn = x * dy - y * dx, offset2 = turn * turn;
  if (!(offset2 < d2)) return {};  // passes at its side, or runs along it: then no fiber is ever on its way
  const float nearest = -(x * dx + y * dy) / d2, half = std::sqrt(d2 - offset2) / d2;
  Chord c{nearest - half, nearest + half, 0, 0};
  const float full = c.far - c.near;
  for (int end = 0; end < 2; ++end) {
    const float outward = end == 0 ? -1.f : 1.f;
    const Vec3 plane = r[end].tangent * outward;
    const float ahead = dot(end == 0 ? from : from + r[0].center - r[1].center, plane), rate = dot(direction, plane);
    if (rate == 0 && (end == 0 ? ahead > 0 : ahead >= 0)) return {};
    if (rate > 0 && -ahead / rate < c.far) c.far = -ahead / rate, c.leaves = end == 0 ? -1 : 1;
    if (rate < 0) c.near = std::max(c.near, -ahead / rate);
  }
  if (!(c.near < c.far)) return {};
  const float across = length(direction - axis * dot(direction, axis)), root = std::sqrt(d2);
  const float wide = std::fabs(area) * root / across;
  const float diameter = 0.5f * (r[0].diameter + r[1].diameter);
  c.one = chance_to_meet(wide * turn / root, 0.5f * diameter, wide) / full;
  c.near += middle, c.far += middle;
  return c;
}

std::optional<float> ThickCurves::meet(std::size_t piece, const Ray& ray, float u) const {
  const std::optional<Chord> c = chord(piece, ray.origin, ray.direction);
  if (!c) return {};
  const float near = std::max(c->near, ray.near), far = std::min(c->far, ray.far);
  if (!(near < far) || !(c->one > 0)) return {};
  const float fibers = ring(piece).fibers;
  // The nearest of n fibers has the rank 1 − (1 − u)^(1/n).
  const float rank = fibers > 1 ? -std::expm1(std::log1p(-u) / fibers) : u;
  const float at = near + rank / c->one;
  if (at < far) return at;
  return {};
}

float ThickCurves::way_out(std::size_t piece, Vec3 origin, Vec3 direction) const {
  constexpr float kBeyond = 1.0001f;
  const std::size_t begin = part(piece).first_piece, end = begin + part(piece).drawn.spans * kThickTessellation;
  float way = 0;
  for (int step = 0;;) {
    const std::optional<Chord> c = chord(piece, origin, direction);
    if (!c) break;
    way = std::max(way, c->far);
    if (c->leaves == 0 || c->leaves == -step) break;
    step = c->leaves;
    if (step < 0 ? piece == begin : piece + 1 == end) break;
    piece = step < 0 ? piece - 1 : piece + 1;
  }
  return way * kBeyond;
}

float ThickCurves::share_along(std::size_t piece, Vec3 p) const {
  const Ring* r = &ring(piece);
  const float from = dot(p - r[0].center, r[0].tangent), to = dot(r[1].center - p, r[1].tangent);
  return from + to > 0 ? std::clamp(from / (from + to), 0.f, 1.f) : 0.5f;
}

ThickPlace ThickCurves::place(std::size_t piece, float share) const {
  const Ring* r = &ring(piece);
  const auto between = [&](const auto& a, const auto& b) { return a + (b - a) * share; };
  return {between(r[0].center, r[1].center), normalize(between(r[0].tangent, r[1].tangent)),
          between(r[0].major, r[1].major),   between(r[0].minor, r[1].minor),
          between(r[0].fibers, r[1].fibers), 0.5f * between(r[0].diameter, r[1].diameter),
          between(r[0].spread, r[1].spread), between(r[0].twist, r[1].twist)};
}

}  // namespace pelage
