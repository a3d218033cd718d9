#include "groom/hairmesh/layer_spline.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace pelage {
namespace {

/// Solves a·x = b in place of `b` [n][columns]; `a` [n][n] is symmetric and positive definite, and is overwritten (Cholesky).
void solve_positive(std::vector<double>& a, std::size_t n, std::vector<double>& b, std::size_t columns) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k)
      for (std::size_t i = j; i < n; ++i) a[i * n + j] -= a[i * n + k] * a[j * n + k];
    const double root = std::sqrt(a[j * n + j]);
    for (std::size_t i = j; i < n; ++i) a[i * n + j] /= root;
  }
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i * columns + c] -= a[i * n + k] * b[k * columns + c];
      b[i * columns + c] /= a[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) b[i * columns + c] -= a[k * n + i] * b[k * columns + c];
      b[i * columns + c] /= a[i * n + i];
    }
  }
}

}  // namespace

LayerSpline::LayerSpline(std::uint32_t layers, std::size_t samples) : layers_(layers), samples_(samples) {
  PELAGE_CHECK(layers >= 2 && samples >= layers);
  const std::size_t n = layers;
  std::vector<double> normal(n * n);
  solution_.resize(n * samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const Weights h = weights(static_cast<double>(i) / static_cast<double>(samples - 1), false);
    const double count = i == 0 ? kRootWeight : 1;
    for (std::size_t r = 0; r < h.count; ++r) {
      solution_[(h.first + r) * samples + i] = count * h.value[r];
      for (std::size_t c = 0; c < h.count; ++c) normal[(h.first + r) * n + h.first + c] += count * h.value[r] * h.value[c];
    }
  }
  // Where there are hardly more points than layers some may go without: those keep near 0 instead of nowhere.
  for (std::size_t k = 0; k < n; ++k) normal[k * n + k] += 1e-9;
  solve_positive(normal, n, solution_, samples);
}

LayerSpline::Weights LayerSpline::weights(double w, bool derivative) const {
  const std::size_t last = layers_ - 2;
  const double x = w * (layers_ - 1);
  const auto span = std::min(static_cast<std::size_t>(std::max(x, 0.)), last);
  const double t = x - static_cast<double>(span), s = std::min(t, 1.), onward = t - s;
  // Of p0, m0, p1, m1: the point, its derivative, and both where it goes straight on.
  std::array<double, 4> h{(1 + 2 * s) * (1 - s) * (1 - s), s * (1 - s) * (1 - s), s * s * (3 - 2 * s), s * s * (s - 1)};
  const std::array<double, 4> d{6 * s * (s - 1), (1 - s) * (1 - 3 * s), 6 * s * (1 - s), s * (3 * s - 2)};
  for (std::size_t i = 0; i < 4; ++i) h[i] = derivative ? d[i] * (layers_ - 1) : h[i] + onward * d[i];
  // Tangents in terms of the layers span − 1 … span + 2.
  std::array<double, 4> v{0, h[0], h[2], 0};
  if (span == 0) v[1] -= h[1], v[2] += h[1];
  else v[0] -= 0.5 * h[1], v[2] += 0.5 * h[1];
  if (span == last) v[1] -= h[3], v[2] += h[3];
  else v[1] -= 0.5 * h[3], v[3] += 0.5 * h[3];
  Weights result{span == 0 ? 0 : span - 1, v, 4};
  if (span == 0) {
    result.value = {v[1], v[2], v[3], 0};
    --result.count;
  }
  if (span == last) --result.count;
  return result;
}

Vec3 LayerSpline::blend(const Vec3* vertices, float w, bool derivative) const {
  const Weights h = weights(static_cast<double>(w), derivative);
  Vec3 p;
  for (std::size_t i = 0; i < h.count; ++i) p += vertices[h.first + i] * static_cast<float>(h.value[i]);
  return p;
}

void LayerSpline::project(const Vec3* points, Vec3* vertices) const {
  for (std::size_t k = 0; k < layers_; ++k) {
    const double* row = &solution_[k * samples_];
    double x = 0, y = 0, z = 0;
    for (std::size_t i = 0; i < samples_; ++i) {
      x += row[i] * static_cast<double>(points[i].x);
      y += row[i] * static_cast<double>(points[i].y);
      z += row[i] * static_cast<double>(points[i].z);
    }
    vertices[k] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }
}

}  // namespace pelage
