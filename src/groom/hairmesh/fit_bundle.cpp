#include "groom/hairmesh/fit_bundle.h"

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

constexpr int kRounds = 4;       // of corners and places in turn
constexpr double kPrior = 0.25;  // strands that would have to say otherwise to move a corner from where it is thought to be

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// Inverse of a symmetric positive definite matrix (Gauss–Jordan; its pivots are positive).
Matrix4 inverse(Matrix4 a) {
  Matrix4 b{};
  for (std::size_t i = 0; i < 4; ++i) b[i][i] = 1;
  for (std::size_t p = 0; p < 4; ++p) {
    const double pivot = 1 / a[p][p];
    for (std::size_t c = 0; c < 4; ++c) a[p][c] *= pivot, b[p][c] *= pivot;
    for (std::size_t r = 0; r < 4; ++r) {
      if (r == p) continue;
      const double f = a[r][p];
      for (std::size_t c = 0; c < 4; ++c) a[r][c] -= f * a[p][c], b[r][c] -= f * b[p][c];
    }
  }
  return b;
}

/// Least squares for the four corners of a bilinear patch, with a prior for each: Tikhonov's.
class PatchSolver {
 public:
  explicit PatchSolver(const std::vector<Vec2>& uv) : uv_(uv) {
    Matrix4 normal{};
    for (const Vec2 p : uv) {
      const std::array<float, 4> b = corner_weights(p);
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) normal[i][j] += static_cast<double>(b[i] * b[j]);
    }
    for (std::size_t i = 0; i < 4; ++i) normal[i][i] += kPrior;
    inverse_ = inverse(normal);
  }

  /// value(strand) → Vec3; prior: the mean of the values plus `offset`.
  template <class Value>
  std::array<Vec3, 4> solve(const Value& value, const std::array<Vec3, 4>& offset) const {
    std::array<std::array<double, 3>, 4> right{};
    double mean[3] = {};
    for (std::size_t s = 0; s < uv_.size(); ++s) {
      const std::array<float, 4> b = corner_weights(uv_[s]);
      const Vec3 p = value(s);
      const float component[3] = {p.x, p.y, p.z};
      for (std::size_t d = 0; d < 3; ++d) {
        mean[d] += static_cast<double>(component[d]) / static_cast<double>(uv_.size());
        for (std::size_t c = 0; c < 4; ++c) right[c][d] += static_cast<double>(b[c]) * static_cast<double>(component[d]);
      }
    }
    std::array<Vec3, 4> corner;
    for (std::size_t c = 0; c < 4; ++c) {
      const float o[3] = {offset[c].x, offset[c].y, offset[c].z};
      for (std::size_t d = 0; d < 3; ++d) right[c][d] += kPrior * (mean[d] + static_cast<double>(o[d]));
    }
    for (std::size_t c = 0; c < 4; ++c) {
      double p[3] = {};
      for (std::size_t d = 0; d < 3; ++d)
        for (std::size_t k = 0; k < 4; ++k) p[d] += inverse_[c][k] * right[k][d];
      corner[c] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    }
    return corner;
  }

 private:
  const std::vector<Vec2>& uv_;
  Matrix4 inverse_;
};

/// Directions in which roots lie farthest apart, times half the side of a square that is spread as widely.
struct RootFrame {
  Vec3 middle, u, v;
};

using Matrix3 = std::array<std::array<double, 3>, 3>;

Vec3 times(const Matrix3& m, Vec3 p) {
  const auto row = [&](std::size_t i) {
    return static_cast<float>(m[i][0] * static_cast<double>(p.x) + m[i][1] * static_cast<double>(p.y) +
                              m[i][2] * static_cast<double>(p.z));
  };
  return {row(0), row(1), row(2)};
}

/// Unit eigenvector of the largest eigenvalue (power iteration); any direction where there is none.
Vec3 largest_direction(const Matrix3& m) {
  Vec3 best = times(m, {1, 0, 0});
  for (const Vec3 axis : {Vec3(0, 1, 0), Vec3(0, 0, 1)})
    if (const Vec3 p = times(m, axis); length(p) > length(best)) best = p;
  if (!(length(best) > 0)) return {1, 0, 0};
  for (int i = 0; i < 60; ++i) best = normalize(times(m, normalize(best)));
  return best;
}

