// One rod, step by step, in double precision and without cleverness: what rod.cpp is held against. Constraints are rows of numbers
// and masses a diagonal; every system is solved by elimination.
#pragma once

#include <pelage/simulate.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "groom/rod.h"

namespace pelage::slow {

using Vec = std::array<double, 3>;
using Mat = std::array<Vec, 3>;
using System = std::vector<std::vector<double>>;

inline Vec wide(Vec3 v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }
inline Vec add(const Vec& a, const Vec& b, double s = 1) { return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]}; }
inline Vec scaled(const Vec& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double inner(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double norm(const Vec& a) { return std::sqrt(inner(a, a)); }
inline Vec unit(const Vec& a) { return scaled(a, 1 / norm(a)); }
inline Vec times(const Mat& m, const Vec& v) { return {inner(m[0], v), inner(m[1], v), inner(m[2], v)}; }
inline Mat transposed(const Mat& m) {
  Mat t;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) t[i][j] = m[j][i];
  return t;
}
/// Gauss with pivots; `rows` are those of the matrix, then the right side.
inline std::vector<double> solved(System rows) {
  const std::size_t n = rows.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t best = c;
    for (std::size_t r = c; r < n; ++r)
      if (std::fabs(rows[r][c]) > std::fabs(rows[best][c])) best = r;
    std::swap(rows[c], rows[best]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double f = rows[r][c] / rows[c][c];
      for (std::size_t k = c; k <= n; ++k) rows[r][k] -= f * rows[c][k];
    }
  }
  std::vector<double> x;
  for (std::size_t r = 0; r < n; ++r) x.push_back(rows[r][n] / rows[r][r]);
  return x;
}

/// Without head and wind.
class Rod {
 public:
  static constexpr std::size_t kPoints = LodHierarchy::kPoints;

  Rod(const std::vector<Vec3>& rest, const SimulationSettings& settings) : s_(settings) {
    for (const Vec3 p : rest) rest_.push_back(wide(p));
    x_ = rest_, v_.assign(kPoints, Vec{});
    for (std::size_t j = 0; j + 1 < kPoints; ++j) length_.push_back(norm(add(rest_[j + 1], rest_[j], -1)));
    for (std::size_t j = 0; j < kPoints; ++j)
      weight_.push_back(j < 2 ? 0 : 1 / (0.5 * (length_[j - 1] + (j + 1 < kPoints ? length_[j] : 0))));
    set_supports();
  }

  Vec3 point(std::size_t j) const {
    return {static_cast<float>(x_[j][0]), static_cast<float>(x_[j][1]), static_cast<float>(x_[j][2])};
  }

  void step(const groom::RodStep& step) {
    const double dt = static_cast<double>(step.seconds);
    const auto head = [&](const Vec& p) { return add(times(matrix(step.head), p), wide(step.head.shift)); };
    const std::vector<Vec> before = x_;
    predict(step, dt);
    for (std::size_t j = 0; j < 2; ++j) x_[j] = head(rest_[j]);
    for (std::size_t j = 2; j < kPoints; ++j) {
      const double left = static_cast<double>(kPoints - 1 - j) / (kPoints - 3);
      const double omega = 2 * 3.14159265358979 * static_cast<double>(s_.shape_frequency) * left * left;
      const double compliance = 1 / (omega * omega * dt * dt);  // over the mass
      if (omega > 0) x_[j] = add(x_[j], add(x_[j], head(rest_[j]), -1), -1 / (1 + compliance));
    }
    bend(step, dt);
    for (int i = 0; i < 2; ++i) stretch(dt, i == 0);
    for (std::size_t j = 0; j < kPoints; ++j) v_[j] = scaled(add(x_[j], before[j], -1), 1 / dt);
  }

