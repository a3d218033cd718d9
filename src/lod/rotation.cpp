// Horn 1987, "Closed-form solution of absolute orientation using unit quaternions" (references.bib: Horn1987Orientation): the
// rotation is the eigenvector of the largest eigenvalue of a symmetric 4×4 matrix of the points' moments.
#include "lod/rotation.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace pelage {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// Unit eigenvector of the largest eigenvalue of the symmetric `n`, by Jacobi's rotations.
std::array<double, 4> largest_eigenvector(Matrix4 n) {
  constexpr int kSweeps = 12;  // it converges quadratically: five suffice
  Matrix4 vectors{};
  for (std::size_t i = 0; i < 4; ++i) vectors[i][i] = 1;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double off = 0, on = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 4; ++k) (i == k ? on : off) += n[i][k] * n[i][k];
    if (off <= 1e-32 * on) break;
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (n[p][q] == 0) continue;
        const double theta = (n[q][q] - n[p][p]) / (2 * n[p][q]);
        const double t = std::copysign(1, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (auto& row : n) {
          const double a = row[p], b = row[q];
          row[p] = c * a - s * b, row[q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = n[p][k], b = n[q][k];
          n[p][k] = c * a - s * b, n[q][k] = s * a + c * b;
        }
        for (auto& row : vectors) {
          const double a = row[p], b = row[q];
          row[p] = c * a - s * b, row[q] = s * a + c * b;
        }
      }
  }
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (n[i][i] > n[largest][largest]) largest = i;
  return {vectors[0][largest], vectors[1][largest], vectors[2][largest], vectors[3][largest]};
}

Vec3 mean(std::span<const Vec3> points) {
  Vec3 sum;
  for (const Vec3 p : points) sum += p;
  return sum / static_cast<float>(points.size());
}

}  // namespace

Rotation best_rotation(std::span<const Vec3> rest, std::span<const Vec3> moved) {
  const Vec3 from = mean(rest), to = mean(moved);
  double m[3][3] = {}, size = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3 a = rest[i] - from, b = moved[i] - to;
    const double x[3] = {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
    const double y[3] = {static_cast<double>(b.x), static_cast<double>(b.y), static_cast<double>(b.z)};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m[r][c] += x[r] * y[c];
    size += x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  }
  Matrix4 n{};
  n[0] = {m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]};
  n[1] = {n[0][1], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]};
  n[2] = {n[0][2], n[1][2], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]};
  n[3] = {n[0][3], n[1][3], n[2][3], m[2][2] - m[0][0] - m[1][1]};
  n[0][0] += 1e-9 * size;  // what the points leave open: no turn
  const std::array<double, 4> q = largest_eigenvector(n);
  const double sign = q[0] < 0 ? -1 : 1;
  return {static_cast<float>(sign * q[0]),
          {static_cast<float>(sign * q[1]), static_cast<float>(sign * q[2]), static_cast<float>(sign * q[3])}};
}

Rotation blend(const Rotation& a, const Rotation& b, float t) {
  const float sign = a.w * b.w + dot(a.v, b.v) < 0 ? -1.f : 1.f;
  const float w = a.w + (sign * b.w - a.w) * t;
  const Vec3 v = a.v + (b.v * sign - a.v) * t;
  const float l = std::sqrt(w * w + dot(v, v));
  return {w / l, v / l};
}

}  // namespace pelage
