#include "groom/hairmesh/fit_strands.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/curve_basis.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

struct Knot {
  Vec3 p;
  float width;
  double s;  // arc length from the root
};

/// The curve of strand `s` by knots on it: a few a span.
void knots_of(const StrandSet& set, std::size_t s, std::vector<Knot>& knots) {
  const std::uint32_t first = set.offsets[s], n = set.offsets[s + 1] - first;
  const bool bezier = set.basis == CurveBasis::kBezier;
  const std::uint32_t pieces = set.basis == CurveBasis::kLinear ? 1 : 4, spans = bezier ? (n - 1) / 3 : n - 1;
  // StrandSet: phantom points continue the ends.
  const auto point = [&](std::int64_t i) {
    if (i < 0) return set.points[first] * 2.f - set.points[first + 1];
    if (i >= n) return set.points[first + n - 1] * 2.f - set.points[first + n - 2];
    return set.points[first + static_cast<std::size_t>(i)];
  };
  knots.clear();
  for (std::uint32_t span = 0; span < spans; ++span)
    for (std::uint32_t k = span == 0 ? 0 : 1; k <= pieces; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(pieces);
      const std::int64_t from = bezier ? std::int64_t{span} * 3 : std::int64_t{span} - 1;
      const std::uint32_t low = first + (bezier ? span * 3 : span), high = low + (bezier ? 3 : 1);
      Knot knot{
          kernel::curve_combine(basis_weights(set.basis, t), point(from), point(from + 1), point(from + 2), point(from + 3)),
          set.width(low) + (set.width(high) - set.width(low)) * t, 0};
      if (!knots.empty()) knot.s = knots.back().s + static_cast<double>(length(knot.p - knots.back().p));
      knots.push_back(knot);
    }
}

/// Calls put(i, knots around, share between them) for `count` places uniform in arc length.
template <class Put>
void walk(const std::vector<Knot>& knots, std::size_t count, const Put& put) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = knots.back().s * static_cast<double>(i) / static_cast<double>(count - 1);
    while (k + 2 < knots.size() && knots[k + 1].s < s) ++k;
    const double step = knots[k + 1].s - knots[k].s;
    put(i, knots[k], knots[k + 1], static_cast<float>(step > 0 ? std::clamp((s - knots[k].s) / step, 0., 1.) : 0.));
  }
}

void find_places(const StrandSet& set, const std::vector<std::size_t>& source, FitStrands& f) {
  const auto in_unit = [](Vec2 p) { return p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1; };
  f.groom_uv.resize(f.count());
  if (!set.root_uv.empty() && std::all_of(set.root_uv.begin(), set.root_uv.end(), in_unit)) {
    for (std::size_t s = 0; s < f.count(); ++s) f.groom_uv[s] = {set.root_uv[source[s]].x, set.root_uv[source[s]].y, 0};
    return;
  }
  Bounds roots;
  for (std::size_t s = 0; s < f.count(); ++s) roots.extend(f.strand(s)[0]);
  const Vec3 extent = roots.extent();
  for (std::size_t s = 0; s < f.count(); ++s) {
    const Vec3 p = f.strand(s)[0] - roots.lower;
    f.groom_uv[s] = {extent.x > 0 ? p.x / extent.x : 0.5f, extent.z > 0 ? p.z / extent.z : 0.5f, 0};
  }
}

}  // namespace

Vec3 FitStrands::at(std::size_t s, float t) const {
  const float x = std::clamp(t, 0.f, 1.f) * static_cast<float>(kPoints - 1);
  const auto i = std::min(static_cast<std::size_t>(x), kPoints - 2);
  const Vec3* p = strand(s) + i;
  return lerp(p[0], p[1], x - static_cast<float>(i));
}

FitStrands sample_strands(const StrandSet& set, std::uint32_t most, const Progress& progress) {
  FitStrands f;
  std::vector<std::size_t> source;
  const std::size_t n = set.strand_count(), count = std::min<std::size_t>(n, most);
  std::vector<Knot> knots;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t s = i * n / count;
    knots_of(set, s, knots);
    if (knots.size() < 2 || !(knots.back().s > 0)) continue;
    source.push_back(s), f.lengths.push_back(static_cast<float>(knots.back().s));
  }
  f.points.resize(f.count() * FitStrands::kPoints), f.widths.resize(f.count() * FitStrands::kWidths);
  SharedProgress shared(progress, "sample strands", std::max<std::size_t>(1, f.count()));
  parallel_for(f.count(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<Knot> path;
    for (std::size_t s = begin; s < end; ++s) {
      knots_of(set, source[s], path);
      walk(path, FitStrands::kPoints, [&](std::size_t i, const Knot& a, const Knot& b, float t) {
        f.points[s * FitStrands::kPoints + i] = lerp(a.p, b.p, t);
      });
      walk(path, FitStrands::kWidths, [&](std::size_t i, const Knot& a, const Knot& b, float t) {
        f.widths[s * FitStrands::kWidths + i] = a.width + (b.width - a.width) * t;
      });
    }
    shared.add(end - begin);
  });
  Bounds box;
  for (const Vec3 p : f.points) box.extend(p);
  f.size = f.count() == 0 ? 0 : static_cast<double>(length(box.extent()));
  find_places(set, source, f);
  return f;
}

}  // namespace pelage
