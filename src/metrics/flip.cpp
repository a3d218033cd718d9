#include "metrics/flip.h"

#include <algorithm>

#include "metrics/builtin.h"
#include "metrics/field.h"
#include "metrics/flip_hdr.h"
#include "metrics/pair.h"
#include "metrics/tile.h"

namespace pelage::metrics {
namespace {

using Taps = std::vector<float>;

// taps(x) for x in −radius … radius.
template <class Function>
std::vector<double> sample(int radius, const Function& function) {
  std::vector<double> values;
  for (int x = -radius; x <= radius; ++x) values.push_back(function(static_cast<double>(x)));
  return values;
}

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum;
}

Taps scaled(const std::vector<double>& values, double positive, double negative) {
  Taps taps;
  for (const double v : values) taps.push_back(static_cast<float>(v * (v > 0 ? positive : negative)));
  return taps;
}

// One Gaussian of a channel's blur: the same taps along rows and columns, times its weight in the sum.
struct Blur {
  Taps taps;
  float weight;
};

// A sum of two-dimensional Gaussians over a square, together of weight 1. Each is separable: its weight is a √(π/b) times the
// square of its taps' sum.
std::vector<Blur> make_blur(const Sensitivity& s, double pixels_per_degree) {
  const int radius = blur_radius(pixels_per_degree);
  std::vector<Blur> blurs;
  std::vector<double> weights;
  for (const auto& [a, b] : {std::pair{s.a1, s.b1}, std::pair{s.a2, s.b2}}) {
    if (a == 0) continue;
    const std::vector<double> gaussian = sample(radius, [&, b = b](double x) {
      const double degrees = x / pixels_per_degree;
      return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / b);
    });
    const double sum = sum_of(gaussian);
    weights.push_back(a * std::sqrt(std::numbers::pi / b) * sum * sum);
    blurs.push_back({scaled(gaussian, 1 / sum, 1 / sum), 0});
  }
  for (std::size_t i = 0; i < blurs.size(); ++i) blurs[i].weight = static_cast<float>(weights[i] / sum_of(weights));
  return blurs;
}

// A Gaussian and its derivatives along one axis. The derivatives' positive taps add up to 1, their negative ones to −1, so that
// a unit step is an edge of 1 (Andersson 2020, section 4.2).
struct Detectors {
  Taps gaussian, edge, point;
};

