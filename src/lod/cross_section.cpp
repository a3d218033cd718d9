#include "lod/cross_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelage {
namespace {

constexpr std::size_t kPoints = Stations::kPoints;
constexpr double kRound = 0.2;  // (λ1 − λ2)/(λ1 + λ2) below which a section has no direction to speak of

struct Plane {
  Vec3 u, v;  ///< unit, perpendicular to the center line and to each other
};

struct Flat {
  double x, y;
};

/// A fiber in a section: somewhere within `stray` of its place.
struct Place {
  double x, y, stray;
};

Vec3 any_perpendicular(Vec3 t) { return normalize(cross(t, std::fabs(t.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 1, 0))); }

/// Planes across the line through `centers`, each turned against the one before as little as can be.
std::array<Plane, kPoints> planes_along(const std::array<CrossSection, kPoints>& sections) {
  std::array<Plane, kPoints> planes;
  Vec3 tangent(0, 1, 0), u(1, 0, 0);
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vec3 along = sections[std::min(k + 1, kPoints - 1)].center - sections[k > 0 ? k - 1 : 0].center;
    if (const float l = length(along); l > 0) tangent = along / l;
    const Vec3 kept = u - tangent * dot(u, tangent);
    u = length(kept) > 1e-3f ? normalize(kept) : any_perpendicular(tangent);
    planes[k] = {u, cross(tangent, u)};
  }
  return planes;
}

/// Second moments of places in a plane, and the direction in which they spread the most.
struct Moments {
  double xx = 0, xy = 0, yy = 0;
  double angle() const { return 0.5 * std::atan2(2 * xy, xx - yy); }
  /// 0 round … 1 flat.
  double direction() const {
    const double sum = xx + yy;
    return sum > 0 ? std::hypot(xx - yy, 2 * xy) / sum : 0;
  }
};

Moments moments_of(const std::vector<Place>& places) {
  Moments m;
  for (const Place& p : places) m.xx += p.x * p.x, m.xy += p.x * p.y, m.yy += p.y * p.y;
  const double share = 1 / static_cast<double>(places.size());
  m.xx *= share, m.xy *= share, m.yy *= share;
  return m;
}

/// The principal axis (or the one across it) that is nearest to `before`; `before` itself where there is no axis.
double next_angle(const Moments& m, double before) {
  if (m.direction() < kRound) return before;
  constexpr double kQuarter = std::numbers::pi / 2;
  return m.angle() + kQuarter * std::round((before - m.angle()) / kQuarter);
}

/// Angles of the first axis along the hair, from the section that says it most clearly to both ends.
std::array<double, kPoints> angles_along(const std::array<Moments, kPoints>& moments) {
  std::array<double, kPoints> angle{};
  const auto clearest = static_cast<std::size_t>(
      std::max_element(moments.begin(), moments.end(),
                       [](const Moments& a, const Moments& b) { return a.direction() < b.direction(); }) -
      moments.begin());
  angle[clearest] = moments[clearest].angle();
  for (std::size_t k = clearest + 1; k < kPoints; ++k) angle[k] = next_angle(moments[k], angle[k - 1]);
  for (std::size_t k = clearest; k-- > 0;) angle[k] = next_angle(moments[k], angle[k + 1]);
  return angle;
}

/// How many times the ellipse with semi-axes a and b has to grow until it holds a place and what is around it.
double farthest(const Place& p, double a, double b) {
  if (!(p.stray > 0)) return std::hypot(p.x / a, p.y / b);
  constexpr double kSlant = std::numbers::sqrt2 / 2;
  constexpr Flat kAround[] = {{1, 0},  {kSlant, kSlant},   {0, 1},  {-kSlant, kSlant},
                              {-1, 0}, {-kSlant, -kSlant}, {0, -1}, {kSlant, -kSlant}};
  double most2 = 0;
  for (const Flat d : kAround) {
    const double x = (p.x + p.stray * d.x) / a, y = (p.y + p.stray * d.y) / b;
    most2 = std::max(most2, x * x + y * y);
  }
  return std::sqrt(most2);
}

/// Semi-axes along `angle` that hold the share `covered` of `places`, and a fiber's radius more.
Flat semi_axes(const std::vector<Place>& places, double angle, double radius, float covered, std::vector<double>& scratch) {
  const double c = std::cos(angle), s = std::sin(angle);
  double xx = radius * radius, yy = xx;  // a fiber is no point: sections of few fibers keep a sensible shape
  const double share = 1 / static_cast<double>(places.size());
  for (const Place& p : places) {
    const double x = c * p.x + s * p.y, y = c * p.y - s * p.x, around = 0.5 * p.stray * p.stray;
    xx += (x * x + around) * share, yy += (y * y + around) * share;
  }
  if (!(xx > 0) || !(yy > 0)) xx = std::max(xx, 1e-30), yy = std::max(yy, 1e-30);
  scratch.clear();
  for (const Place& p : places)
    scratch.push_back(farthest({c * p.x + s * p.y, c * p.y - s * p.x, p.stray}, std::sqrt(xx), std::sqrt(yy)));
  const auto n = static_cast<double>(places.size());
  const auto held = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(static_cast<double>(covered) * n - 1e-6), 1., n)) - 1;
  std::nth_element(scratch.begin(), scratch.begin() + held, scratch.end());
  const double scale = scratch[static_cast<std::size_t>(held)];
  return {scale * std::sqrt(xx) + radius, scale * std::sqrt(yy) + radius};
}

