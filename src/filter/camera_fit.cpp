// A place X, seen at (x, y), asks of the rows a, b, c of the map, with c₄ = 1 in coordinates about the mean place, that
//   a·(X,1) − x·c·X = x   and   b·(X,1) − y·c·X = y,
// each divided by the distance w = c·X + 1, which makes the residual one in pixels. w is that of the solution before: three
// rounds are more than the distances of hair ever need. A ridge of 1e-12 of the equations' size, far below what any direction in
// which the places extend weighs, sets to 0 what the places say nothing about.
#include "filter/camera_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"

namespace pelage {
namespace {

constexpr std::size_t kUnknowns = 11;
constexpr int kRounds = 3;
constexpr double kRidge = 1e-12;
constexpr std::size_t kMostPlaces = 200'000;  // of more, every second, third, … is taken

using Unknowns = std::array<double, kUnknowns>;  // a₁…a₄, b₁…b₄, c₁…c₃

/// Σ equations·equationsᵀ and Σ equations·right side, then the solution.
class NormalEquations {
 public:
  void add(const Unknowns& row, double right, double weight) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      if (row[i] == 0) continue;
      const double w = weight * row[i];
      for (std::size_t j = 0; j <= i; ++j) matrix_[i][j] += w * row[j];
      right_[i] += w * right;
    }
  }

  /// By Cholesky's decomposition.
  Unknowns solve() {
    double trace = 0;
    for (std::size_t i = 0; i < kUnknowns; ++i) trace += matrix_[i][i];
    Unknowns x = right_;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      matrix_[i][i] += kRidge * trace;
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = matrix_[i][j];
        for (std::size_t k = 0; k < j; ++k) sum -= matrix_[i][k] * matrix_[j][k];
        matrix_[i][j] = i == j ? std::sqrt(std::max(sum, kRidge * trace)) : sum / matrix_[j][j];
      }
      for (std::size_t k = 0; k < i; ++k) x[i] -= matrix_[i][k] * x[k];
      x[i] /= matrix_[i][i];
    }
    for (std::size_t i = kUnknowns; i-- > 0;) {
      for (std::size_t k = i + 1; k < kUnknowns; ++k) x[i] -= matrix_[k][i] * x[k];
      x[i] /= matrix_[i][i];
    }
    return x;
  }

 private:
  std::array<Unknowns, kUnknowns> matrix_{};  // the lower half
  Unknowns right_{};
};

/// Coordinates about the mean, in units of their root mean square distance from it.
template <std::size_t N>
struct Normalized {
  std::array<double, N> mean{};
  double scale = 1;

  template <class At>
  Normalized(std::size_t count, std::size_t stride, const At& at) {
    double n = 0, square = 0;
    for (std::size_t i = 0; i < count; i += stride, ++n)
      for (std::size_t k = 0; k < N; ++k) mean[k] += at(i)[k];
    for (double& m : mean) m /= n;
    for (std::size_t i = 0; i < count; i += stride)
      for (std::size_t k = 0; k < N; ++k) square += (at(i)[k] - mean[k]) * (at(i)[k] - mean[k]);
    if (square > 0) scale = std::sqrt(square / n);
  }
  std::array<double, N> operator()(std::array<double, N> v) const {
    for (std::size_t k = 0; k < N; ++k) v[k] = (v[k] - mean[k]) / scale;
    return v;
  }
};

std::array<double, 3> wide(Vec3 v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }
std::array<double, 2> wide(Vec2 v) { return {static_cast<double>(v.x), static_cast<double>(v.y)}; }

}  // namespace

bool ProjectiveCamera::see(Vec3 p, Seen& seen) const {
  const std::array<double, 3> v = wide(p);
  double r[3];
  for (std::size_t i = 0; i < 3; ++i) r[i] = rows_[i][0] * v[0] + rows_[i][1] * v[1] + rows_[i][2] * v[2] + rows_[i][3];
  if (!(r[2] > 0)) return false;
  seen.screen = {static_cast<float>(r[0] / r[2]), static_cast<float>(r[1] / r[2])};
  seen.distance = static_cast<float>(r[2]);
  return true;
}

Vec2 ProjectiveCamera::move(Vec3 p, Vec3 direction) const {
  const std::array<double, 3> v = wide(p), d = wide(direction);
  double r[3], dr[3];
  for (std::size_t i = 0; i < 3; ++i) {
    dr[i] = rows_[i][0] * d[0] + rows_[i][1] * d[1] + rows_[i][2] * d[2];
    r[i] = rows_[i][0] * v[0] + rows_[i][1] * v[1] + rows_[i][2] * v[2] + rows_[i][3];
  }
  const double w2 = r[2] * r[2];
  return {static_cast<float>((dr[0] * r[2] - r[0] * dr[2]) / w2), static_cast<float>((dr[1] * r[2] - r[1] * dr[2]) / w2)};
}

float ProjectiveCamera::pixels_per_unit(Vec3 p) const {
  const Vec2 x = move(p, {1, 0, 0}), y = move(p, {0, 1, 0}), z = move(p, {0, 0, 1});
  return std::sqrt((dot(x, x) + dot(y, y) + dot(z, z)) / 2);
}

ProjectiveCamera fit_camera(std::span<const Vec3> positions, std::span<const Vec2> screen) {
  PELAGE_CHECK_EQ(positions.size(), screen.size());
  ProjectiveCamera camera;
  if (positions.empty()) return camera;
  const std::size_t count = positions.size(), stride = (count + kMostPlaces - 1) / kMostPlaces;
  const Normalized<3> place(count, stride, [&](std::size_t i) { return wide(positions[i]); });
  const Normalized<2> pixel(count, stride, [&](std::size_t i) { return wide(screen[i]); });
  Unknowns s{};
  for (int round = 0; round < kRounds; ++round) {
    NormalEquations equations;
    for (std::size_t i = 0; i < count; i += stride) {
      const auto [X, Y, Z] = place(wide(positions[i]));
      const auto [x, y] = pixel(wide(screen[i]));
      const double w = std::max(0.01, s[8] * X + s[9] * Y + s[10] * Z + 1), weight = 1 / (w * w);
      equations.add({X, Y, Z, 1, 0, 0, 0, 0, -x * X, -x * Y, -x * Z}, x, weight);
      equations.add({0, 0, 0, 0, X, Y, Z, 1, -y * X, -y * Y, -y * Z}, y, weight);
    }
    s = equations.solve();
  }
  // Back to the coordinates that came.
  const double normalized[3][4] = {{s[0], s[1], s[2], s[3]}, {s[4], s[5], s[6], s[7]}, {s[8], s[9], s[10], 1}};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 2; ++i) camera.rows_[i][k] = pixel.scale * normalized[i][k] + pixel.mean[i] * normalized[2][k];
    camera.rows_[2][k] = normalized[2][k];
  }
  for (auto& row : camera.rows_)
    for (std::size_t k = 0; k < 3; ++k) row[k] /= place.scale, row[3] -= row[k] * place.mean[k];
  return camera;
}

}  // namespace pelage