RootFrame root_frame(const FitStrands& f, const std::vector<std::uint32_t>& strands) {
  RootFrame frame;
  double mean[3] = {};
  const double n = static_cast<double>(strands.size());
  const auto root = [&](std::uint32_t s) { return f.strand(s)[0]; };
  for (const std::uint32_t s : strands) {
    const Vec3 p = root(s);
    mean[0] += static_cast<double>(p.x) / n, mean[1] += static_cast<double>(p.y) / n, mean[2] += static_cast<double>(p.z) / n;
  }
  frame.middle = {static_cast<float>(mean[0]), static_cast<float>(mean[1]), static_cast<float>(mean[2])};
  Matrix3 covariance{};
  for (const std::uint32_t s : strands) {
    const Vec3 d = (root(s) - frame.middle) * 1e3f;  // millimetres: squares of hair's distances are small numbers
    const double x[3] = {static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) covariance[i][j] += x[i] * x[j] / n;
  }
  const auto spread = [&](Vec3 axis) { return std::sqrt(std::max(0.f, dot(axis, times(covariance, axis)))) * 1e-3f; };
  const Vec3 u = largest_direction(covariance);
  const double largest = static_cast<double>(dot(u, times(covariance, u)));
  const double unit[3] = {static_cast<double>(u.x), static_cast<double>(u.y), static_cast<double>(u.z)};
  Matrix3 rest = covariance;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) rest[i][j] -= largest * unit[i] * unit[j];
  Vec3 v = largest_direction(rest);
  v = v - u * dot(v, u);
  if (!(length(v) > 1e-3f)) v = std::fabs(u.y) < 0.9f ? cross(u, {0, 1, 0}) : cross(u, {1, 0, 0});
  v = normalize(v);
  const float least = std::max(f.widths[strands.front() * FitStrands::kWidths], 1e-5f);
  constexpr float kRoot3 = 1.7320508f;
  // Of rectangles that are turned against these directions, the one out of which roots lie least far: a square has none.
  constexpr int kTurns = 12;
  float fewest = INFINITY;
  for (int turn = 0; turn < kTurns; ++turn) {
    const float angle = 1.5707963f * static_cast<float>(turn) / kTurns;
    const Vec3 a = u * std::cos(angle) + v * std::sin(angle), b = v * std::cos(angle) - u * std::sin(angle);
    const float side_a = std::max(kRoot3 * spread(a), least), side_b = std::max(kRoot3 * spread(b), least);
    float outside = 0;
    for (const std::uint32_t s : strands) {
      const Vec3 d = root(s) - frame.middle;
      const float x = std::max(0.f, std::fabs(dot(d, a)) - side_a), y = std::max(0.f, std::fabs(dot(d, b)) - side_b);
      outside += x * x + y * y;
    }
    if (outside < fewest) fewest = outside, frame.u = a * side_a, frame.v = b * side_b;
  }
  return frame;
}

Vec2 clamped(Vec2 p) { return {std::clamp(p.x, 0.f, 1.f), std::clamp(p.y, 0.f, 1.f)}; }

class Fitter {
 public:
  Fitter(const FitStrands& f, const LayerSpline& spline, FitBundle& b)
      : f_(f), spline_(spline), b_(b), n_(b.strands.size()), layers_(spline.layers()), frame_(root_frame(f, b.strands)) {
    const Vec3 u = frame_.u, v = frame_.v;
    offset_ = {-u - v, u - v, u + v, v - u};
  }

