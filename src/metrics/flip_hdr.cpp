#include "metrics/flip_hdr.h"

#include <pelage/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/field.h"
#include "metrics/flip.h"

namespace pelage::metrics {
namespace {

// ACES as HDR-FLIP has it: Narkowicz' rational fit (references.bib: Narkowicz2015Aces), (x (a x + b)) / (x (c x + d) + e), whose
// input is first multiplied by 0.6 to take back the fit's own exposure.
constexpr double kPreExposure = 0.6;
constexpr double kA = 2.51 * kPreExposure * kPreExposure, kB = 0.03 * kPreExposure, kC = 2.43 * kPreExposure * kPreExposure,
                 kD = 0.59 * kPreExposure, kE = 0.14;

float aces_fit(float x) {
  const float a = static_cast<float>(kA), b = static_cast<float>(kB), c = static_cast<float>(kC), d = static_cast<float>(kD),
              e = static_cast<float>(kE);
  return std::clamp(x * (a * x + b) / (x * (c * x + d) + e), 0.f, 1.f);
}

// The luminance that the curve takes to 0.85: the larger root of (a − t c) x² + (b − t d) x − t e = 0.
double bright_enough() {
  constexpr double t = 0.85;
  const double a = kA - t * kC, b = kB - t * kD, c = -t * kE;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

Image exposed(const Image& linear, double stops) {
  Image out(linear.width, linear.height, linear.channels);
  const auto factor = static_cast<float>(std::exp2(stops));
  parallel_for(out.pixels.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
    // Above 1e6 the curve is flat to float precision; the limits keep x² finite and negative values dark.
    for (std::size_t i = first; i < last; ++i) out.pixels[i] = aces_fit(std::clamp(linear.pixels[i] * factor, 0.f, 1e6f));
  });
  return out;
}

Exposures chosen_exposures(const MetricInput& in) {
  const CompareOptions& o = in.options;
  Exposures e = o.start_exposure && o.stop_exposure ? Exposures{} : find_exposures(in.reference);
  if (o.start_exposure) e.start = static_cast<double>(*o.start_exposure);
  if (o.stop_exposure) e.stop = static_cast<double>(*o.stop_exposure);
  if (e.stop < e.start) throw Error("exposures", "", "the last is below the first", "");
  e.count = o.exposures > 0 ? std::max(2, o.exposures) : std::max(2, static_cast<int>(std::ceil(e.stop - e.start)));
  return e;
}

}  // namespace

Exposures find_exposures(const Image& reference) {
  std::vector<float> luminance(reference.pixels.size() / 3);
  for (std::size_t p = 0; p < luminance.size(); ++p) {
    const float* c = reference.pixels.data() + 3 * p;
    luminance[p] = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
  }
  const auto brightest = static_cast<double>(*std::max_element(luminance.begin(), luminance.end()));
  const auto middle = luminance.begin() + static_cast<std::ptrdiff_t>(luminance.size() / 2);
  std::nth_element(luminance.begin(), middle, luminance.end());
  constexpr double kLeast = std::numeric_limits<float>::epsilon();
  const double enough = bright_enough();
  return {std::log2(enough / std::max(brightest, kLeast)), std::log2(enough / std::max(static_cast<double>(*middle), kLeast)),
          2};
}

MetricResult flip_hdr(const MetricInput& in) {
  const Exposures exposures = chosen_exposures(in);
  MetricResult result{make_field(in.test.width, in.test.height)};
  for (int i = 0; i < exposures.count; ++i)
    raise_to_flip(flip_opponent(exposed(in.test, exposures.at(i))), flip_opponent(exposed(in.reference, exposures.at(i))),
                  in.options.pixels_per_degree, result.map);
  result.details = {{"flip_start_exposure", exposures.start},
                    {"flip_stop_exposure", exposures.stop},
                    {"flip_exposures", static_cast<double>(exposures.count)}};
  return result;
}

}  // namespace pelage::metrics
