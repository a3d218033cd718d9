// FLIP: the published tool's means, the slow definition, and what must hold for any pair.
#include "metrics/flip.h"

#include <gtest/gtest.h>
#include <pelage/metrics.h>
#include <pelage/runtime.h>

#include <cstdlib>
#include <filesystem>

#include "metrics/flip_hdr.h"
#include "metrics/naive_flip.h"
#include "metrics/pair.h"
#include "metrics/test_pictures.h"

namespace pelage::metrics {
namespace {

namespace fs = std::filesystem;

Comparison flip_of(const Picture& test, const Picture& reference, std::vector<std::string> maps = {}) {
  CompareOptions options;
  options.metrics = {"flip"};
  options.maps = std::move(maps);
  return compare_images(test, reference, options);
}

double flip_value(const Picture& test, const Picture& reference) { return flip_of(test, reference).value("flip").value(); }

// Means that NVIDIA's FLIP 1.6 gives for pairs that the folder of oracles holds.
struct Published {
  const char* pair;
  const char* extension;
  double mean;
  double tolerance = 2e-6;
  double start_exposure = 0, stop_exposure = 0;
};

class FlipPublished : public testing::TestWithParam<Published> {
 protected:
  // The picture `suffix` of the pair, or none where the folder is absent.
  static std::optional<Picture> read(const std::string& suffix) {
    const char* data = std::getenv("PELAGE_DATA");
    const fs::path file =
        fs::path(data ? data : "") / ".." / "oracles" / "flip" / (GetParam().pair + suffix + GetParam().extension);
    return fs::exists(file) ? std::optional(read_picture(file.string())) : std::nullopt;
  }
};

TEST_P(FlipPublished, MeanAgrees) {
  const auto test = read("_test"), reference = read("_ref");
  if (!test || !reference) GTEST_SKIP() << "no oracles/flip beside PELAGE_DATA";
  const Comparison comparison = flip_of(*test, *reference);
  EXPECT_NEAR(comparison.value("flip").value(), GetParam().mean, GetParam().tolerance);
  ASSERT_EQ(comparison.details.empty(), GetParam().start_exposure == 0);
  if (comparison.details.empty()) return;
  EXPECT_NEAR(comparison.details.at(0).value.value(), GetParam().start_exposure, 1e-4);
  EXPECT_NEAR(comparison.details.at(1).value.value(), GetParam().stop_exposure, 1e-4);
  EXPECT_EQ(comparison.details.at(2).value.value(), 2);
}

// The published mean of blackwhite is a sum in single precision: see the test below, which finds it to 1e-6.
INSTANTIATE_TEST_SUITE_P(Pairs, FlipPublished,
                         testing::Values(Published{"same", ".png", 0}, Published{"noise20", ".png", 0.089796},
                                         Published{"lines", ".png", 0.153791}, Published{"blackwhite", ".png", 0.967661, 1e-3},
                                         Published{"same", ".exr", 0, 2e-6, -1.8533, -0.0802},
                                         Published{"noise20", ".exr", 0.106978, 2e-6, -1.8533, -0.0844},
                                         Published{"lines", ".exr", 0.155187, 2e-6, -1.8533, -0.0802}),
                         [](const auto& p) {
                           return std::string(p.param.pair) + (p.param.start_exposure != 0 ? "Hdr" : "Ldr");
                         });

// Every pixel of white against black has one error. The published program adds 256 × 192 of them in single precision, whose
// rounding has a bias of 2.7e-4; ours adds in double and gives the error itself.
TEST(Flip, PublishedMeanOfFlatPairsIsASumInSinglePrecision) {
  Picture black = make_picture(256, 192), white = black;
  std::fill(white.image.pixels.begin(), white.image.pixels.end(), 1.f);
  const Comparison comparison = flip_of(white, black, {"flip"});
  float sum = 0;
  for (const float error : comparison.maps.at(0).error.pixels) sum += error;
  EXPECT_NEAR(sum / (256 * 192), 0.967661f, 1e-6f);
  const double exact = spread_color_error(std::pow(100.0, kColorExponent), largest_color_error());
  EXPECT_NEAR(comparison.value("flip").value(), exact, 1e-5);
}

TEST(Flip, EveryPixelIsThatOfTheSlowDefinition) {
  const Picture reference = drawn(300, 70), test = noisy(reference, 0.3f);  // two tiles a side, both cut
  const Image t = decode_display(test.image), r = decode_display(reference.image);
  for (const float ppd : {67.0206f, 20.f, 91.7f}) {
    Image error(t.width, t.height, {"error"});
    raise_to_flip(flip_opponent(t), flip_opponent(r), ppd, error);
    const NaiveFlip naive(t, r, static_cast<double>(ppd));
    for (int y = 0; y < t.height; y += 3)
      for (int x = y % 7; x < t.width; x += 7)
        ASSERT_NEAR(static_cast<double>(*error.at(x, y)), naive.at(x, y), 1e-5) << x << ", " << y << " at " << ppd;
    for (const int x : {0, 255, 256, 299})
      for (const int y : {0, 63, 64, 69})
        ASSERT_NEAR(static_cast<double>(*error.at(x, y)), naive.at(x, y), 1e-5) << x << ", " << y << " at " << ppd;
  }
}

TEST(Flip, EqualPicturesHaveNoErrorAtAll) {
  const Picture picture = drawn(90, 40);
  EXPECT_EQ(flip_value(picture, picture), 0);
  const Picture linear = drawn(90, 40, Encoding::kLinear);
  EXPECT_EQ(flip_value(linear, linear), 0);
}

TEST(Flip, IsSymmetricGrowsWithTheErrorAndStaysBelowOne) {
  const Picture reference = drawn(90, 60);
  double before = 0;
  for (const float amplitude : {0.02f, 0.1f, 0.4f, 1.f}) {
    const Picture test = noisy(reference, amplitude);
    const double value = flip_value(test, reference);
    EXPECT_GT(value, before);
    EXPECT_LE(value, 1);
    EXPECT_NEAR(value, flip_value(reference, test), 1e-7);
    before = value;
  }
}

TEST(Flip, FartherScreensHideMore) {
  const Picture reference = drawn(90, 60), test = noisy(reference, 0.2f);
  CompareOptions near_by, far_off;
  near_by.pixels_per_degree = 30, far_off.pixels_per_degree = 120;
  EXPECT_GT(compare_images(test, reference, near_by).value("flip"), compare_images(test, reference, far_off).value("flip"));
}

TEST(Flip, ASmallPictureHasAValueToo) {
  Picture black = make_picture(1, 1), white = black;
  std::fill(white.image.pixels.begin(), white.image.pixels.end(), 1.f);
  EXPECT_NEAR(flip_value(white, black), 0.967388, 1e-5);
}

TEST(Flip, SameBitsForAnyNumberOfThreadsAndInstructionSet) {
  const Picture reference = drawn(530, 150), test = noisy(reference, 0.2f);
  const std::vector<float> expected = flip_of(test, reference, {"flip"}).maps.at(0).error.pixels;
  const double value = flip_value(test, reference);
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    EXPECT_EQ(flip_value(test, reference), value) << threads;
  }
  set_thread_count(0);
  const std::string best = active_isa();
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(flip_of(test, reference, {"flip"}).maps.at(0).error.pixels, expected) << isa;
  }
  set_isa(best);
}