Detectors make_detectors(double pixels_per_degree) {
  const double sigma = feature_sigma(pixels_per_degree);
  const int radius = feature_radius(pixels_per_degree);
  const auto gaussian = [sigma](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
  const auto normalized = [](const std::vector<double>& values) {
    double positive = 0, negative = 0;
    for (const double v : values) (v > 0 ? positive : negative) += v;
    return scaled(values, 1 / positive, -1 / negative);
  };
  const std::vector<double> smooth = sample(radius, gaussian);
  return {scaled(smooth, 1 / sum_of(smooth), 0), normalized(sample(radius, [&](double x) { return -x * gaussian(x); })),
          normalized(sample(radius, [&](double x) { return (x * x / (sigma * sigma) - 1) * gaussian(x); }))};
}

struct FlipFilters {
  std::array<std::vector<Blur>, 3> blurs;
  Detectors detectors;
  int radius_blur, radius_feature;

  explicit FlipFilters(double pixels_per_degree)
      : detectors(make_detectors(pixels_per_degree)), radius_blur(blur_radius(pixels_per_degree)),
        radius_feature(feature_radius(pixels_per_degree)) {
    for (std::size_t c = 0; c < 3; ++c) blurs[c] = make_blur(kSensitivities[c], pixels_per_degree);
  }
};

// What a tile of one picture looks like: its colors and its features.
struct Seen {
  std::array<Block, 3> opponent;  // blurred YCxCz
  Block edges, points;            // magnitudes
};

Block blurred(const Block& in, const std::vector<Blur>& blurs) {
  Block sum;
  for (const Blur& blur : blurs) {
    Block part = convolve(in, blur.taps, blur.taps);
    if (sum.values.empty()) {
      sum = std::move(part);
      if (blurs.size() == 1) return sum;
      for (float& v : sum.values) v *= blur.weight;
    } else {
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += blur.weight * part.values[i];
    }
  }
  return sum;
}

// Length of the pair of filters along x and y.
Block magnitude(const Block& along_x, const Block& along_y) {
  Block out(along_x.width, along_x.height);
  for (std::size_t i = 0; i < out.values.size(); ++i)
    out.values[i] = std::sqrt(along_x.values[i] * along_x.values[i] + along_y.values[i] * along_y.values[i]);
  return out;
}

Seen look(const Image& opponent, const Tile& tile, const FlipFilters& filters) {
  Seen seen;
  for (std::size_t c = 0; c < 3; ++c)
    seen.opponent[c] = blurred(gather(opponent, c, tile, filters.radius_blur), filters.blurs[c]);
  Block luminance = gather(opponent, 0, tile, filters.radius_feature);
  for (float& v : luminance.values) v = opponent_luminance(v);
  const Detectors& d = filters.detectors;
  const Block smooth = convolve_rows(luminance, d.gaussian);
  seen.edges = magnitude(convolve(luminance, d.edge, d.gaussian), convolve_columns(smooth, d.edge));
  seen.points = magnitude(convolve(luminance, d.point, d.gaussian), convolve_columns(smooth, d.point));
  return seen;
}

float clamped(float x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

[[gnu::always_inline]] inline HuntLab<float> lab_of(float y, float cx, float cz) {
  const Color<float> rgb = transform(kXyzToRgb, opponent_to_xyz(Color<float>{y, cx, cz}));
  return hunt_lab(transform(kRgbToXyz, Color<float>{clamped(rgb[0]), clamped(rgb[1]), clamped(rgb[2])}));
}

// Arithmetic and square roots alone, here and in the next: the compiler makes vector code of these loops.
Block color_errors(const Seen& test, const Seen& reference, float largest) {
  static_assert(kColorExponent == 0.7);
  Block out(test.edges.width, test.edges.height);
  const float *t0 = test.opponent[0].row(0), *t1 = test.opponent[1].row(0), *t2 = test.opponent[2].row(0);
  const float *r0 = reference.opponent[0].row(0), *r1 = reference.opponent[1].row(0), *r2 = reference.opponent[2].row(0);
  float* e = out.row(0);
  for (std::size_t i = 0; i < out.values.size(); ++i)
    e[i] = spread_color_error(power_7_10(hyab(lab_of(t0[i], t1[i], t2[i]), lab_of(r0[i], r1[i], r2[i]))), largest);
  return out;
}

Block feature_errors(const Seen& test, const Seen& reference) {
  static_assert(kFeatureExponent == 0.5);
  Block out(test.edges.width, test.edges.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const float edges = std::abs(test.edges.values[i] - reference.edges.values[i]);
    const float points = std::abs(test.points.values[i] - reference.points.values[i]);
    out.values[i] = std::sqrt((edges > points ? edges : points) / std::numbers::sqrt2_v<float>);
  }
  return out;
}

MetricResult flip(const MetricInput& in) {
  if (in.domain == Encoding::kLinear) return flip_hdr(in);
  MetricResult result{make_field(in.test.width, in.test.height)};
  raise_to_flip(flip_opponent(decode_display(in.test)), flip_opponent(decode_display(in.reference)),
                in.options.pixels_per_degree, result.map);
  return result;
}

}  // namespace

Image flip_opponent(const Image& linear) {
  Image out(linear.width, linear.height, {"Y", "Cx", "Cz"});
  for_each_row(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const float* rgb = linear.at(x, y);
      const Color<float> opponent = xyz_to_opponent(transform(kRgbToXyz, Color<float>{rgb[0], rgb[1], rgb[2]}));
      std::copy(opponent.begin(), opponent.end(), out.at(x, y));
    }
  });
  return out;
}

void raise_to_flip(const Image& test, const Image& reference, float pixels_per_degree, Image& error) {
  const FlipFilters filters(static_cast<double>(pixels_per_degree));
  const auto largest = static_cast<float>(largest_color_error());
  for_each_tile(error.width, error.height, [&](const Tile& tile) {
    const Seen t = look(test, tile, filters), r = look(reference, tile, filters);
    const Block colors = color_errors(t, r, largest), features = feature_errors(t, r);
    for (int y = 0; y < tile.height; ++y) {
      float* e = error.at(tile.x, tile.y + y);
      for (int x = 0; x < tile.width; ++x) e[x] = std::max(e[x], std::pow(colors.row(y)[x], 1 - features.row(y)[x]));
    }
  });
}

Metric flip_metric() {
  return {.key = "flip",
          .description = "FLIP, what a person sees when the pictures alternate; HDR-FLIP of scene-linear pictures",
          .map_scale = 1,
          .evaluate = flip};
}

}  // namespace pelage::metrics
