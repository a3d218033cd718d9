// Continuity of lines whose share is known: drawn whole, dashed, one pixel off, blurred, in haze, not at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/metrics.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace pelage {
namespace {

constexpr int kWidth = 120, kHeight = 60;
constexpr float kAlpha = 0.25f;
using Fill = std::function<float(int, int)>;

/// White hair of opacity alpha(x, y) over nothing.
Picture picture(const Fill& alpha) {
  Picture p{Image(kWidth, kHeight, {"R", "G", "B", "A"}), Encoding::kLinear, "drawn"};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) std::fill_n(p.image.at(x, y), 4, alpha(x, y));
  return p;
}

/// A part from x = 10 to 110 along y = y0 + slope·(x − 10).
FlyawayPaths path(float y0 = 30.4f, float slope = 0) {
  FlyawayPaths paths{.width = kWidth, .height = kHeight};
  const float dx = FlyawayPaths::kStep / std::sqrt(1 + slope * slope);
  for (float x = 10; x <= 110; x += dx) paths.places.emplace_back(x, y0 + slope * (x - 10));
  paths.offsets.push_back(static_cast<std::uint32_t>(paths.places.size()));
  return paths;
}

const Picture kLine = picture([](int, int y) { return y == 30 ? kAlpha : 0; });

Continuity measure(const Fill& alpha) { return measure_continuity(picture(alpha), kLine, path()); }

TEST(Continuity, OfTheReferenceItselfIsWhole) {
  const Continuity c = measure_continuity(kLine, kLine, path());
  EXPECT_EQ(c.connected, 1);
  EXPECT_EQ(c.shown, 1);
  EXPECT_EQ(c.mean_gap, 0);
  EXPECT_NEAR(c.length, 100, 1);
}

TEST(Continuity, OfNothingIsNone) {
  const Continuity c = measure([](int, int) { return 0.f; });
  EXPECT_EQ(c.connected, 0);
  EXPECT_EQ(c.shown, 0);
  EXPECT_NEAR(c.mean_gap, 100, 1);
}

TEST(Continuity, OfDashesIsWhatTheirLongRunsAreWorth) {
  const auto dashes = [](int on, int off) {
    return measure([=](int x, int y) { return y == 30 && x % (on + off) < on ? kAlpha : 0; });
  };
  const Continuity brief = dashes(4, 4), lengthy = dashes(15, 5);
  EXPECT_NEAR(brief.shown.value(), 0.5, 0.03);
  EXPECT_EQ(brief.connected, 0) << "as much is shown, but there is no line to follow";
  EXPECT_NEAR(brief.mean_gap, 4, 0.2);
  EXPECT_NEAR(lengthy.connected.value(), 0.7, 0.02) << "of 75 pixels the path's first five are a run that is too short";
  EXPECT_NEAR(lengthy.mean_gap, 5, 0.2);
}

TEST(Continuity, SeesAGapOfOnePixelHoweverBrightItsNeighborsAre) {
  const Continuity c = measure([](int x, int y) { return y == 30 && x % 6 ? 1.f : 0; });
  EXPECT_EQ(c.connected, 0);
  EXPECT_NEAR(c.mean_gap, 1, 0.1);
}

TEST(Continuity, AllowsForAPixelToTheSideAndNoMore) {
  EXPECT_EQ(measure([](int, int y) { return y == 29 ? kAlpha : 0; }).connected, 1);
  EXPECT_EQ(measure([](int, int y) { return y == 32 ? kAlpha : 0; }).connected, 0);
}

TEST(Continuity, DoesNotTakeHazeForALine) {
  EXPECT_EQ(measure([](int, int) { return kAlpha; }).shown, 0);
  EXPECT_EQ(measure([](int x, int) { return 0.01f * static_cast<float>(x % 50); }).shown, 0) << "a ramp along the line";
}

TEST(Continuity, LosesWhatIsBlurredWide) {
  const auto blurred = [](float sigma) {
    return measure([=](int, int y) {
      const float d = static_cast<float>(y - 30) / sigma;
      return kAlpha / (sigma * 2.5066f) * std::exp(-d * d / 2);
    });
  };
  EXPECT_EQ(blurred(0.8f).connected, 1) << "as soft as a good filter leaves it";
  EXPECT_EQ(blurred(2.5f).connected, 0);
}

