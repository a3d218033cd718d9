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

}  // namespace pelage::metrics
