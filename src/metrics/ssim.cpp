// Structural similarity, SSIM (references.bib: Wang2004Quality) and its multi-scale form, MS-SSIM (references.bib:
// Wang2003Multiscale).
//
// Around each pixel a Gaussian window (11 × 11, σ = 1.5) gives the means μ, variances σ² and covariance of both pictures:
//
//   l = (2 μt μr + C1) / (μt² + μr² + C1)      cs = (2 σtr + C2) / (σt² + σr² + C2)      SSIM = l · cs
//
// with C1 = (K1 L)², C2 = (K2 L)², K1 = 0.01, K2 = 0.03 and L = 1, the range of display-encoded values. Each of R, G, B has its
// own; their mean is the pixel's. Only windows that lie inside the picture count, as in the authors' program.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "metrics/builtin.h"
#include "metrics/field.h"
#include "metrics/tile.h"

namespace pelage::metrics {
namespace {

constexpr int kRadius = 5, kWindow = 2 * kRadius + 1;
constexpr double kSigma = 1.5;
constexpr float kC1 = 0.01f * 0.01f, kC2 = 0.03f * 0.03f;
constexpr std::array<double, 5> kScaleWeights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};  // Wang 2003, section 3.2
constexpr int kScales = static_cast<int>(kScaleWeights.size());

std::array<float, kWindow> gaussian_window() {
  std::array<double, kWindow> weights{};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double x = (i - kRadius) / kSigma;
    sum += weights[static_cast<std::size_t>(i)] = std::exp(-0.5 * x * x);
  }
  std::array<float, kWindow> taps{};
  for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = static_cast<float>(weights[i] / sum);
  return taps;
}

Block product(const Block& a, const Block& b) {
  Block out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = a.values[i] * b.values[i];
  return out;
}

enum class Term { kSimilarity, kContrastStructure };

// One channel of one tile: SSIM or cs for each of its pixels.
Block tile_ssim(const Block& t, const Block& r, Term term) {
  static const std::array<float, kWindow> taps = gaussian_window();
  const auto blur = [](const Block& in) { return convolve(in, taps, taps); };
  const Block mean_t = blur(t), mean_r = blur(r);
  const Block tt = blur(product(t, t)), rr = blur(product(r, r)), tr = blur(product(t, r));
  Block out(tt.width, tt.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const float mt = mean_t.values[i], mr = mean_r.values[i];
    const float variances = (tt.values[i] - mt * mt) + (rr.values[i] - mr * mr), covariance = tr.values[i] - mt * mr;
    const float cs = (2 * covariance + kC2) / (variances + kC2);
    const float l = (2 * mt * mr + kC1) / (mt * mt + mr * mr + kC1);
    out.values[i] = term == Term::kSimilarity ? l * cs : cs;
  }
  return out;
}

// R, G, B of SSIM or cs. Pixels nearer than kRadius to the edge have no window of their own: see inner().
Image ssim_field(const Image& test, const Image& reference, Term term) {
  Image field(test.width, test.height, {"R", "G", "B"});
  for_each_tile(field.width, field.height, [&](const Tile& tile) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Block values = tile_ssim(gather(test, c, tile, kRadius), gather(reference, c, tile, kRadius), term);
      for (int y = 0; y < tile.height; ++y)
        for (int x = 0; x < tile.width; ++x) field.at(tile.x + x, tile.y + y)[c] = values.row(y)[x];
    }
  });
  return field;
}

// Where windows lie inside the picture.
PixelRect inner(const Image& image) { return {kRadius, kRadius, image.width - 2 * kRadius, image.height - 2 * kRadius}; }

