#include "lod/guide_hairs.h"

#include <algorithm>
#include <limits>
#include <unordered_set>

#include "core/k_means.h"
#include "core/parallel.h"
#include "core/shared_progress.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = Stations::kPoints, kDimension = 3 * kPoints;

Features features_of(const Stations& stations) {
  Features f;
  f.dimension = kDimension;
  f.values.reserve(stations.points.size() * 3);
  for (const Vec3 p : stations.points) f.values.insert(f.values.end(), {p.x, p.y, p.z});
  return f;
}

/// Of every cluster the strand nearest to the cluster's mean. The mean squared distance from x to all of a cluster is that to its
/// mean plus a constant, so it is the medoid of D as well.
std::vector<std::uint32_t> medoids(const Stations& stations, const std::vector<std::uint32_t>& label, std::uint32_t clusters) {
  std::vector<double> sums(clusters * kDimension);
  std::vector<std::size_t> counts(clusters);
  for (std::size_t s = 0; s < label.size(); ++s) {
    ++counts[label[s]];
    double* sum = &sums[label[s] * kDimension];
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Vec3 p = stations.strand(s)[k];
      sum[3 * k] += static_cast<double>(p.x), sum[3 * k + 1] += static_cast<double>(p.y);
      sum[3 * k + 2] += static_cast<double>(p.z);
    }
  }
  std::vector<double> least(clusters, std::numeric_limits<double>::max());
  std::vector<std::uint32_t> medoid(clusters);
  for (std::size_t s = 0; s < label.size(); ++s) {
    const std::uint32_t c = label[s];
    const auto share = 1 / static_cast<double>(counts[c]);
    double d2 = 0;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Vec3 p = stations.strand(s)[k];
      const double* sum = &sums[c * kDimension + 3 * k];
      const double x = static_cast<double>(p.x) - sum[0] * share, y = static_cast<double>(p.y) - sum[1] * share,
                   z = static_cast<double>(p.z) - sum[2] * share;
      d2 += x * x + y * y + z * z;
    }
    if (d2 < least[c]) least[c] = d2, medoid[c] = static_cast<std::uint32_t>(s);
  }
  return medoid;
}

}  // namespace

std::vector<std::uint32_t> choose_guides(const Stations& stations, std::uint32_t count, std::uint32_t seed,
                                         const Progress& progress) {
  SharedProgress shared(progress, "lod guides", 2);
  const std::vector<std::uint32_t> label = k_means(features_of(stations), count, seed);
  shared.add(1);
  std::vector<std::uint32_t> guides = medoids(stations, label, *std::max_element(label.begin(), label.end()) + 1);
  std::sort(guides.begin(), guides.end());
  shared.add(1);
  return guides;
}

std::vector<std::uint32_t> own_guides(const StrandSet& strands) {
  const std::unordered_set<std::int64_t> named(strands.guide_id.begin(), strands.guide_id.end());
  std::vector<std::uint32_t> guides;
  for (std::uint32_t s = 0; s < strands.strand_count(); ++s)
    if (named.contains(strands.strand_id.empty() ? s : strands.strand_id[s])) guides.push_back(s);
  return guides;
}

std::vector<Prism> nearest_guides(const Stations& stations, const std::vector<std::uint32_t>& guides) {
  Features at;
  at.dimension = kDimension;
  for (const std::uint32_t g : guides)
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Vec3 p = stations.strand(g)[k];
      at.values.insert(at.values.end(), {p.x, p.y, p.z});
    }
  const CenterTable table(at);
  const auto last = static_cast<std::uint32_t>(guides.size() - 1);
  std::vector<Prism> prisms(stations.strand_count());
  parallel_for(prisms.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<float> d2(table.padded_count());
    for (std::size_t s = begin; s < end; ++s) {
      table.distances2(&stations.strand(s)->x, d2.data());
      std::array<std::uint32_t, 3> best = {last, last, last};
      std::array<float, 3> least;
      least.fill(std::numeric_limits<float>::max());
      for (std::uint32_t g = 0; g < guides.size(); ++g)
        for (std::size_t place = 0; place < 3; ++place)
          if (d2[g] < least[place]) {
            for (std::size_t i = 2; i > place; --i) best[i] = best[i - 1], least[i] = least[i - 1];
            best[place] = g, least[place] = d2[g];
            break;
          }
      std::sort(best.begin(), best.end());
      prisms[s] = best;
    }
  });
  return prisms;
}

Vec2 prism_weights(const Vec3* strand, const Vec3* g0, const Vec3* g1, const Vec3* g2) {
  // Minimize |Σ (x − g2) − w0·(g0 − g2) − w1·(g1 − g2)|² + ε·|w|² over the triangle: a quadratic in (w0, w1).
  double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0;
  const auto dot3 = [](Vec3 a, Vec3 b) {
    return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
           static_cast<double>(a.z) * static_cast<double>(b.z);
  };
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vec3 e0 = g0[k] - g2[k], e1 = g1[k] - g2[k], x = strand[k] - g2[k];
    a00 += dot3(e0, e0), a01 += dot3(e0, e1), a11 += dot3(e1, e1), b0 += dot3(e0, x), b1 += dot3(e1, x);
  }
  const double ridge = 1e-6 * (a00 + a11) + 1e-30;  // of w0² + w1² + (1 − w0 − w1)²
  a00 += 2 * ridge, a11 += 2 * ridge, a01 += ridge, b0 += ridge, b1 += ridge;
  const double determinant = a00 * a11 - a01 * a01;
  const double w0 = (b0 * a11 - b1 * a01) / determinant, w1 = (a00 * b1 - a01 * b0) / determinant;
  if (w0 >= 0 && w1 >= 0 && w0 + w1 <= 1) return {static_cast<float>(w0), static_cast<float>(w1)};
  // Else the least along the three sides, where it is a parabola.
  const auto energy = [&](double u, double v) { return a00 * u * u + 2 * a01 * u * v + a11 * v * v - 2 * (b0 * u + b1 * v); };
  const double on0 = std::clamp(b0 / a00, 0., 1.), on1 = std::clamp(b1 / a11, 0., 1.);
  const double across = std::clamp((b0 - b1 + a11 - a01) / (a00 - 2 * a01 + a11), 0., 1.);
  const std::array<std::array<double, 2>, 3> sides{{{on0, 0}, {0, on1}, {across, 1 - across}}};
  const auto best = *std::min_element(sides.begin(), sides.end(),
                                      [&](const auto& a, const auto& b) { return energy(a[0], a[1]) < energy(b[0], b[1]); });
  return {static_cast<float>(best[0]), static_cast<float>(best[1])};
}

}  // namespace pelage
