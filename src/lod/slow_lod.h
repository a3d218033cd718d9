// The chain of thick hairs made slowly and plainly, for the fast one to be held against: no threads, no tables, no solution that is
// shared between strands, every distance where it is needed.
#pragma once

#include <pelage/lod.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "core/rng.h"

namespace pelage::slow {

inline constexpr std::size_t kPoints = LodHierarchy::kPoints, kSamples = 61;
using Strand = std::array<Vec3, kPoints>;
using Strands = std::vector<std::uint32_t>;

/// Place of a Catmull-Rom spline with straight ends, in doubles.
struct Point {
  double x = 0, y = 0, z = 0;
};

inline std::array<double, 4> catmull_rom(double t) {
  return {0.5 * (-t + 2 * t * t - t * t * t), 0.5 * (2 - 5 * t * t + 3 * t * t * t), 0.5 * (t + 4 * t * t - 3 * t * t * t),
          0.5 * (-t * t + t * t * t)};
}

/// What control point `k` counts at `x` 0…kPoints − 1.
inline double weight(std::size_t k, double x) {
  const auto span = std::min(static_cast<std::size_t>(x), kPoints - 2);
  const std::array<double, 4> w = catmull_rom(x - static_cast<double>(span));
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t at = span + i;  // control point + 1, phantoms at both ends
    if (at == k + 1) sum += w[i];
    if (at == 0) sum += w[i] * (k == 0 ? 2 : k == 1 ? -1 : 0);
    if (at == kPoints + 1) sum += w[i] * (k == kPoints - 1 ? 2 : k == kPoints - 2 ? -1 : 0);
  }
  return sum;
}

/// Points on the strand's Catmull-Rom curve at equal shares of its length, told by chords of a quarter of a span.
inline std::vector<Point> sample(const StrandSet& set, std::size_t s) {
  const Vec3* p = &set.points[set.offsets[s]];
  const std::size_t n = set.offsets[s + 1] - set.offsets[s];
  std::vector<Point> path;
  std::vector<double> length = {0};
  const auto at = [&](std::ptrdiff_t i) {
    if (i < 0) return p[0] * 2.f - p[1];
    if (i >= static_cast<std::ptrdiff_t>(n)) return p[n - 1] * 2.f - p[n - 2];
    return p[i];
  };
  for (std::size_t q = 0; q <= 4 * (n - 1); ++q) {
    const std::size_t span = std::min(q / 4, n - 2);
    const std::array<double, 4> w = catmull_rom(static_cast<double>(q) / 4 - static_cast<double>(span));
    Point sum;
    for (std::ptrdiff_t i = 0; i < 4; ++i) {
      const Vec3 c = at(static_cast<std::ptrdiff_t>(span) - 1 + i);
      const double share = w[static_cast<std::size_t>(i)];
      sum.x += share * static_cast<double>(c.x), sum.y += share * static_cast<double>(c.y),
          sum.z += share * static_cast<double>(c.z);
    }
    if (q > 0)
      length.push_back(length.back() + std::hypot(sum.x - path.back().x, sum.y - path.back().y, sum.z - path.back().z));
    path.push_back(sum);
  }
  std::vector<Point> out;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double want = length.back() * static_cast<double>(i) / (kSamples - 1);
    std::size_t k = 0;
    while (k + 2 < path.size() && length[k + 1] < want) ++k;
    const double t = (want - length[k]) / (length[k + 1] - length[k]);
    out.push_back({path[k].x + t * (path[k + 1].x - path[k].x), path[k].y + t * (path[k + 1].y - path[k].y),
                   path[k].z + t * (path[k + 1].z - path[k].z)});
  }
  return out;
}

