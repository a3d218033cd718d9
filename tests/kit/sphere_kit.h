// Statistics of directions on the sphere: midpoint integrals and the chi-square test of a sampler against its density.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace pelage::kit {

/// Integral of value(theta, phi) cos(theta) over the sphere, theta from the equator.
template <class Value>
double sphere_integral(const Value& value, int thetas, int phis) {
  double sum = 0;
  for (int i = 0; i < thetas; ++i) {
    const double theta = std::numbers::pi * ((i + 0.5) / thetas - 0.5);
    double ring = 0;
    for (int j = 0; j < phis; ++j) ring += value(theta, 2 * std::numbers::pi * ((j + 0.5) / phis - 0.5));
    sum += ring * std::cos(theta);
  }
  return sum * std::numbers::pi / thetas * 2 * std::numbers::pi / phis;
}

/// Upper tail of the chi-square distribution: probability of a larger statistic by chance (Wilson and Hilferty's cube
/// root is normal; good to a few percent of the probability for 10 and more degrees of freedom).
inline double chi_square_tail(double statistic, double freedom) {
  const double k = 2 / (9 * freedom), z = (std::cbrt(statistic / freedom) - (1 - k)) / std::sqrt(k);
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

/// Directions counted in cells of equal steps in theta and phi, against what a density promises.
class SphereHistogram {
 public:
  SphereHistogram(int thetas, int phis) : thetas_(thetas), phis_(phis), counts_(static_cast<std::size_t>(thetas * phis)) {}

  void add(double theta, double phi) {
    const double turn = phi / (2 * std::numbers::pi) + 0.5;
    const int i = std::clamp(static_cast<int>((theta / std::numbers::pi + 0.5) * thetas_), 0, thetas_ - 1);
    const int j = std::clamp(static_cast<int>((turn - std::floor(turn)) * phis_), 0, phis_ - 1);
    ++counts_[static_cast<std::size_t>(i * phis_ + j)];
    ++total_;
  }

  /// Probability that a sampler of density pdf(theta, phi) per solid angle strays further than the counts do. Cells are
  /// integrated with `steps`² midpoints; those that expect fewer than five are pooled.
  template <class Pdf>
  double p_value(const Pdf& pdf, int steps) const {
    double statistic = 0, pooled_expected = 0, pooled_count = 0;
    int cells = 0;
    const double dt = std::numbers::pi / (thetas_ * steps), dp = 2 * std::numbers::pi / (phis_ * steps);
    for (int i = 0; i < thetas_; ++i) {
      for (int j = 0; j < phis_; ++j) {
        double share = 0;
        for (int k = 0; k < steps * steps; ++k) {
          const double theta = (i * steps + k / steps + 0.5) * dt - std::numbers::pi / 2;
          share += pdf(theta, (j * steps + k % steps + 0.5) * dp - std::numbers::pi) * std::cos(theta);
        }
        const double expected = share * dt * dp * total_, count = counts_[static_cast<std::size_t>(i * phis_ + j)];
        if (expected < 5) {
          pooled_expected += expected, pooled_count += count;
        } else {
          statistic += (count - expected) * (count - expected) / expected, ++cells;
        }
      }
    }
    if (pooled_expected >= 5) {
      statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected, ++cells;
    } else if (pooled_count > 30) {
      return 0;  // many where next to none are promised
    }
    return chi_square_tail(statistic, std::max(cells - 1, 1));
  }

 private:
  int thetas_, phis_;
  std::vector<int> counts_;
  int total_ = 0;
};

}  // namespace pelage::kit
