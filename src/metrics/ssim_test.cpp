// SSIM and MS-SSIM against a slow version in double, and against values that can be worked out by hand.
#include <gtest/gtest.h>
#include <pelage/metrics.h>

#include <array>
#include <cmath>

#include "metrics/naive_ssim.h"
#include "metrics/test_pictures.h"

namespace pelage::metrics {
namespace {

double value_of(const Picture& test, const Picture& reference, const std::string& key, const CompareOptions& options = {}) {
  return compare_images(test, reference, options).value(key).value();
}

SsimTerms mean_terms(const Image& t, const Image& r, std::size_t c) {
  SsimTerms sum{0, 0};
  for (int y = 5; y < t.height - 5; ++y)
    for (int x = 5; x < t.width - 5; ++x) {
      const SsimTerms w = naive_ssim(t, r, x, y, c);
      sum.similarity += w.similarity, sum.structure += w.structure;
    }
  const double count = static_cast<double>(t.width - 10) * (t.height - 10);
  return {sum.similarity / count, sum.structure / count};
}

Image halved(const Image& image) {
  Image out((image.width + 1) / 2, (image.height + 1) / 2, image.channels);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (int i = 0; i < 4; ++i)
          sum += static_cast<double>(
              image.at(std::min(2 * x + i % 2, image.width - 1), std::min(2 * y + i / 2, image.height - 1))[c]);
        out.at(x, y)[c] = static_cast<float>(sum / 4);
      }
  return out;
}

TEST(Ssim, IsThatOfTheSlowDefinition) {
  const Picture reference = drawn(270, 70), test = noisy(reference, 0.25f);
  double expected = 0;
  for (std::size_t c = 0; c < 3; ++c) expected += mean_terms(test.image, reference.image, c).similarity / 3;
  EXPECT_NEAR(value_of(test, reference, "ssim"), expected, 1e-6);
}

TEST(Ssim, FlatPicturesDifferInLuminanceAlone) {
  Picture dark = make_picture(30, 20), light = dark;
  std::fill(dark.image.pixels.begin(), dark.image.pixels.end(), 0.25f);
  std::fill(light.image.pixels.begin(), light.image.pixels.end(), 0.75f);
  EXPECT_NEAR(value_of(dark, light, "ssim"), (2 * 0.25 * 0.75 + 1e-4) / (0.0625 + 0.5625 + 1e-4), 2e-4);
}

TEST(Ssim, ANegativeHasNegativeStructure) {
  const Picture picture = noisy(make_picture(40, 40), 1);
  Picture negative = picture;
  for (float& c : negative.image.pixels) c = 1 - c;
  EXPECT_LT(value_of(negative, picture, "ssim"), -0.5);
}

TEST(Ssim, RegionsAverageTheWindowsOfTheirPixels) {
  const Picture reference = drawn(60, 50), test = noisy(reference, 0.25f);
  CompareOptions options;
  options.metrics = {"ssim"};
  options.regions = {{"inside", {20, 20, 2, 1}}, {"corner", {0, 0, 5, 50}}};
  const Comparison c = compare_images(test, reference, options);
  double expected = 0;
  for (std::size_t i = 0; i < 3; ++i)
    expected += (naive_ssim(test.image, reference.image, 20, 20, i).similarity +
                 naive_ssim(test.image, reference.image, 21, 20, i).similarity) /
                6;
  EXPECT_NEAR(c.regions[0].values[0].value.value(), expected, 2e-6);
  EXPECT_EQ(c.regions[1].values[0].value, std::nullopt);
  EXPECT_EQ(c.regions[1].values[0].note, "no window around these pixels lies inside the picture");
}

TEST(MsSsim, IsThatOfTheSlowDefinition) {
  const Picture reference = drawn(181, 163), test = noisy(reference, 0.4f);  // odd sizes at every scale
  constexpr std::array<double, 5> weights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
  double expected = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    Image t = test.image, r = reference.image;
    double product = 1;
    for (std::size_t j = 0; j < 5; ++j) {
      if (j > 0) t = halved(t), r = halved(r);
      const SsimTerms terms = mean_terms(t, r, c);
      product *= std::pow(j == 4 ? terms.similarity : terms.structure, weights[j]);
    }
    expected += product / 3;
  }
  EXPECT_NEAR(value_of(test, reference, "ms_ssim"), expected, 1e-5);
}

TEST(MsSsim, LooksAtTheMaskAtEveryScale) {
  constexpr int width = 400, height = 200;  // 25 × 13 at the coarsest scale, whose windows have centers 5 … 19
  const Picture reference = drawn(width, height);
  Picture test = reference;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 60; ++x) test.image.at(x, y)[0] = 0.3f;
  CompareOptions left, right, all;
  for (CompareOptions* o : {&left, &right, &all}) o->metrics = {"ms_ssim"}, o->mask.assign(width * height, o == &all);
  for (int y = 0; y < height; ++y) {
    std::fill_n(left.mask.begin() + y * width, 160, 1);
    std::fill_n(right.mask.begin() + y * width + 200, 200, 1);
  }
  EXPECT_LT(value_of(test, reference, "ms_ssim", left), 0.95);
  EXPECT_EQ(value_of(test, reference, "ms_ssim", all), value_of(test, reference, "ms_ssim"));
  EXPECT_EQ(value_of(test, reference, "ms_ssim", right), 1) << "no window of x ≥ 200 reaches x < 60 at any scale";
}

TEST(MsSsim, NeedsOneWindowAtTheCoarsestScale) {
  CompareOptions options;
  options.metrics = {"ms_ssim"};
  EXPECT_NEAR(value_of(drawn(161, 161), drawn(161, 161), "ms_ssim", options), 1, 1e-12);
  EXPECT_ANY_THROW(compare_images(drawn(160, 161), drawn(160, 161), options));
  EXPECT_EQ(compare_images(drawn(160, 161), drawn(160, 161)).value("ms_ssim"), std::nullopt);
}

}  // namespace
}  // namespace pelage::metrics