/// The spline through root and tip with the least squares, by relaxation of one control point after the other.
inline Strand fit(const StrandSet& set, std::size_t s) {
  const std::vector<Point> samples = sample(set, s);
  std::array<Point, kPoints> c;
  for (std::size_t k = 0; k < kPoints; ++k) c[k] = samples[k * (kSamples - 1) / (kPoints - 1)];
  for (int round = 0; round < 60; ++round)
    for (std::size_t k = 1; k + 1 < kPoints; ++k) {
      Point pull;
      double stiff = 0;
      for (std::size_t j = 0; j < kSamples; ++j) {
        const double x = static_cast<double>(j) / 4, w = weight(k, x);
        if (w == 0) continue;
        Point off = samples[j];
        for (std::size_t i = k > 3 ? k - 3 : 0; i < std::min(k + 4, kPoints); ++i) {
          const double v = weight(i, x);
          off.x -= v * c[i].x, off.y -= v * c[i].y, off.z -= v * c[i].z;
        }
        pull.x += w * off.x, pull.y += w * off.y, pull.z += w * off.z, stiff += w * w;
      }
      c[k].x += pull.x / stiff, c[k].y += pull.y / stiff, c[k].z += pull.z / stiff;
    }
  Strand out;
  for (std::size_t k = 0; k < kPoints; ++k)
    out[k] = {static_cast<float>(c[k].x), static_cast<float>(c[k].y), static_cast<float>(c[k].z)};
  out[0] = set.points[set.offsets[s]], out[kPoints - 1] = set.points[set.offsets[s + 1] - 1];
  return out;
}

/// D of Huang 2025, section 5.1.
inline float distance(const Strand& a, const Strand& b) {
  float sum = 0;
  for (std::size_t k = 0; k < kPoints; ++k)
    for (const float d : {a[k].x - b[k].x, a[k].y - b[k].y, a[k].z - b[k].z}) sum += d * d;
  return sum;
}

inline Strand mean(const std::vector<Strand>& strands, const std::vector<std::size_t>& members) {
  std::array<Point, kPoints> sum;
  for (const std::size_t s : members)
    for (std::size_t k = 0; k < kPoints; ++k)
      sum[k].x += static_cast<double>(strands[s][k].x), sum[k].y += static_cast<double>(strands[s][k].y),
          sum[k].z += static_cast<double>(strands[s][k].z);
  Strand out;
  const auto n = static_cast<double>(members.size());
  for (std::size_t k = 0; k < kPoints; ++k)
    out[k] = {static_cast<float>(sum[k].x / n), static_cast<float>(sum[k].y / n), static_cast<float>(sum[k].z / n)};
  return out;
}

/// k-means++ and 25 rounds of Lloyd's iteration, with the random numbers of k_means(). Clusters, none empty.
inline std::vector<std::vector<std::size_t>> clusters(const std::vector<Strand>& strands, std::size_t count,
                                                      std::uint32_t seed) {
  Rng random(seed, 0x6b6d);
  std::vector<Strand> centers;
  const std::size_t n = strands.size();
  std::size_t chosen = std::min(static_cast<std::size_t>(random.uniform() * static_cast<float>(n)), n - 1);
  while (centers.size() < count) {
    centers.push_back(strands[chosen]);
    std::vector<float> nearest;
    double total = 0;
    for (const Strand& s : strands) {
      float least = std::numeric_limits<float>::max();
      for (const Strand& c : centers) least = std::min(least, distance(s, c));
      nearest.push_back(least), total += static_cast<double>(least);
    }
    if (!(total > 0)) break;
    double rest = static_cast<double>(random.uniform()) * total;
    for (std::size_t i = 0; i < n && rest >= 0; ++i) {
      if (nearest[i] > 0) chosen = i;
      rest -= static_cast<double>(nearest[i]);
    }
  }
  std::vector<std::vector<std::size_t>> members;
  for (int round = 0; round < 25; ++round) {
    std::vector<std::vector<std::size_t>> next(centers.size());
    for (std::size_t s = 0; s < n; ++s) {
      std::size_t best = 0;
      for (std::size_t c = 1; c < centers.size(); ++c)
        if (distance(strands[s], centers[c]) < distance(strands[s], centers[best])) best = c;
      next[best].push_back(s);
    }
    const bool still = next == members;
    members = next;
    if (still) break;
    for (std::size_t c = 0; c < centers.size(); ++c)
      if (!members[c].empty()) centers[c] = mean(strands, members[c]);
  }
  std::erase_if(members, [](const auto& m) { return m.empty(); });
  return members;
}

