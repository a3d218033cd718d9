// Temporal anti-aliasing on a world that can be computed: painted planes before a camera that slides.
#include "filter/taa.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <cmath>

#include "core/rng.h"
#include "filter/motion.h"
#include "frame/camera_view.h"
#include "frame/sample_positions.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr int kWidth = 64, kHeight = 48;

CameraView camera_at(float x) {
  Camera camera;
  camera.eye = {x, 0, 2};
  camera.target = {x, 0, 0};
  camera.fov_y = 0.8f;
  return make_camera_view(camera, kWidth, kHeight);
}

/// Meters by which the picture of a plane at `depth` moves one pixel.
float meters_per_pixel(float depth) { return depth / camera_at(0).focal; }

/// A smooth pattern on a plane.
float paint(float x, float y) { return 0.5f + 0.25f * std::sin(9 * x) + 0.2f * std::cos(7 * y + 2 * x); }

/// A picture of the plane 2 m away, and of a black card 1 m away whose left edge is at `card` meters.
TaaFrame picture(const CameraView& view, Vec2 position, float card = 1e9f) {
  TaaFrame frame{Image(kWidth, kHeight, {"R", "G", "B", "A"}), Buffer<float>(kWidth * kHeight), view, position};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float px = (static_cast<float>(x) + position.x - view.center_x) / view.focal;
      const float py = (static_cast<float>(y) + position.y - view.center_y) / view.focal;
      const float eye = view.camera_to_world.m[0][3];
      const bool before_card = eye + px > card;
      float* c = frame.color.at(x, y);
      c[0] = c[1] = c[2] = before_card ? 0.f : paint(eye + 2 * px, 2 * py);
      c[3] = 1;
      frame.depth[static_cast<std::size_t>(y * kWidth + x)] = before_card ? 1.f : 2.f;
    }
  return frame;
}

constexpr Vec2 kCenter{0.5f, 0.5f};
constexpr TaaSettings kNoClipping{.least_blend = 1e-6f, .clip_deviations = INFINITY};

double worst(const Image& a, const Image& b, int border) {
  double most = 0;
  for (int y = border; y < kHeight - border; ++y)
    for (int x = border; x < kWidth - border; ++x)
      most = std::max(most, static_cast<double>(std::fabs(a.at(x, y)[0] - b.at(x, y)[0])));
  return most;
}

TEST(Taa, TheFirstFrameStays) {
  TaaHistory history;
  history.add(picture(camera_at(0), kCenter));
  EXPECT_EQ(history.picture().pixels, picture(camera_at(0), kCenter).color.pixels);
}

TEST(Taa, AStillCameraMakesTheMeanOfItsFrames) {
  TaaHistory history(kNoClipping);
  std::vector<double> sum(kWidth * kHeight * 4);
  for (std::uint32_t i = 0; i < 20; ++i) {
    TaaFrame frame = picture(camera_at(0), jitter_position(i), 0.1f);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += static_cast<double>(frame.color.pixels[k]);
    history.add(std::move(frame));
  }
  for (std::size_t k = 0; k < sum.size(); ++k) ASSERT_NEAR(history.picture().pixels[k], sum[k] / 20, 2e-6) << k;
}

// The camera slides by a third of a pixel, and by several pixels: the history must be found again where it went.
TEST(Taa, AMovingCameraFindsItsHistory) {
  for (const float pixels : {0.33f, 1.f, 2.6f, -3.45f}) {
    TaaHistory history(kNoClipping);
    const int frames = 8;
    for (int i = 0; i < frames; ++i)
      history.add(picture(camera_at(static_cast<float>(i) * pixels * meters_per_pixel(2)), kCenter));
    const Image truth = picture(camera_at((frames - 1) * pixels * meters_per_pixel(2)), kCenter).color;
    EXPECT_LT(worst(history.picture(), truth, 8), 0.006) << pixels << " pixels a frame";
  }
}

// What a card uncovers was black a frame ago; nothing of that may stay.
TEST(Taa, WhatWasHiddenHasNoHistory) {
  const float step = 2.5f * meters_per_pixel(2);
  TaaHistory history(kNoClipping);
  history.add(picture(camera_at(0), kCenter, 0.05f));
  history.add(picture(camera_at(-step), kCenter, 0.05f));
  const Image truth = picture(camera_at(-step), kCenter, 0.05f).color;
  for (int y = 2; y < kHeight - 2; ++y)
    for (int x = 4; x < kWidth - 4; ++x) {
      if (truth.at(x, y)[0] == 0) continue;
      ASSERT_GT(history.picture().at(x, y)[0], 0.8f * truth.at(x, y)[0]) << x << ", " << y;
    }
}

