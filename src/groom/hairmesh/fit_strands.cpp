#include "groom/hairmesh/fit_strands.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/strand_path.h"

namespace pelage {
namespace {

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
  StrandPath probe;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t s = i * n / count;
    probe.assign(set, s);
    if (probe.knots().size() < 2 || !(probe.length() > 0)) continue;
    source.push_back(s), f.lengths.push_back(static_cast<float>(probe.length()));
  }
  f.points.resize(f.count() * FitStrands::kPoints), f.widths.resize(f.count() * FitStrands::kWidths);
  SharedProgress shared(progress, "sample strands", std::max<std::size_t>(1, f.count()));
  parallel_for(f.count(), 256, [&](std::size_t begin, std::size_t end) {
    StrandPath path;
    using Knot = StrandPath::Knot;
    for (std::size_t s = begin; s < end; ++s) {
      path.assign(set, source[s]);
      path.walk(FitStrands::kPoints, [&](std::size_t i, const Knot& a, const Knot& b, float t) {
        f.points[s * FitStrands::kPoints + i] = lerp(a.p, b.p, t);
      });
      path.walk(FitStrands::kWidths, [&](std::size_t i, const Knot& a, const Knot& b, float t) {
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