/// The member with the least sum of D to all others.
inline std::uint32_t medoid(const std::vector<Strand>& strands, const std::vector<std::size_t>& members) {
  double least = std::numeric_limits<double>::max();
  std::size_t best = 0;
  for (const std::size_t a : members) {
    double sum = 0;
    for (const std::size_t b : members)
      for (std::size_t k = 0; k < kPoints; ++k) {
        const Vec3 d = strands[a][k] - strands[b][k];
        sum += static_cast<double>(d.x) * static_cast<double>(d.x) + static_cast<double>(d.y) * static_cast<double>(d.y) +
               static_cast<double>(d.z) * static_cast<double>(d.z);
      }
    if (sum < least) least = sum, best = a;
  }
  return static_cast<std::uint32_t>(best);
}

/// Mean area of the ellipses along a cluster of fibers of one radius; no strays.
inline double area(const std::vector<Strand>& strands, const Strands& members, double radius, double covered) {
  std::vector<std::size_t> all(members.begin(), members.end());
  const Strand center = mean(strands, all);
  struct Section {
    Vec3 tangent;
    double first = 0, second = 0;  // principal moments
    Vec3 axis;                     // of the first
    Vec3 used;                     // axis after it was made to follow its neighbors
    double clear() const { return first + second > 0 ? (first - second) / (first + second) : 0; }
  };
  std::array<Section, kPoints> sections;
  const auto across = [&](std::size_t k, std::uint32_t s) {
    const Vec3 off = strands[s][k] - center[k];
    return off - sections[k].tangent * dot(off, sections[k].tangent);
  };
  for (std::size_t k = 0; k < kPoints; ++k) {
    Section& section = sections[k];
    section.tangent = normalize(center[std::min(k + 1, kPoints - 1)] - center[k > 0 ? k - 1 : 0]);
    const Vec3 u = normalize(cross(section.tangent, std::fabs(section.tangent.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 0, 1)));
    const Vec3 v = cross(section.tangent, u);
    double uu = 0, uv = 0, vv = 0;
    for (const std::uint32_t s : members) {
      const auto a = static_cast<double>(dot(across(k, s), u)), b = static_cast<double>(dot(across(k, s), v));
      uu += a * a, uv += a * b, vv += b * b;
    }
    const auto n = static_cast<double>(members.size());
    uu /= n, uv /= n, vv /= n;
    const double root = std::sqrt((uu - vv) * (uu - vv) / 4 + uv * uv);
    section.first = (uu + vv) / 2 + root, section.second = std::max(0., (uu + vv) / 2 - root);
    // A column of C − λ₂ lies along the first axis; the longer one is the safer.
    const double p = uu - section.second, q = vv - section.second;
    section.axis =
        p > q ? u * static_cast<float>(p) + v * static_cast<float>(uv) : u * static_cast<float>(uv) + v * static_cast<float>(q);
    section.axis = length(section.axis) > 0 ? normalize(section.axis) : u;
  }
  std::size_t clearest = 0;
  for (std::size_t k = 1; k < kPoints; ++k)
    if (sections[k].clear() > sections[clearest].clear()) clearest = k;
  sections[clearest].used = sections[clearest].axis;
  const auto follow = [&](std::size_t k, std::size_t from) {
    Section& section = sections[k];
    const Vec3 t = section.tangent, kept = normalize(sections[from].used - t * dot(sections[from].used, t));
    section.used = kept;
    if (section.clear() < 0.2) return;
    for (const Vec3 candidate : {section.axis, -section.axis, cross(t, section.axis), -cross(t, section.axis)})
      if (dot(candidate, kept) > std::sqrt(0.5f)) section.used = candidate;
  };
  for (std::size_t k = clearest + 1; k < kPoints; ++k) follow(k, k - 1);
  for (std::size_t k = clearest; k-- > 0;) follow(k, k + 1);

  double sum = 0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vec3 a = sections[k].used, b = cross(sections[k].tangent, a);
    double aa = radius * radius, bb = aa;
    for (const std::uint32_t s : members) {
      const auto x = static_cast<double>(dot(across(k, s), a)), y = static_cast<double>(dot(across(k, s), b));
      aa += x * x / static_cast<double>(members.size()), bb += y * y / static_cast<double>(members.size());
    }
    std::vector<double> reach;
    for (const std::uint32_t s : members)
      reach.push_back(std::hypot(static_cast<double>(dot(across(k, s), a)) / std::sqrt(aa),
                                 static_cast<double>(dot(across(k, s), b)) / std::sqrt(bb)));
    std::sort(reach.begin(), reach.end());
    std::size_t held = 1;
    while (static_cast<double>(held) < covered * static_cast<double>(reach.size()) - 1e-6) ++held;
    sum += std::numbers::pi * (reach[held - 1] * std::sqrt(aa) + radius) * (reach[held - 1] * std::sqrt(bb) + radius);
  }
  return sum / kPoints;
}

