// Frames over time. Two numbers, both of display-encoded colors:
//
// Adjacent-frame PSNR: how alike each frame is to the next, the smoothness of a level-of-detail transition in Huang 2025
// (references.bib: Huang2025LevelOfDetail, figure 9). It needs no reference, and motion lowers it too: read it beside the
// reference's own.
// Flicker: mean |(t[i+1] − t[i]) − (r[i+1] − r[i])|, the change from frame to frame that the reference does not have. It is the
// temporal loss of Chaitanya 2017 (references.bib: Chaitanya2017Interactive): an error that stands still costs nothing.
#include <pelage/error.h>

#include <algorithm>
#include <cmath>

#include "metrics/field.h"
#include "metrics/pair.h"

namespace pelage {
namespace {

using metrics::mean_over;

// The colors of one frame of both sequences as a display shows them, and the pixels that count.
struct Frame {
  Image test, reference;
  PixelMask mask;

  PixelSet set() const { return {test.width, {0, 0, test.width, test.height}, mask}; }
};

template <class Term>
std::optional<double> color_mean(const PixelSet& set, const Term& term) {
  return mean_over(set, set.rect, [&](int x, int y) { return (term(x, y, 0) + term(x, y, 1) + term(x, y, 2)) / 3; });
}

std::optional<double> psnr_between(const Image& a, const Image& b, const PixelSet& set) {
  const auto mse = color_mean(set, [&](int x, int y, int c) {
    const float d = b.at(x, y)[c] - a.at(x, y)[c];
    return d * d;
  });
  return mse && *mse > 0 ? std::optional(-10 * std::log10(*mse)) : std::nullopt;
}

// The pixels that count in either of two frames: hair that leaves a pixel is a change of that pixel.
PixelMask united(const PixelMask& a, const PixelMask& b) {
  PixelMask out(a.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] | b[i];
  return out;
}

double flicker_between(const Frame& now, const Frame& next, const PixelSet& set) {
  return color_mean(set,
                    [&](int x, int y, int c) {
                      return std::fabs((next.test.at(x, y)[c] - now.test.at(x, y)[c]) -
                                       (next.reference.at(x, y)[c] - now.reference.at(x, y)[c]));
                    })
      .value_or(0);
}

void add_step(const Frame& now, const Frame& next, SequenceComparison& result) {
  if (now.test.width != next.test.width || now.test.height != next.test.height)
    throw Error("sequence", "", "its frames differ in size", "");
  const PixelMask both = united(now.mask, next.mask);
  PixelSet set = next.set();
  set.mask = both;
  result.adjacent_psnr.push_back(psnr_between(now.test, next.test, set));
  result.reference_adjacent_psnr.push_back(psnr_between(now.reference, next.reference, set));
  result.flicker.push_back(flicker_between(now, next, set));
}

// Mean and least of the finite ones.
void add_psnr(const std::string& key, const std::vector<std::optional<double>>& steps, std::vector<MetricValue>& values) {
  double sum = 0, least = INFINITY;
  int count = 0;
  for (const auto& step : steps)
    if (step) sum += *step, least = std::min(least, *step), ++count;
  const std::string note = count ? "" : "infinite: the frames are equal";
  values.push_back({key, count ? std::optional(sum / count) : std::nullopt, note});
  values.push_back({key + "_min", count ? std::optional(least) : std::nullopt, note});
}

std::vector<MetricValue> mean_values(const std::vector<Comparison>& frames) {
  std::vector<MetricValue> means;
  for (const MetricValue& first : frames.front().values) {
    double sum = 0;
    int count = 0;
    for (const Comparison& frame : frames)
      if (const auto value = frame.value(first.key)) sum += *value, ++count;
    means.push_back({first.key, count ? std::optional(sum / count) : std::nullopt, count ? "" : first.note});
  }
  return means;
}

}  // namespace

SequenceComparison compare_sequences(int frames, const std::function<Picture(int)>& read_test,
                                     const std::function<Picture(int)>& read_reference, bool hair,
                                     const CompareOptions& options) {
  if (frames < 1) throw Error("sequence", "", "no frames", "");
  if (!options.maps.empty()) throw Error("sequence", "", "maps are of single pictures", "");
  SequenceComparison result;
  Frame now;
  for (int i = 0; i < frames; ++i) {
    if (options.progress && !options.progress("compare", static_cast<double>(i) / frames))
      throw Error("compare", "", "cancelled", "");
    const Picture test = read_test(i), reference = read_reference(i);
    CompareOptions frame_options = options;
    frame_options.progress = {};
    if (hair) frame_options.mask = hair_mask(reference);
    result.frames.push_back(compare_images(test, reference, frame_options));
    metrics::Pair pair(test, reference, frame_options);
    const MetricInput shown = pair.input(Encoding::kDisplay);
    Frame next{shown.test, shown.reference, std::move(frame_options.mask)};
    if (i > 0) add_step(now, next, result);
    now = std::move(next);
  }
  result.mean = mean_values(result.frames);
  if (frames == 1) return result;
  add_psnr("adjacent_psnr", result.adjacent_psnr, result.temporal);
  add_psnr("reference_adjacent_psnr", result.reference_adjacent_psnr, result.temporal);
  double flicker = 0;
  for (const double f : result.flicker) flicker += f;
  result.temporal.push_back({"flicker", flicker / static_cast<double>(result.flicker.size())});
  return result;
}

}  // namespace pelage