 private:
  static Mat matrix(const Rigid& r) {
    Mat m;
    const Vec3 columns[3] = {r.turn({1, 0, 0}), r.turn({0, 1, 0}), r.turn({0, 0, 1})};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 3; ++i) m[i][c] = wide(columns[c])[i];
    return m;
  }

  void set_supports() {
    support_.assign(kPoints, Vec{}), tension_.assign(kPoints, 0);
    std::vector<Vec> load(kPoints, Vec{});
    for (std::size_t j = 2; j < kPoints; ++j) load[j] = scaled(wide(s_.gravity), static_cast<double>(s_.support) / weight_[j]);
    for (std::size_t j = kPoints - 1; j >= 2; --j) {
      const Vec along = unit(add(rest_[j], rest_[j - 1], -1));
      tension_[j - 1] = std::max(0., inner(load[j], along));
      support_[j] = add(scaled(along, tension_[j - 1]), load[j], -1);
      load[j - 1] = add(load[j - 1], along, tension_[j - 1]);
    }
  }

  void predict(const groom::RodStep& step, double dt) {
    const Mat turn = matrix(step.head), back = transposed(matrix(step.head_before));
    const std::vector<Vec> x = x_;
    for (std::size_t j = 2; j < kPoints; ++j) {
      Vec force = times(turn, support_[j]);
      force = add(force, unit(add(x[j], x[j - 1], -1)), -tension_[j - 1]);
      if (j + 1 < kPoints) force = add(force, unit(add(x[j + 1], x[j], -1)), tension_[j]);
      Vec v = add(v_[j], add(wide(s_.gravity), force, weight_[j]), dt);
      const Vec there = add(times(turn, times(back, add(x[j], wide(step.head_before.shift), -1))), wide(step.head.shift));
      const Vec of_head = scaled(add(there, x[j], -1), 1 / dt);
      v = add(of_head, add(v, of_head, -1), std::exp(-static_cast<double>(s_.damping) * dt));
      v = scaled(v, std::exp(-static_cast<double>(s_.drag) * dt));
      x_[j] = add(x[j], v, dt);
    }
  }

  void bend(const groom::RodStep& step, double dt) {
    for (std::size_t i = 0; i + 4 <= kPoints; ++i) {
      const double piece = (length_[i] + length_[i + 1] + length_[i + 2]) / 3;
      const double share = 1 / (1 + std::pow(piece, 4) / (static_cast<double>(s_.bend_stiffness) * dt * dt));
      double total = 0;
      Vec rest{}, now{};
      std::array<double, 4> mass;
      for (std::size_t k = 0; k < 4; ++k) {
        mass[k] = weight_[i + k] > 0 ? 1 / weight_[i + k] : 100 * length_[0];
        rest = add(rest, rest_[i + k], mass[k]), now = add(now, x_[i + k], mass[k]), total += mass[k];
      }
      rest = scaled(rest, 1 / total), now = scaled(now, 1 / total);
      std::array<Vec, 4> a, b;
      for (std::size_t k = 0; k < 4; ++k) a[k] = add(rest_[i + k], rest, -1), b[k] = add(x_[i + k], now, -1);
      Mat turn = i == 0 ? matrix(step.head) : best_turn(a, b, mass);
      for (std::size_t k = 0; k < 4; ++k) {
        if (!(weight_[i + k] > 0)) continue;
        const Vec goal = i == 0 ? add(times(turn, rest_[k]), wide(step.head.shift)) : add(times(turn, a[k]), now);
        x_[i + k] = add(x_[i + k], add(goal, x_[i + k], -1), share);
      }
    }
  }

  /// Horn 1987 (references.bib: Horn1987Orientation): the eigenvector of the largest eigenvalue, by powers of the matrix.
  static Mat best_turn(const std::array<Vec, 4>& a, const std::array<Vec, 4>& b, const std::array<double, 4>& mass) {
    double s[3][3] = {}, size = 0;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          s[r][c] += mass[k] * a[k][r] * b[k][c], size += std::fabs(mass[k] * a[k][r] * b[k][c]);
    double n[4][4] = {{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
                      {0, s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
                      {0, 0, -s[0][0] + s[1][1] - s[2][2], s[1][2] + s[2][1]},
                      {0, 0, 0, -s[0][0] - s[1][1] + s[2][2]}};
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < r; ++c) n[r][c] = n[c][r];
      n[r][r] += size;  // all eigenvalues positive
    }
    std::array<double, 4> q{1, 0.01, 0.02, 0.03};
    for (int i = 0; i < 3000; ++i) {
      std::array<double, 4> p{};
      double norm2 = 0;
      for (std::size_t r = 0; r < 4; ++r) {
        for (std::size_t c = 0; c < 4; ++c) p[r] += n[r][c] * q[c];
        norm2 += p[r] * p[r];
      }
      for (std::size_t r = 0; r < 4; ++r) q[r] = p[r] / std::sqrt(norm2);
    }
    const auto [w, x, y, z] = q;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  }

  void stretch(double dt, bool first) {
    const std::size_t n = kPoints - 2;  // pieces 1 … kPoints − 2
    if (first) multiplier_.assign(n, 0);
    std::vector<Vec> along;
    for (std::size_t i = 1; i <= n; ++i) along.push_back(unit(add(x_[i + 1], x_[i], -1)));
    System rows(n, std::vector<double>(n + 1, 0));
    for (std::size_t i = 0; i < n; ++i) {
      const double compliance = length_[i + 1] / (static_cast<double>(s_.stretch_stiffness) * dt * dt);
      rows[i][i] = weight_[i + 1] + weight_[i + 2] + compliance;
      if (i > 0) rows[i][i - 1] = -weight_[i + 1] * inner(along[i - 1], along[i]);
      if (i + 1 < n) rows[i][i + 1] = -weight_[i + 2] * inner(along[i], along[i + 1]);
      rows[i][n] = -(norm(add(x_[i + 2], x_[i + 1], -1)) - length_[i + 1]) - compliance * multiplier_[i];
    }
    const std::vector<double> change = solved(rows);
    for (std::size_t i = 0; i < n; ++i) {
      multiplier_[i] += change[i];
      x_[i + 1] = add(x_[i + 1], along[i], -change[i] * weight_[i + 1]);
      x_[i + 2] = add(x_[i + 2], along[i], change[i] * weight_[i + 2]);
    }
  }

  const SimulationSettings& s_;
  std::vector<Vec> rest_, x_, v_, support_;
  std::vector<double> length_, weight_, tension_, multiplier_;
};

}  // namespace pelage::slow