TEST(HdrFlip, ExposuresShowTheBrightestAndTheMedianPixel) {
  Picture picture = make_picture(3, 1, Encoding::kLinear);
  const float values[] = {0.25f, 0.5f, 16.f};
  for (int x = 0; x < 3; ++x) std::fill_n(picture.image.at(x, 0), 3, values[x]);
  const Exposures e = find_exposures(picture.image);
  EXPECT_NEAR(e.stop - e.start, 5, 1e-6) << "log2(16 / 0.5)";
  const double x = 16 * std::exp2(e.start), y = 0.6 * x;
  EXPECT_NEAR(y * (2.51 * y + 0.03) / (y * (2.43 * y + 0.59) + 0.14), 0.85, 1e-6);
}

TEST(HdrFlip, TheMedianOfAnEvenNumberIsTheUpperOne) {
  Picture picture = make_picture(4, 1, Encoding::kLinear);
  const float values[] = {0.125f, 4.f, 0.25f, 1.f};
  for (int x = 0; x < 4; ++x) std::fill_n(picture.image.at(x, 0), 3, values[x]);
  const Exposures e = find_exposures(picture.image);
  EXPECT_NEAR(e.stop - e.start, 2, 1e-6) << "log2(4 / 1)";
}

TEST(HdrFlip, IsTheWorstOverTheExposures) {
  const Picture reference = drawn(60, 40, Encoding::kLinear);
  Picture test = reference;
  for (float& c : test.image.pixels) c *= 1.2f;
  CompareOptions one, other, both;
  one.metrics = other.metrics = both.metrics = one.maps = other.maps = both.maps = {"flip"};
  one.start_exposure = one.stop_exposure = both.start_exposure = -2;
  other.start_exposure = other.stop_exposure = both.stop_exposure = 1;
  const Image a = compare_images(test, reference, one).maps.at(0).error,
              b = compare_images(test, reference, other).maps.at(0).error;
  both.exposures = 2;
  const Image c = compare_images(test, reference, both).maps.at(0).error;
  for (std::size_t p = 0; p < c.pixels.size(); ++p) ASSERT_EQ(c.pixels[p], std::max(a.pixels[p], b.pixels[p]));
}

TEST(HdrFlip, BlackAndBrightPixelsAreNumbers) {
  Picture black = make_picture(20, 20, Encoding::kLinear), bright = black;
  std::fill(bright.image.pixels.begin(), bright.image.pixels.end(), 1e30f);
  for (const double value : {flip_value(bright, black), flip_value(black, bright)}) {
    EXPECT_GT(value, 0.9);
    EXPECT_LE(value, 1);
  }
}

}  // namespace
}  // namespace pelage::metrics
