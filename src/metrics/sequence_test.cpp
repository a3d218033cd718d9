// Sequences: what adjacent-frame PSNR and flicker say about motion, standing errors and flashing ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/metrics.h>

#include <cmath>

#include "metrics/test_pictures.h"

namespace pelage::metrics {
namespace {

using testing::HasSubstr;

Picture gray(float value, int width = 24, int height = 16) {
  Picture picture = make_picture(width, height);
  std::fill(picture.image.pixels.begin(), picture.image.pixels.end(), value);
  return picture;
}

std::optional<double> temporal(const SequenceComparison& c, const std::string& key) {
  for (const MetricValue& v : c.temporal)
    if (v.key == key) return v.value;
  ADD_FAILURE() << "no " << key;
  return std::nullopt;
}

SequenceComparison compare(const std::vector<float>& test, const std::vector<float>& reference) {
  return compare_sequences(
      static_cast<int>(test.size()), [&](int i) { return gray(test[static_cast<std::size_t>(i)]); },
      [&](int i) { return gray(reference[static_cast<std::size_t>(i)]); });
}

TEST(Sequence, ByHand) {
  const SequenceComparison c = compare({0.5f, 0.75f, 0.25f}, {0.5f, 0.5f, 0.25f});
  ASSERT_EQ(c.frames.size(), 3u);
  EXPECT_NEAR(c.frames[1].value("mse").value(), 0.0625, 1e-9);
  EXPECT_EQ(c.mean.at(0).key, "mse");
  EXPECT_NEAR(c.mean.at(0).value.value(), 0.0625 / 3, 1e-9);
  const double first = -10 * std::log10(0.0625), second = -10 * std::log10(0.25);
  EXPECT_NEAR(temporal(c, "adjacent_psnr").value(), (first + second) / 2, 1e-6);
  EXPECT_NEAR(temporal(c, "adjacent_psnr_min").value(), second, 1e-6);
  EXPECT_EQ(c.reference_adjacent_psnr.at(0), std::nullopt) << "equal frames";
  EXPECT_NEAR(temporal(c, "reference_adjacent_psnr").value(), first, 1e-6);
  // Steps of the test 0.25, −0.5; of the reference 0, −0.25.
  EXPECT_NEAR(c.flicker.at(0), 0.25, 1e-7);
  EXPECT_NEAR(c.flicker.at(1), 0.25, 1e-7);
  EXPECT_NEAR(temporal(c, "flicker").value(), 0.25, 1e-7);
}

TEST(Sequence, AStandingErrorDoesNotFlickerAFlashingOneDoes) {
  const std::vector<float> moving{0.1f, 0.4f, 0.2f, 0.5f};
  EXPECT_NEAR(temporal(compare({0.2f, 0.5f, 0.3f, 0.6f}, moving), "flicker").value(), 0, 1e-7);
  EXPECT_NEAR(temporal(compare({0.2f, 0.3f, 0.3f, 0.4f}, moving), "flicker").value(), 0.2, 1e-6);
}

TEST(Sequence, EqualFramesAreInfinitelyAlike) {
  const SequenceComparison c = compare({0.5f, 0.5f}, {0.5f, 0.5f});
  EXPECT_EQ(temporal(c, "adjacent_psnr"), std::nullopt);
  EXPECT_THAT(c.temporal.at(0).note, HasSubstr("infinite"));
  EXPECT_EQ(temporal(c, "flicker"), 0);
}

TEST(Sequence, OneFrameHasNothingOverTime) {
  const SequenceComparison c = compare({0.5f}, {0.25f});
  EXPECT_TRUE(c.temporal.empty());
  EXPECT_NEAR(c.mean.at(0).value.value(), 0.0625, 1e-9);
}

TEST(Sequence, HairOfEitherFrameCounts) {
  // Hair covers the left pixel, then the right one; the test shows nothing of it.
  const auto frame = [](int i, float value) {
    Picture p{Image(2, 1, {"R", "G", "B", "coverage"}), Encoding::kDisplay, "frame"};
    std::fill_n(p.image.at(i, 0), 4, value);
    return p;
  };
  CompareOptions options;
  options.metrics = {"mse"};
  const SequenceComparison c = compare_sequences(
      2, [&](int) { return frame(0, 0); }, [&](int i) { return frame(i, i ? 0.25f : 0.5f); }, true, options);
  EXPECT_EQ(c.frames.at(0).pixels, 1u);
  EXPECT_NEAR(c.flicker.at(0), (0.5 + 0.25) / 2, 1e-7) << "both the pixel that hair left and the one it came to";
}

TEST(Sequence, BadInputIsRefused) {
  EXPECT_THROW(compare({}, {}), Error);
  EXPECT_THROW(compare_sequences(
                   2, [](int i) { return gray(0, 8 + i, 8); }, [](int i) { return gray(0, 8 + i, 8); }),
               Error);
  CompareOptions options;
  options.maps = {"flip"};
  EXPECT_THROW(compare_sequences(
                   1, [](int) { return gray(0); }, [](int) { return gray(0); }, false, options),
               Error);
}

}  // namespace
}  // namespace pelage::metrics