  void fit() {
    place_by_roots();
    find_lengths();
    slow_.resize(n_ * layers_);
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < n_; ++i) project(i, round > 0);
      solve();
      if (round + 1 < kRounds) move_places();
    }
    b_.groom_uv = PatchSolver(b_.uv).solve([&](std::size_t i) { return f_.groom_uv[b_.strands[i]]; }, {});
    for (Vec3& p : b_.groom_uv) p = {std::clamp(p.x, 0.f, 1.f), std::clamp(p.y, 0.f, 1.f), 0};
    sum_error();
  }

 private:
  void place_by_roots() {
    b_.uv.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      const Vec3 d = f_.strand(b_.strands[i])[0] - frame_.middle;
      b_.uv[i] = clamped(
          {0.5f + 0.5f * dot(d, frame_.u) / dot(frame_.u, frame_.u), 0.5f + 0.5f * dot(d, frame_.v) / dot(frame_.v, frame_.v)});
    }
  }

  /// Lengths are a bilinear function of the place, times a share that is even between 1 − variation and 1: of mean and
  /// spread as measured.
  void find_lengths() {
    const PatchSolver solver(b_.uv);
    const std::array<Vec3, 4> corner = solver.solve([&](std::size_t i) { return Vec3(f_.lengths[b_.strands[i]], 0, 0); }, {});
    std::vector<double> share(n_);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const std::array<float, 4> w = corner_weights(b_.uv[i]);
      float smooth = 0;
      for (std::size_t c = 0; c < 4; ++c) smooth += w[c] * corner[c].x;
      const auto own = static_cast<double>(f_.lengths[b_.strands[i]]);
      share[i] = own / std::max(static_cast<double>(smooth), 0.1 * own);
      sum += share[i], squares += share[i] * share[i];
    }
    const double mean = sum / static_cast<double>(n_);
    const double deviation = std::sqrt(std::max(0., squares / static_cast<double>(n_) - mean * mean));
    const double longest = std::min(mean + std::sqrt(3.) * deviation, 2 * mean);
    b_.length_spread = 2 * (1 - mean / longest);
    b_.tip.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) b_.tip[i] = static_cast<float>(std::clamp(share[i] / longest, 0.05, 2.));
  }

  /// A strand's points at even w, as vertices. One that ends before goes on as the base strand beside it does.
  void project(std::size_t i, bool has_base) {
    constexpr std::size_t n = FitStrands::kPoints;
    std::array<Vec3, n> points;
    const std::uint32_t s = b_.strands[i];
    const float tip = b_.tip[i];
    if (has_base) base_vertices(b_, b_.uv[i], base_);
    const Vec3 end = f_.at(s, 1), onward = (end - f_.at(s, 0.8f)) / (0.2f * tip);
    const Vec3 base_end = has_base ? spline_.at(base_.data(), tip) : Vec3();
    for (std::size_t k = 0; k < n; ++k) {
      const float w = static_cast<float>(k) / static_cast<float>(n - 1);
      points[k] = w <= tip   ? f_.at(s, w / tip)
                  : has_base ? end + (spline_.at(base_.data(), w) - base_end)
                             : end + onward * (w - tip);
    }
    spline_.project(points.data(), &slow_[i * layers_]);
  }

  void solve() {
    const PatchSolver solver(b_.uv);
    for (auto& column : b_.columns) column.resize(layers_);
    for (std::size_t k = 0; k < layers_; ++k) {
      const std::array<Vec3, 4> corner = solver.solve([&](std::size_t i) { return slow_[i * layers_ + k]; }, offset_);
      for (std::size_t c = 0; c < 4; ++c) b_.columns[c][k] = corner[c];
    }
  }

  /// Every strand goes to the place where the cage is nearest to all of its layers (Gauss–Newton); then places spread
  /// evenly again, as those of new strands do.
  void move_places() {
    for (std::size_t i = 0; i < n_; ++i) b_.uv[i] = nearest_place(i);
    for (const auto axis : {&Vec2::x, &Vec2::y}) {
      double sum = 0, squares = 0;
      for (const Vec2 p : b_.uv) sum += static_cast<double>(p.*axis), squares += static_cast<double>((p.*axis) * (p.*axis));
      const double mean = sum / static_cast<double>(n_);
      const double deviation = std::sqrt(std::max(0., squares / static_cast<double>(n_) - mean * mean));
      if (!(deviation > 0.02)) continue;
      const double scale = 1 / (std::sqrt(12.) * deviation);
      for (Vec2& p : b_.uv)
        p.*axis = static_cast<float>(std::clamp(0.5 + (static_cast<double>(p.*axis) - mean) * scale, 0., 1.));
    }
  }

  Vec2 nearest_place(std::size_t i) const {
    Vec2 p = b_.uv[i];
    for (int step = 0; step < 3; ++step) {
      double uu = 0, vv = 0, uv = 0, gu = 0, gv = 0;
      for (std::size_t k = 0; k < layers_; ++k) {
        const Vec3 p00 = b_.columns[0][k], p10 = b_.columns[1][k], p11 = b_.columns[2][k], p01 = b_.columns[3][k];
        const Vec3 low = lerp(p00, p10, p.x), high = lerp(p01, p11, p.x);
        const Vec3 du = lerp(p10 - p00, p11 - p01, p.y), dv = high - low, r = slow_[i * layers_ + k] - lerp(low, high, p.y);
        uu += static_cast<double>(dot(du, du)), vv += static_cast<double>(dot(dv, dv)), uv += static_cast<double>(dot(du, dv));
        gu += static_cast<double>(dot(du, r)), gv += static_cast<double>(dot(dv, r));
      }
      const double damping = 1e-3 * (uu + vv);
      uu += damping, vv += damping;
      const double determinant = uu * vv - uv * uv;
      if (!(determinant > 0)) break;
      p = clamped({p.x + static_cast<float>((vv * gu - uv * gv) / determinant),
                   p.y + static_cast<float>((uu * gv - uv * gu) / determinant)});
    }
    return p;
  }

  void sum_error() {
    b_.error = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      base_vertices(b_, b_.uv[i], base_);
      for (std::size_t k = 0; k < layers_; ++k) {
        const Vec3 d = slow_[i * layers_ + k] - base_[k];
        b_.error += static_cast<double>(dot(d, d));
      }
    }
  }

  const FitStrands& f_;
  const LayerSpline& spline_;
  FitBundle& b_;
  std::size_t n_, layers_;
  RootFrame frame_;
  std::array<Vec3, 4> offset_;
  std::vector<Vec3> slow_;  // [strands][layers] each strand by itself as vertices
  std::vector<Vec3> base_;
};

}  // namespace

std::array<float, 4> corner_weights(Vec2 p) { return {(1 - p.x) * (1 - p.y), p.x * (1 - p.y), p.x * p.y, (1 - p.x) * p.y}; }

void base_vertices(const FitBundle& b, Vec2 uv, std::vector<Vec3>& vertices) {
  const std::array<float, 4> w = corner_weights(uv);
  vertices.resize(b.columns[0].size());
  for (std::size_t k = 0; k < vertices.size(); ++k)
    vertices[k] = b.columns[0][k] * w[0] + b.columns[1][k] * w[1] + b.columns[2][k] * w[2] + b.columns[3][k] * w[3];
}

void fit_bundle(const FitStrands& strands, const LayerSpline& spline, FitBundle& bundle) {
  Fitter(strands, spline, bundle).fit();
}

}  // namespace pelage