float mean_of_channels(const float* rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

MetricResult ssim(const MetricInput& in) {
  const Image field = ssim_field(in.test, in.reference, Term::kSimilarity);
  const PixelRect windows = inner(field);
  MetricResult result{make_field(field.width, field.height)};
  for_each_row(field.height, [&](int y) {
    const int inner_y = std::clamp(y, windows.y, windows.y + windows.height - 1);
    for (int x = 0; x < field.width; ++x)
      *result.map.at(x, y) = 1 - mean_of_channels(field.at(std::clamp(x, windows.x, windows.x + windows.width - 1), inner_y));
  });
  result.value = [map = result.map, windows](const PixelSet& set) -> std::optional<double> {
    const std::optional<double> error = mean_over(set, windows, [&](int x, int y) { return *map.at(x, y); });
    if (!error) return std::nullopt;
    return 1 - *error;
  };
  return result;
}

// Means of 2 × 2 pixels; the last row or column of an odd size counts twice.
Image half(const Image& image) {
  Image out((image.width + 1) / 2, (image.height + 1) / 2, image.channels);
  for_each_row(out.height, [&](int y) {
    const int y1 = std::min(2 * y + 1, image.height - 1);
    for (int x = 0; x < out.width; ++x) {
      const int x1 = std::min(2 * x + 1, image.width - 1);
      for (std::size_t c = 0; c < 3; ++c)
        out.at(x, y)[c] =
            0.25f * ((image.at(2 * x, 2 * y)[c] + image.at(x1, 2 * y)[c]) + (image.at(2 * x, y1)[c] + image.at(x1, y1)[c]));
    }
  });
  return out;
}

// The pixels of the next coarser scale of which any pixel is in the set.
struct ScaledSet {
  PixelMask mask;
  PixelSet set;

  ScaledSet(const PixelSet& fine, int height) {
    const int width = (fine.width + 1) / 2;
    const PixelRect r = fine.rect;
    set = {width, {r.x / 2, r.y / 2, (r.x + r.width + 1) / 2 - r.x / 2, (r.y + r.height + 1) / 2 - r.y / 2}};
    if (fine.mask.empty()) return;
    mask.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>((height + 1) / 2));
    for (int y = r.y; y < r.y + r.height; ++y)
      for (int x = r.x; x < r.x + r.width; ++x)
        if (fine.contains(x, y))
          mask[static_cast<std::size_t>(y / 2) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x / 2)] = 1;
    set.mask = mask;
  }
};

// Π_j mean(cs_j)^w_j with SSIM for the coarsest scale, of each channel; then the mean of the channels. A mean below 0,
// where pictures are each other's negative, counts as 0.
std::optional<double> pool_scales(const std::vector<Image>& fields, const PixelSet& finest) {
  std::array<double, 3> products{1, 1, 1};
  PixelSet set = finest;
  std::vector<ScaledSet> coarser;
  coarser.reserve(fields.size());
  for (std::size_t j = 0; j < fields.size(); ++j) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::optional<double> mean = mean_over(set, inner(fields[j]), [&](int x, int y) { return fields[j].at(x, y)[c]; });
      if (!mean) return std::nullopt;
      products[c] *= std::pow(std::max(0.0, *mean), kScaleWeights[j]);
    }
    set = coarser.emplace_back(set, fields[j].height).set;
  }
  return (products[0] + products[1] + products[2]) / 3;
}

MetricResult ms_ssim(const MetricInput& in) {
  std::vector<Image> fields;
  Image test = in.test, reference = in.reference;
  for (int j = 0; j < kScales; ++j) {
    if (j > 0) test = half(test), reference = half(reference);
    fields.push_back(ssim_field(test, reference, j + 1 == kScales ? Term::kSimilarity : Term::kContrastStructure));
  }
  MetricResult result;
  result.value = [fields = std::move(fields)](const PixelSet& set) { return pool_scales(fields, set); };
  return result;
}

std::string too_small(const MetricInput& in, int least) {
  if (in.test.width >= least && in.test.height >= least) return "";
  return fmt::format("{} × {} pixels are too few; at least {} a side are needed", in.test.width, in.test.height, least);
}

constexpr const char* kNoWindow = "no window around these pixels lies inside the picture";
constexpr int kLeastMultiScale = (kWindow - 1) * (1 << (kScales - 1)) + 1;  // leaves one window at the coarsest scale

}  // namespace

Metric ssim_metric() {
  return {.key = "ssim",
          .description = "structural similarity, display-encoded; 1 is equal",
          .domain = Encoding::kDisplay,
          .higher_is_better = true,
          .no_value = kNoWindow,
          .map_scale = 1,
          .unavailable = [](const MetricInput& in) { return too_small(in, kWindow); },
          .evaluate = ssim};
}

Metric ms_ssim_metric() {
  return {.key = "ms_ssim",
          .description = "multi-scale structural similarity, display-encoded; 1 is equal",
          .domain = Encoding::kDisplay,
          .higher_is_better = true,
          .has_map = false,
          .no_value = kNoWindow,
          .unavailable = [](const MetricInput& in) { return too_small(in, kLeastMultiScale); },
          .evaluate = ms_ssim};
}

}  // namespace pelage::metrics
