// What a rough dielectric cylinder does, by chance: paths traced through it one by one, every hit with a surface normal of
// its own. Shares nothing with kernel/scatter; slow and obvious.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "oracle/fiber_oracle.h"

namespace pelage::oracle {

/// A cylinder of radius 1 along x, toward the tip. Slopes of its surface are normal, of deviation `roughness` in every
/// direction; scales tilt the outward normal by `tilt` radians toward the root, so that R is sent there.
struct RoughFiber {
  double eta = 1.55, sigma_a = 0, roughness = 0.1, tilt = 0;
};

/// What left after p stretches inside: 0 R, 1 TT, 2 TRT, 3 all later orders together.
struct RoughOrder {
  static constexpr std::size_t kBins = 180;
  double energy = 0;                                        ///< share of the light
  double sum = 0, sum2 = 0;                                 ///< of θ_i + θ_o and its square, weighted with energy
  std::vector<double> around = std::vector<double>(kBins);  ///< energy by |φ|, 0…π
  double shift() const { return sum / energy; }
  double deviation() const { return std::sqrt(sum2 / energy - shift() * shift()); }
};

class RoughTracer {
 public:
  RoughTracer(const RoughFiber& fiber, double theta, unsigned seed) : fiber_(fiber), theta_(theta), random_(seed) {}

  std::array<RoughOrder, 4> run(int paths) {
    std::array<RoughOrder, 4> orders;
    for (int i = 0; i < paths; ++i) trace(1. / paths, orders);
    return orders;
  }

 private:
  static constexpr int kAttempts = 64;

  double uniform() { return std::uniform_real_distribution<>()(random_); }
  double slope() { return fiber_.roughness * std::normal_distribution<>()(random_); }

  // A normal of the surface at p that `d` can see, as often as it sees it; on the side that d comes from.
  V3 visible_normal(V3 p, V3 d, double side) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const double along = slope() - std::tan(fiber_.tilt), around = slope();
      const V3 n{along, p.y - around * p.z, p.z + around * p.y};  // (0, p.y, p.z) is outward, (0, -p.z, p.y) around
      const double size = std::sqrt(dot(n, n)), seen = -dot(d, n) * side;
      if (seen > 0 && uniform() * size < seen) return n * (side / size);
    }
    return V3{0, p.y, p.z} * side;  // a tilted scale that hides itself: the cylinder's own normal
  }

  // Where d goes after it meets the surface at p; `outside` says on which side it is, and changes with it. Directions that
  // would leave through the far side of the true surface are drawn anew.
  V3 meet(V3 p, V3 d, bool& outside) {
    const V3 outward{0, p.y, p.z};
    for (int attempt = 0;; ++attempt) {
      const V3 n = attempt < kAttempts ? visible_normal(p, d, outside ? 1 : -1) : outward * (outside ? 1 : -1);
      const double eta = outside ? fiber_.eta : 1 / fiber_.eta;
      const bool reflected = uniform() < reflectance(-dot(d, n), eta);
      const V3 next = reflected ? d + n * (-2 * dot(d, n)) : refract(d, n, eta);
      const bool goes_out = dot(next, outward) > 0;
      if (goes_out != (outside == reflected)) continue;
      outside = goes_out;
      return next;
    }
  }

  void trace(double share, std::array<RoughOrder, 4>& orders) {
    const double h = 2 * uniform() - 1;
    V3 d{-std::sin(theta_), -std::cos(theta_), 0};
    V3 p{0, std::sqrt(1 - h * h), h};
    bool outside = true;
    double energy = share;
    for (int order = 0; order < 200; ++order) {
      d = meet(p, d, outside);
      if (outside) return record(orders[static_cast<std::size_t>(std::min(order, 3))], d, energy);
      const double length = -2 * (p.y * d.y + p.z * d.z) / (d.y * d.y + d.z * d.z);
      p = p + d * length;
      p.x = 0;
      const double r = std::hypot(p.y, p.z);
      p.y /= r, p.z /= r;
      energy *= std::exp(-fiber_.sigma_a * length);
    }
  }

  void record(RoughOrder& order, V3 d, double energy) const {
    const double angle = std::asin(std::fmin(1, std::fmax(-1, d.x))) + theta_;
    const double phi = std::fabs(std::atan2(d.z, d.y));
    order.energy += energy, order.sum += energy * angle, order.sum2 += energy * angle * angle;
    order.around[std::min(static_cast<std::size_t>(phi / std::numbers::pi * RoughOrder::kBins), RoughOrder::kBins - 1)] +=
        energy;
  }

  RoughFiber fiber_;
  double theta_;
  std::mt19937_64 random_;
};

}  // namespace pelage::oracle
