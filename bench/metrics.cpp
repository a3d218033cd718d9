// metrics: pixels per second of comparing two pictures of 1920 × 1080. The slow FLIP is timed on some pixels.
#include <pelage/metrics.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "bench.h"
#include "metrics/naive_flip.h"
#include "metrics/naive_ssim.h"
#include "metrics/pair.h"
#include "metrics/test_pictures.h"

namespace pelage::bench {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;
constexpr double kPixels = double{kWidth} * kHeight;
constexpr int kSlowPixels = 200;
constexpr double kTolerance = 1e-5;

struct Input {
  Picture reference = metrics::drawn(kWidth, kHeight), test = metrics::noisy(reference, 0.2f);

  Comparison compare(const std::string& metric) const {
    CompareOptions options;
    options.metrics = {metric};
    if (metric == "flip") options.maps = {metric};
    return compare_images(test, reference, options);
  }
};

/// Made once and kept while someone uses it: both sides of a ratio do.
std::shared_ptr<const Input> input() {
  static std::weak_ptr<const Input> made;
  std::shared_ptr<const Input> in = made.lock();
  if (!in) made = in = std::make_shared<const Input>();
  return in;
}

/// Calls body(x, y) for pixels all over the picture, corners included.
template <class Body>
void for_some_pixels(const Body& body) {
  for (int i = 0; i < kSlowPixels; ++i) {
    const double share = static_cast<double>(i) / (kSlowPixels - 1);
    body(static_cast<int>(std::fmod(share * 13 * (kWidth - 1), kWidth)), static_cast<int>(share * (kHeight - 1)));
  }
}

std::string check_flip(const Input& in) {
  const Image error = in.compare("flip").maps.at(0).error;
  const Image test = metrics::decode_display(in.test.image), reference = metrics::decode_display(in.reference.image);
  const metrics::NaiveFlip naive(test, reference, static_cast<double>(CompareOptions{}.pixels_per_degree));
  double worst = 0;
  for_some_pixels(
      [&](int x, int y) { worst = std::max(worst, std::abs(naive.at(x, y) - static_cast<double>(*error.at(x, y)))); });
  return worst <= kTolerance ? "" : fmt::format("a pixel differs by {:.2g} from the slow definition", worst);
}

Workload flip() {
  return {
      .check = [in = input()] { return check_flip(*in); }, .run = [in = input()] { in->compare("flip"); }, .items = kPixels};
}

Workload slow_flip() {
  struct Job {
    Image test, reference;
    double sum = 0;  // kept, so that the compiler keeps the work
  };
  const auto in = input();
  const auto job =
      std::make_shared<Job>(Job{metrics::decode_display(in->test.image), metrics::decode_display(in->reference.image)});
  return {.check = [in] { return check_flip(*in); },
          .run =
              [job] {
                const metrics::NaiveFlip naive(job->test, job->reference,
                                               static_cast<double>(CompareOptions{}.pixels_per_degree));
                for_some_pixels([&](int x, int y) { job->sum += naive.at(x, y); });
              },
          .items = kSlowPixels};
}

std::string check_ssim(const Input& in) {
  CompareOptions options;
  options.metrics = options.maps = {"ssim"};
  const Image error = compare_images(in.test, in.reference, options).maps.at(0).error;
  double worst = 0;
  for_some_pixels([&](int x, int y) {
    if (x < 5 || y < 5 || x >= kWidth - 5 || y >= kHeight - 5) return;
    double expected = 0;
    for (std::size_t c = 0; c < 3; ++c)
      expected += metrics::naive_ssim(in.test.image, in.reference.image, x, y, c).similarity / 3;
    worst = std::max(worst, std::abs(1 - expected - static_cast<double>(*error.at(x, y))));
  });
  return worst <= kTolerance ? "" : fmt::format("a pixel differs by {:.2g} from the slow definition", worst);
}

Workload ssim() {
  return {
      .check = [in = input()] { return check_ssim(*in); }, .run = [in = input()] { in->compare("ssim"); }, .items = kPixels};
}

}  // namespace

void add_metrics_cases(Suite& suite) {
  suite.cases.push_back({"metrics.flip.1080p", "pixels_per_second", "1/s", flip});
  suite.cases.push_back({"metrics.slow_flip.1080p", "pixels_per_second", "1/s", slow_flip});
  suite.cases.push_back({"metrics.ssim.1080p", "pixels_per_second", "1/s", ssim});
  suite.ratios.push_back({"metrics.speedup.flip", {"metrics.flip.1080p", 1}, {"metrics.slow_flip.1080p", 1}});
  suite.ratios.push_back({"metrics.scaling.flip", {"metrics.flip.1080p", 2}, {"metrics.flip.1080p", 1}});
}

}  // namespace pelage::bench