void set_centers(const Stations& stations, std::span<const std::uint32_t> strands,
                 std::array<CrossSection, kPoints>& sections) {
  const double share = 1 / static_cast<double>(strands.size());
  for (std::size_t k = 0; k < kPoints; ++k) {
    double x = 0, y = 0, z = 0, r = 0;
    for (const std::uint32_t s : strands) {
      const Vec3 p = stations.strand(s)[k];
      x += static_cast<double>(p.x), y += static_cast<double>(p.y), z += static_cast<double>(p.z);
      r += static_cast<double>(stations.radius(s)[k]);
    }
    sections[k].center = {static_cast<float>(x * share), static_cast<float>(y * share), static_cast<float>(z * share)};
    sections[k].radius = static_cast<float>(r * share);
  }
}

}  // namespace

std::array<CrossSection, kPoints> fit_cross_sections(const Stations& stations, std::span<const std::uint32_t> strands,
                                                     float covered, bool strays) {
  std::array<CrossSection, kPoints> sections;
  set_centers(stations, strands, sections);
  const std::array<Plane, kPoints> planes = planes_along(sections);
  std::array<std::vector<Place>, kPoints> places;
  std::array<Moments, kPoints> moments;
  for (std::size_t k = 0; k < kPoints; ++k) {
    for (const std::uint32_t s : strands) {
      const Vec3 off = stations.strand(s)[k] - sections[k].center;
      places[k].push_back({static_cast<double>(dot(off, planes[k].u)), static_cast<double>(dot(off, planes[k].v)),
                           strays ? static_cast<double>(stations.stray(s)[k]) : 0});
    }
    moments[k] = moments_of(places[k]);
  }
  const std::array<double, kPoints> angle = angles_along(moments);
  std::vector<double> scratch;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Flat axes = semi_axes(places[k], angle[k], static_cast<double>(sections[k].radius), covered, scratch);
    const auto c = static_cast<float>(std::cos(angle[k])), s = static_cast<float>(std::sin(angle[k]));
    sections[k].major = (planes[k].u * c + planes[k].v * s) * static_cast<float>(axes.x);
    sections[k].minor = (planes[k].v * c - planes[k].u * s) * static_cast<float>(axes.y);
  }
  put_longer_first(sections);
  return sections;
}

float twist_of(const Stations& stations, std::span<const std::uint32_t> strands,
               const std::array<CrossSection, kPoints>& sections) {
  const std::array<Plane, kPoints> planes = planes_along(sections);
  const auto place = [&](std::uint32_t s, std::size_t k) {
    const Vec3 off = stations.strand(s)[k] - sections[k].center;
    return Flat{static_cast<double>(dot(off, planes[k].u)), static_cast<double>(dot(off, planes[k].v))};
  };
  double turned = 0, way = 0;
  for (std::size_t k = 0; k + 1 < kPoints; ++k) {
    double along = 0, across = 0, squares = 0;  // as complex numbers, Σ conj(place)·(next place), and the sum of both squares
    for (const std::uint32_t s : strands) {
      const Flat a = place(s, k), b = place(s, k + 1);
      along += a.x * b.x + a.y * b.y, across += a.x * b.y - a.y * b.x;
      squares += a.x * a.x + a.y * a.y + b.x * b.x + b.y * b.y;
    }
    const double weight = std::hypot(along, across), moved = squares - 2 * along, explained = 2 * (weight - along);
    if (moved > 0) turned += weight * std::atan2(across, along) * explained / moved;
    way += weight * static_cast<double>(length(sections[k + 1].center - sections[k].center));
  }
  return way > 0 ? static_cast<float>(turned / way) : 0;
}

void put_longer_first(std::array<CrossSection, kPoints>& sections) {
  float longer = 0;
  for (const CrossSection& s : sections) longer += length(s.major) - length(s.minor);
  if (longer >= 0) return;
  for (CrossSection& s : sections) {
    const Vec3 first = s.major;
    s.major = s.minor, s.minor = -first;
  }
}

float mean_area(const std::array<CrossSection, kPoints>& sections) {
  float sum = 0;
  for (const CrossSection& s : sections) sum += length(s.major) * length(s.minor);
  return std::numbers::pi_v<float> * sum / static_cast<float>(kPoints);
}

}  // namespace pelage
