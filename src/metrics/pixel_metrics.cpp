// Metrics that look at one pixel at a time.
#include <cmath>

#include "metrics/builtin.h"
#include "metrics/field.h"

namespace pelage::metrics {
namespace {

// Mean over R, G, B of term(test, reference), for every pixel.
template <class Term>
Image color_field(const MetricInput& in, const Term& term) {
  Image field = make_field(in.test.width, in.test.height);
  for_each_row(field.height, [&](int y) {
    for (int x = 0; x < field.width; ++x) {
      const float *t = in.test.at(x, y), *r = in.reference.at(x, y);
      *field.at(x, y) = (term(t[0], r[0]) + term(t[1], r[1]) + term(t[2], r[2])) / 3;
    }
  });
  return field;
}

Image squared_error(const MetricInput& in) {
  return color_field(in, [](float t, float r) { return (t - r) * (t - r); });
}

// The reference's own energy divides the error; the constant keeps black pixels finite (references.bib: Rousselle2011Greedy).
constexpr float kRelativeFloor = 0.01f;

Image relative_squared_error(const MetricInput& in) {
  return color_field(in, [](float t, float r) { return (t - r) * (t - r) / (r * r + kRelativeFloor); });
}

MetricResult psnr(const MetricInput& in) {
  MetricResult result{squared_error(in)};
  result.value = [field = result.map](const PixelSet& set) -> std::optional<double> {
    const std::optional<double> mse = mean_over(set, field);
    if (!mse || *mse == 0) return std::nullopt;
    return -10 * std::log10(*mse);
  };
  return result;
}

std::string no_coverage(const MetricInput& in) {
  if (!in.test_coverage.empty() && !in.reference_coverage.empty()) return "";
  return "both pictures need a channel `coverage` or `A`";
}

// Signed: above 0 where the test covers more than the reference.
template <class Term>
Image coverage_field(const MetricInput& in, const Term& term) {
  Image field = make_field(in.test.width, in.test.height);
  for (std::size_t p = 0; p < field.pixels.size(); ++p) field.pixels[p] = term(in.test_coverage[p] - in.reference_coverage[p]);
  return field;
}

/// Mean of the test over mean of the reference.
MetricResult energy(const MetricInput& in) {
  const auto mean = [](const Image& image, const PixelSet& set) {
    return mean_over(set, {0, 0, image.width, image.height}, [&](int x, int y) {
      const float* c = image.at(x, y);
      return c[0] + c[1] + c[2];
    });
  };
  MetricResult result;
  result.value = [&test = in.test, &reference = in.reference, mean](const PixelSet& set) -> std::optional<double> {
    const std::optional<double> t = mean(test, set), r = mean(reference, set);
    if (!t || !r || !(*r > 0)) return std::nullopt;
    return *t / *r;
  };
  return result;
}

}  // namespace

Metric mse_metric() {
  return {.key = "mse", .description = "mean squared error", .evaluate = [](const MetricInput& in) {
            return MetricResult{squared_error(in)};
          }};
}

Metric relative_mse_metric() {
  return {.key = "relative_mse",
          .description = "mean of squared error / (reference² + 0.01), scene-linear",
          .domain = Encoding::kLinear,
          .evaluate = [](const MetricInput& in) { return MetricResult{relative_squared_error(in)}; }};
}

Metric psnr_metric() {
  return {.key = "psnr",
          .description = "10 log10(1 / mse), decibels",
          .higher_is_better = true,
          .has_map = false,
          .no_value = "infinite: the pixels are equal",
          .evaluate = psnr};
}

Metric coverage_metric() {
  return {
      .key = "coverage_error",
      .description = "mean |difference of coverage|, or of alpha",
      .map_scale = 1,
      .unavailable = no_coverage,
      .evaluate = [](const MetricInput& in) { return MetricResult{coverage_field(in, [](float d) { return std::fabs(d); })}; }};
}

Metric coverage_bias_metric() {
  return {.key = "coverage_bias",
          .description = "mean difference of coverage: above 0 the test covers more",
          .has_map = false,
          .unavailable = no_coverage,
          .evaluate = [](const MetricInput& in) { return MetricResult{coverage_field(in, [](float d) { return d; })}; }};
}

Metric energy_metric() {
  return {.key = "energy",
          .description = "mean of the test over mean of the reference, scene-linear; 1: the same light",
          .domain = Encoding::kLinear,
          .has_map = false,
          .no_value = "the reference is black",
          .evaluate = energy};
}

}  // namespace pelage::metrics
