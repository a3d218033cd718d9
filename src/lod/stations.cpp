#include "lod/stations.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/curve_basis.h"
#include "frame/strand_path.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = Stations::kPoints, kInner = kPoints - 2;
constexpr std::size_t kSamples =
    4 * (kPoints - 1) + 1;  // of a strand's curve: more than one a control point, so that they average

using Row = std::array<double, kPoints>;

/// What each control point counts at each sample: a Catmull-Rom spline whose ends go on straight.
std::array<Row, kSamples> spline_weights() {
  std::array<Row, kSamples> h{};
  for (std::size_t j = 0; j < kSamples; ++j) {
    const double x = static_cast<double>(j * (kPoints - 1)) / (kSamples - 1);
    const std::size_t span = std::min(static_cast<std::size_t>(x), kPoints - 2);
    const Vec4 w = basis_weights(CurveBasis::kCatmullRom, static_cast<float>(x - static_cast<double>(span)));
    const double value[4] = {static_cast<double>(w.x), static_cast<double>(w.y), static_cast<double>(w.z),
                             static_cast<double>(w.w)};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t at = span + i;  // control point + 1
      if (at == 0) h[j][0] += 2 * value[i], h[j][1] -= value[i];
      else if (at == kPoints + 1) h[j][kPoints - 1] += 2 * value[i], h[j][kPoints - 2] -= value[i];
      else h[j][at - 1] += value[i];
    }
  }
  return h;
}

/// Solves a·x = b for symmetric positive definite a, in place.
void solve(std::array<std::array<double, kInner>, kInner> a, std::array<double, kInner>& b) {
  for (std::size_t i = 0; i < kInner; ++i)
    for (std::size_t r = i + 1; r < kInner; ++r) {
      const double f = a[r][i] / a[i][i];
      for (std::size_t c = i; c < kInner; ++c) a[r][c] -= f * a[i][c];
      b[r] -= f * b[i];
    }
  for (std::size_t i = kInner; i-- > 0;) {
    for (std::size_t c = i + 1; c < kInner; ++c) b[i] -= a[i][c] * b[c];
    b[i] /= a[i][i];
  }
}

/// [sample][control point]: inner control points as sums of samples. The ends are the first and the last sample.
struct Projection {
  alignas(64) float weight[kSamples][kPoints] = {};

  Projection() {
    const std::array<Row, kSamples> h = spline_weights();
    std::array<std::array<double, kInner>, kInner> normal{};
    for (std::size_t i = 0; i < kInner; ++i)
      for (std::size_t k = 0; k < kInner; ++k)
        for (const Row& row : h) normal[i][k] += row[i + 1] * row[k + 1];
    for (std::size_t j = 0; j < kSamples; ++j) {
      // A sample counts by itself; the first and the last also through the end that stands there.
      std::array<double, kInner> column{};
      for (std::size_t i = 0; i < kInner; ++i) {
        column[i] = h[j][i + 1];
        if (j == 0)
          for (const Row& row : h) column[i] -= row[i + 1] * row[0];
        if (j == kSamples - 1)
          for (const Row& row : h) column[i] -= row[i + 1] * row[kPoints - 1];
      }
      solve(normal, column);
      for (std::size_t i = 0; i < kInner; ++i) weight[j][i + 1] = static_cast<float>(column[i]);
    }
  }
};

void project(const Projection& projection, const std::array<Vec3, kSamples>& samples, Vec3* points) {
  float x[kPoints] = {}, y[kPoints] = {}, z[kPoints] = {};
  for (std::size_t j = 0; j < kSamples; ++j)
    for (std::size_t k = 0; k < kPoints; ++k) {
      const float w = projection.weight[j][k];
      x[k] += w * samples[j].x, y[k] += w * samples[j].y, z[k] += w * samples[j].z;
    }
  for (std::size_t k = 1; k + 1 < kPoints; ++k) points[k] = {x[k], y[k], z[k]};
  points[0] = samples.front(), points[kPoints - 1] = samples.back();
}

/// Largest distance from the samples around each control point to the spline.
void measure_strays(const std::array<Row, kSamples>& h, const std::array<Vec3, kSamples>& samples, const Vec3* points,
                    float* strays) {
  constexpr std::size_t kSpan = (kSamples - 1) / (kPoints - 1);
  std::array<float, kSamples> off;
  for (std::size_t j = 0; j < kSamples; ++j) {
    Vec3 p;  // four control points count at a sample, those around its span
    const std::size_t span = std::min(j / kSpan, kPoints - 2);
    for (std::size_t k = span > 0 ? span - 1 : 0; k < std::min(span + 3, kPoints); ++k)
      p += points[k] * static_cast<float>(h[j][k]);
    off[j] = length(samples[j] - p);
  }
  for (std::size_t k = 0; k < kPoints; ++k) {
    const std::size_t first = k > 0 ? k * kSpan - kSpan / 2 : 0, last = std::min(k * kSpan + kSpan / 2, kSamples - 1);
    strays[k] = *std::max_element(&off[first], &off[last] + 1);
  }
}

}  // namespace

Stations fit_stations(const StrandSet& strands, const Progress& progress) {
  Stations out;
  const std::size_t count = strands.strand_count();
  out.points.resize(count * kPoints), out.radii.resize(count * kPoints);
  out.strays.resize(count * kPoints), out.lengths.resize(count);
  const std::array<Row, kSamples> weights = spline_weights();
  const Projection projection;
  SharedProgress shared(progress, "lod strands", std::max<std::size_t>(1, count));
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    StrandPath path;
    using Knot = StrandPath::Knot;
    std::array<Vec3, kSamples> samples;
    for (std::size_t s = begin; s < end; ++s) {
      path.assign(strands, s);
      path.walk(kSamples, [&](std::size_t i, const Knot& a, const Knot& b, float t) { samples[i] = lerp(a.p, b.p, t); });
      path.walk(kPoints, [&](std::size_t i, const Knot& a, const Knot& b, float t) {
        out.radii[s * kPoints + i] = 0.5f * (a.width + (b.width - a.width) * t);
      });
      samples.front() = strands.points[strands.offsets[s]], samples.back() = strands.points[strands.offsets[s + 1] - 1];
      project(projection, samples, &out.points[s * kPoints]);
      measure_strays(weights, samples, &out.points[s * kPoints], &out.strays[s * kPoints]);
      out.lengths[s] = static_cast<float>(path.length());
    }
    shared.add(end - begin);
  });
  return out;
}

void bspline_through(const Vec3* stations, Vec3* control) {
  // (c[k−1] + 4·c[k] + c[k+1])/6 = s[k] between the ends, which are their own: Thomas' elimination of a tridiagonal system.
  std::array<float, kPoints> factor{};
  std::array<Vec3, kPoints> rest;
  rest[0] = stations[0];
  for (std::size_t k = 1; k + 1 < kPoints; ++k) {
    const float pivot = 1 / (4 - factor[k - 1]);
    factor[k] = pivot;
    rest[k] = (stations[k] * 6.f - rest[k - 1]) * pivot;
  }
  control[kPoints - 1] = stations[kPoints - 1];
  control[0] = stations[0];
  for (std::size_t k = kPoints - 2; k > 0; --k) control[k] = rest[k] - control[k + 1] * factor[k];
}

}  // namespace pelage