TEST(Continuity, BlurredDashesAreNoLine) {
  const Continuity c = measure([](int x, int y) {
    const float d = static_cast<float>(y - 30) / 4, along = 0.5f + 0.5f * std::cos(static_cast<float>(x) * 0.5236f);
    return kAlpha * along * std::exp(-d * d / 2);
  });
  EXPECT_EQ(c.connected, 0);
}

TEST(Continuity, DoesNotAskForWhatTheReferenceDoesNotShow) {
  const Picture half = picture([](int x, int y) { return y == 30 && x < 60 ? kAlpha : 0; });
  const Continuity c = measure_continuity(half, half, path());
  EXPECT_EQ(c.connected, 1);
  EXPECT_NEAR(c.length, 50, 1);
  EXPECT_EQ(measure_continuity(kLine, picture([](int, int) { return 0.f; }), path()).connected, std::nullopt);
}

TEST(Continuity, FollowsSlantedLines) {
  for (const float slope : {0.3f, 1.f, -0.2f}) {
    const float y0 = slope > 0.5f ? -30.f : 20.f;
    FlyawayPaths paths = path(y0, slope);
    std::erase_if(paths.places, [](Vec2 p) { return p.y < 5 || p.y > kHeight - 5; });
    paths.offsets.back() = static_cast<std::uint32_t>(paths.places.size());
    const auto band = [&](float x, float y) {
      return std::max(0.f, kAlpha * (1 - std::fabs(y - (y0 + slope * (x - 10))) / std::sqrt(1 + slope * slope)));
    };
    const auto at = [](int i) { return static_cast<float>(i) + 0.5f; };
    const Picture line = picture([&](int x, int y) { return band(at(x), at(y)); });
    const Picture dashed = picture([&](int x, int y) { return x % 10 < 5 ? band(at(x), at(y)) : 0; });
    EXPECT_EQ(measure_continuity(line, line, paths).connected, 1) << slope;
    const Continuity c = measure_continuity(dashed, line, paths);
    EXPECT_LT(c.connected.value(), 0.2) << slope;
    EXPECT_NEAR(c.shown.value(), 0.5, 0.1) << slope;
  }
}

TEST(Continuity, ColorStandsInForAlpha) {
  const auto dark_on_bright = [](const Fill& alpha) {
    Picture p{Image(kWidth, kHeight, {"R", "G", "B"}), Encoding::kLinear, "opaque"};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) std::fill_n(p.image.at(x, y), 3, 1 - 0.9f * alpha(x, y));
    return p;
  };
  const Picture line = dark_on_bright([](int, int y) { return y == 30 ? kAlpha : 0; });
  const Picture inverse = dark_on_bright([](int, int y) { return y == 30 ? -kAlpha : 0; });
  EXPECT_EQ(measure_continuity(line, line, path()).connected, 1);
  EXPECT_EQ(measure_continuity(inverse, line, path()).connected, 0) << "a bright line is not the dark one";
  EXPECT_EQ(measure_continuity(line, kLine, path()).connected, 0)
      << "nor on the other background; alpha of one alone is not read";
}

TEST(Continuity, SameForAnyThreads) {
  FlyawayPaths paths = path();
  const std::vector<Vec2> one = paths.places;
  for (int i = 0; i < 500; ++i) {
    paths.places.insert(paths.places.end(), one.begin(), one.end());
    paths.offsets.push_back(static_cast<std::uint32_t>(paths.places.size()));
  }
  const Picture dashed = picture([](int x, int y) { return y == 30 && x % 13 ? kAlpha : 0; });
  set_thread_count(1);
  const Continuity alone = measure_continuity(dashed, kLine, paths);
  set_thread_count(3);
  const Continuity together = measure_continuity(dashed, kLine, paths);
  set_thread_count(0);
  EXPECT_EQ(alone.connected, together.connected);
  EXPECT_EQ(alone.mean_gap, together.mean_gap);
}

TEST(Continuity, RefusesOtherSizes) {
  FlyawayPaths paths = path();
  paths.width = 99;
  EXPECT_THROW(measure_continuity(kLine, kLine, paths), Error);
}

}  // namespace
}  // namespace pelage