/// Parts of a cluster: the one with the most area is halved until the mean has fallen by `ratio`.
inline std::vector<Strands> divide(const std::vector<Strand>& strands, const Strands& whole, double radius,
                                   const LodSettings& s) {
  std::vector<Strands> parts = {whole};
  const auto area_of = [&](const Strands& part) { return area(strands, part, radius, static_cast<double>(s.covered)); };
  const auto mean_area = [&](const std::vector<Strands>& all) {
    double sum = 0;
    for (const Strands& p : all) sum += area_of(p) * static_cast<double>(p.size());
    return sum / static_cast<double>(whole.size());
  };
  const double target = mean_area(parts) / static_cast<double>(s.area_ratio);
  while (mean_area(parts) > target && parts.size() < 16) {
    std::size_t widest = parts.size();
    double most = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (const double w = area_of(parts[i]) * static_cast<double>(parts[i].size()); parts[i].size() > 1 && w > most)
        most = w, widest = i;
    if (widest == parts.size()) break;
    std::vector<Strand> own;
    for (const std::uint32_t strand : parts[widest]) own.push_back(strands[strand]);
    const auto halves = clusters(own, 2, s.seed);
    if (halves.size() < 2) break;
    std::vector<Strands> next = parts;
    next[widest].clear(), next.emplace_back();
    for (const std::size_t i : halves[0]) next[widest].push_back(parts[widest][i]);
    for (const std::size_t i : halves[1]) next.back().push_back(parts[widest][i]);
    const double now = mean_area(parts), then = mean_area(next);
    if (then < target && parts.size() > 1 && target / then > now / target) break;
    parts = next;
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

/// All of it: who is a guide, and who stands together on which level.
struct Chain {
  Strands guides;
  std::vector<std::vector<Strands>> levels;  ///< strands of every hair
};

inline Chain build(const StrandSet& set, const LodSettings& settings) {
  std::vector<Strand> strands;
  for (std::size_t s = 0; s < set.strand_count(); ++s) strands.push_back(fit(set, s));
  Chain chain;
  for (const auto& members : clusters(strands, settings.guides, settings.seed))
    chain.guides.push_back(medoid(strands, members));
  std::sort(chain.guides.begin(), chain.guides.end());
  std::map<std::array<std::size_t, 3>, Strands> prisms;
  for (std::uint32_t s = 0; s < strands.size(); ++s) {
    std::vector<std::pair<float, std::size_t>> near;
    for (std::size_t g = 0; g < chain.guides.size(); ++g) near.emplace_back(distance(strands[s], strands[chain.guides[g]]), g);
    std::sort(near.begin(), near.end());
    std::array<std::size_t, 3> three = {near[0].second, near[1].second, near[2].second};
    std::sort(three.begin(), three.end());
    prisms[three].push_back(s);
  }
  chain.levels.emplace_back();
  for (const auto& [guides, members] : prisms) chain.levels[0].push_back(members);
  while (chain.levels.size() < settings.levels) {
    std::vector<Strands> finer;
    for (const Strands& hair : chain.levels.back())
      for (Strands& part : divide(strands, hair, 0.5 * static_cast<double>(set.widths[0]), settings))
        finer.push_back(std::move(part));
    chain.levels.push_back(std::move(finer));
  }
  return chain;
}

}  // namespace pelage::slow