TEST(Taa, ClippingForgetsColorsThatAreGone) {
  TaaHistory history({.clip_deviations = 1});
  TaaFrame bright = picture(camera_at(0), kCenter);
  for (std::size_t k = 0; k < bright.color.pixels.size(); ++k)
    if (k % 4 != 3) bright.color.pixels[k] += 5;
  history.add(std::move(bright));
  history.add(picture(camera_at(0), kCenter));
  EXPECT_LT(worst(history.picture(), picture(camera_at(0), kCenter).color, 1), 0.3) << "the light went out";
}

TEST(Taa, HasTheSameBitsForAnyThreads) {
  const auto run = [](int threads) {
    set_thread_count(threads);
    TaaHistory history;
    for (int i = 0; i < 4; ++i)
      history.add(picture(camera_at(0.01f * static_cast<float>(i)), jitter_position(static_cast<std::uint32_t>(i)), 0.1f));
    set_thread_count(0);
    return history.picture().pixels;
  };
  EXPECT_EQ(run(1), run(5));
}

TEST(Motion, AStillCameraMovesNothing) {
  Buffer<float> depth(kWidth * kHeight);
  for (std::size_t p = 0; p < depth.size(); ++p) depth[p] = p % 3 ? 0.1f + static_cast<float>(p) : INFINITY;
  for (const Vec2 v : motion_vectors(camera_at(0.123f), camera_at(0.123f), depth)) ASSERT_EQ(v, Vec2());
}

TEST(Motion, IsTheWayBackOnTheScreen) {
  Buffer<float> depth(kWidth * kHeight);
  depth.fill(1);
  depth[0] = 2, depth[1] = INFINITY;
  // The camera went 3 pixels' worth to the right: things come from the right.
  const Buffer<Vec2> motion = motion_vectors(camera_at(3 * meters_per_pixel(2)), camera_at(0), depth);
  EXPECT_NEAR(motion[0].x, 3, 1e-3f);
  EXPECT_NEAR(motion[0].y, 0, 1e-3f);
  EXPECT_NEAR(motion[1].x, 0, 1e-3f) << "infinitely far";
  EXPECT_NEAR(motion[2].x, 6, 1e-3f) << "half as far";
}

TEST(Motion, BehindTheOtherCameraIsOutside) {
  Camera ahead;
  ahead.eye = {0, 0, -5};
  ahead.target = {0, 0, -6};
  Buffer<float> depth(kWidth * kHeight);
  depth.fill(1);
  for (const Vec2 v : motion_vectors(camera_at(0), make_camera_view(ahead, kWidth, kHeight), depth))
    ASSERT_EQ(v, Vec2(2 * kWidth, 2 * kHeight));
}

TEST(HistoryColors, GoToYCoCgAndBack) {
  Rng rng(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 c(10 * rng.uniform(), rng.uniform(), rng.uniform());
    const Vec3 back = kernel::filter_from_ycocg(kernel::filter_to_ycocg(c));
    EXPECT_NEAR(back.x, c.x, 2e-6f);
    EXPECT_NEAR(back.y, c.y, 2e-6f);
    EXPECT_NEAR(back.z, c.z, 2e-6f);
  }
  const Vec3 gray = kernel::filter_to_ycocg(Vec3(0.4f, 0.4f, 0.4f));
  EXPECT_NEAR(gray.x, 0.4f, 1e-7f);
  EXPECT_NEAR(gray.y, 0, 1e-7f);
  EXPECT_NEAR(gray.z, 0, 1e-7f);
}

// The largest share of the way that stays inside, by trying.
TEST(HistoryColors, AreClippedOntoTheBox) {
  Rng rng(2, 0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 offset(4 * rng.uniform() - 2, 4 * rng.uniform() - 2, 4 * rng.uniform() - 2);
    const Vec3 half(rng.uniform(), rng.uniform(), rng.uniform());
    float share = 1;
    const auto outside = [&](Vec3 c) { return std::fabs(c.x) > half.x || std::fabs(c.y) > half.y || std::fabs(c.z) > half.z; };
    while (share > 0 && outside(offset * share)) share -= 1e-4f;
    EXPECT_NEAR(kernel::filter_clip_share(offset, half), share, 2e-4f);
  }
  EXPECT_EQ(kernel::filter_clip_share(Vec3(0, 0, 0), Vec3(0, 0, 0)), 1) << "a flat box keeps what lies on it";
}

}  // namespace
}  // namespace pelage
