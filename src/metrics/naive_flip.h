// FLIP from its definition, one pixel at a time in double, with two-dimensional filters and nothing kept: what tests and
// benchmarks check the fast one against. Shares with it the constants of flip.h and the color spaces, nothing else.
#pragma once

#include <algorithm>

#include "metrics/flip.h"

namespace pelage::metrics {

class NaiveFlip {
 public:
  /// Both in linear Rec. 709, 0…1.
  NaiveFlip(const Image& test, const Image& reference, double pixels_per_degree)
      : test_(test), reference_(reference), ppd_(pixels_per_degree) {}

  double at(int x, int y) const {
    const double color =
        spread_color_error(std::pow(hyab(seen(test_, x, y), seen(reference_, x, y)), kColorExponent), largest_color_error());
    const double edges = std::abs(feature(test_, x, y, false) - feature(reference_, x, y, false));
    const double points = std::abs(feature(test_, x, y, true) - feature(reference_, x, y, true));
    return std::pow(color, 1 - std::pow(std::max(edges, points) / std::numbers::sqrt2, kFeatureExponent));
  }

 private:
  static Color<double> opponent(const Image& image, int x, int y) {
    const float* c = image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
    return xyz_to_opponent(transform(kRgbToXyz, Color<double>{double{c[0]}, double{c[1]}, double{c[2]}}));
  }

  HuntLab<double> seen(const Image& image, int x, int y) const {
    const int radius = blur_radius(ppd_);
    Color<double> sum{}, weights{};
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const Color<double> color = opponent(image, x + dx, y + dy);
        const double square = (dx * dx + dy * dy) / (ppd_ * ppd_), pi = std::numbers::pi;
        for (std::size_t c = 0; c < 3; ++c) {
          const Sensitivity& s = kSensitivities[c];
          const double weight = s.a1 * std::sqrt(pi / s.b1) * std::exp(-pi * pi * square / s.b1) +
                                s.a2 * std::sqrt(pi / s.b2) * std::exp(-pi * pi * square / s.b2);
          sum[c] += weight * color[c], weights[c] += weight;
        }
      }
    for (std::size_t c = 0; c < 3; ++c) sum[c] /= weights[c];
    Color<double> rgb = transform(kXyzToRgb, opponent_to_xyz(sum));
    for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
    return hunt_lab(transform(kRgbToXyz, rgb));
  }

  // Magnitude of an edge (first derivatives) or of a point (second derivatives).
  double feature(const Image& image, int x, int y, bool point) const {
    const double sigma = feature_sigma(ppd_);
    const int radius = feature_radius(ppd_);
    struct Sum {
      double positive = 0, negative = 0, positive_weight = 0, negative_weight = 0;
      void add(double weight, double value) {
        (weight > 0 ? positive : negative) += weight * value;
        (weight > 0 ? positive_weight : negative_weight) += std::abs(weight);
      }
      double value() const { return positive / positive_weight + negative / negative_weight; }
    } along_x, along_y;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const double gaussian = std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
        const double luminance = opponent_luminance(opponent(image, x + dx, y + dy)[0]);
        const auto derivative = [&](double d) { return point ? (d * d / (sigma * sigma) - 1) * gaussian : -d * gaussian; };
        along_x.add(derivative(dx), luminance);
        along_y.add(derivative(dy), luminance);
      }
    return std::hypot(along_x.value(), along_y.value());
  }

  const Image& test_;
  const Image& reference_;
  double ppd_;
};

}  // namespace pelage::metrics
