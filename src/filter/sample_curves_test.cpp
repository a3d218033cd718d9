// Strands that are made from samples, against the strands that were sampled.
#include "filter/sample_curves.h"

#include <gtest/gtest.h>
#include <pelage/error.h>

#include <cmath>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

HairSamples no_samples(int width, int height) {
  HairSamples s;
  s.width = width, s.height = height;
  const auto n = static_cast<std::size_t>(width * height);
  for (Buffer<float>* b : {&s.alpha, &s.depth, &s.strand, &s.u}) b->resize(n), b->fill(0);
  for (Buffer<Vec3>* b : {&s.color, &s.position, &s.tangent}) b->resize(n), b->fill({});
  return s;
}

/// A sample at a place of the screen, with its direction there.
std::size_t add_on_screen(HairSamples& s, float strand, float u, Vec2 at, Vec2 along, float depth = 1) {
  const auto p = static_cast<std::size_t>(std::floor(at.y)) * static_cast<std::size_t>(s.width) +
                 static_cast<std::size_t>(std::floor(at.x));
  s.strand[p] = strand, s.u[p] = u, s.depth[p] = depth;
  s.position[p] = {at.x, at.y, 0}, s.tangent[p] = {along.x, along.y, 0};
  return p;
}

CurvePoint point_at(const SampleCurves& curves, std::uint32_t primitive, float u, bool& seen) {
  StrandCurve curve = curves.curve_of(primitive);
  CurvePoint point;
  seen = curves.at(curve, u * curve.end, point);
  return point;
}

constexpr float kRadius = 20;
Vec2 on_circle(float angle) { return {32 + kRadius * std::cos(angle), 32 + kRadius * std::sin(angle)}; }

/// Half a circle of samples 30° apart, u = 0 … 1; `sign` of the tangent of each.
template <class Sign>
HairSamples half_circle(const Sign& sign) {
  HairSamples s = no_samples(64, 64);
  for (int i = 0; i <= 6; ++i) {
    const float angle = 0.5235988f * static_cast<float>(i);
    add_on_screen(s, 1, static_cast<float>(i) / 6, on_circle(angle), Vec2(-std::sin(angle), std::cos(angle)) * sign(i));
  }
  return s;
}

/// Pixels between the curve and where the circle is after u · `turn`.
float worst_off_circle(const SampleCurves& curves, float turn) {
  float most = 0;
  for (float u = 0; u <= 1; u += 0.01f) {
    bool seen = false;
    const CurvePoint point = point_at(curves, 0, u, seen);
    EXPECT_TRUE(seen);
    most = std::max(most, length(point.screen - on_circle(turn * u)));
  }
  return most;
}

// Bézier's approximation of an arc of 30° is off by less than 1e-6 of the radius, and its parameter hardly from the angle.
TEST(SampleCurves, JoinSamplesOfACircleByItsArc) {
  const SampleCurves curves(half_circle([](int) { return 1.f; }), {});
  EXPECT_LT(worst_off_circle(curves, 3.1415927f), 1e-3f * kRadius);
  bool seen = false;
  const CurvePoint top = point_at(curves, 0, 0.5f, seen);
  EXPECT_LT(length(top.screen - on_circle(1.5707963f)), 1e-3f);
  EXPECT_LT(length(top.tangent - Vec2(-1, 0)), 1e-3f);
  EXPECT_FALSE(curves.camera_error());
}

// All against u, or each as it likes: where samples are close their chords tell.
TEST(SampleCurves, TurnTangentsThatPointToTheRoot) {
  const auto dense = [](auto sign) {
    HairSamples s = no_samples(64, 64);
    for (int i = 0; i <= 30; ++i) {
      const float angle = 0.1f * static_cast<float>(i);
      add_on_screen(s, 1, static_cast<float>(i) / 30, on_circle(angle), Vec2(-std::sin(angle), std::cos(angle)) * sign(i));
    }
    return SampleCurves(s, {});
  };
  EXPECT_LT(worst_off_circle(dense([](int) { return 1.f; }), 3), 0.03f);
  EXPECT_LT(worst_off_circle(dense([](int) { return -0.3f; }), 3), 0.03f);
  EXPECT_LT(worst_off_circle(dense([](int i) { return i % 3 == 0 ? -2.f : 1.f; }), 3), 0.03f);
}

TEST(SampleCurves, GoOnStraightAsFarAsTheyReachAndTheStrandGoes) {
  HairSamples s = no_samples(64, 64);
  add_on_screen(s, 1, 0.4f, {20.5f, 10.5f}, {1, 0}), add_on_screen(s, 1, 0.6f, {30.5f, 10.5f}, {1, 0});  // 50 pixels a u
  const SampleCurves near(s, {.reach = 8}), far(s, {.reach = 100});
  bool seen = false;
  EXPECT_NEAR(point_at(near, 0, 0.7f, seen).screen.x, 35.5f, 1e-3f);
  EXPECT_TRUE(seen);
  EXPECT_NEAR(point_at(near, 0, 0.3f, seen).screen.x, 15.5f, 1e-3f);
  EXPECT_TRUE(seen);
  for (const float u : {0.2f, 0.8f}) {
    point_at(near, 0, u, seen);
    EXPECT_FALSE(seen) << u;
  }
  EXPECT_NEAR(point_at(far, 0, 1, seen).screen.x, 50.5f, 1e-3f);
  EXPECT_TRUE(seen);
  StrandCurve curve = far.curve_of(0);
  EXPECT_EQ(curve.end, 5.f);  // 50 pixels, ten a primitive
  EXPECT_NEAR(far.step(curve, 2.5f, 1, 1), 0.1f, 1e-4f);
}

// A strand of one sample is taken to be as long as the others.
TEST(SampleCurves, OneSampleIsAStrandToo) {
  HairSamples s = no_samples(64, 64);
  add_on_screen(s, 1, 0, {10.5f, 10.5f}, {1, 0}), add_on_screen(s, 1, 1, {50.5f, 10.5f}, {1, 0});
  const std::size_t lone = add_on_screen(s, 2, 0.5f, {30.5f, 30.5f}, {0, 1});
  SampleCurves curves(s, {.reach = 1000});
  ASSERT_EQ(curves.strand_count(), 2u);
  const std::uint32_t primitive = curves.take_visibility()[lone].primitive();
  bool seen = false;
  EXPECT_LT(length(point_at(curves, primitive, 1, seen).screen - Vec2(30.5f, 50.5f)), 1e-3f);
  EXPECT_TRUE(seen);
}

TEST(SampleCurves, SamplesSideBySideAreOnePlace) {
  HairSamples s = no_samples(64, 64);
  add_on_screen(s, 1, 0.1f, {10.5f, 10.5f}, {1, 0}), add_on_screen(s, 1, 0.1001f, {10.5f, 11.5f}, {1, 0});
  add_on_screen(s, 1, 0.5f, {30.5f, 11.5f}, {1, 0}), add_on_screen(s, 1, 0.5001f, {30.5f, 10.5f}, {1, 0});
  const SampleCurves curves(s, {});
  for (const float u : {0.1f, 0.2f, 0.4f, 0.5f}) {
    bool seen = false;
    EXPECT_NEAR(point_at(curves, 0, u, seen).screen.y, 11, 0.01f) << u;
    EXPECT_TRUE(seen);
  }
}

/// Samples of `share` of the pixels that the strands of a scene pass, places in the world; and what was sampled.
struct Sampled {
  Scene scene = test::scene_of(test::helices(40, 24, 0.006f));
  CameraView view = make_camera_view(scene.camera, 320, 240);
  GroomCurves groom{scene, view};
  HairSamples samples = no_samples(320, 240);
  std::vector<std::pair<std::size_t, float>> places;  // pixel, s

  explicit Sampled(float share) {
    samples.on_screen = false;
    Rng rng(9, 9);
    const SegmentNumbering spans = number_spans(scene);
    for (std::uint32_t strand = 0; strand < 40; ++strand) {
      StrandCurve curve = groom.curve_of(24 * strand);
      for (float s = 0; s < curve.end; s += 0.05f) {
        if (rng.uniform() > share) continue;
        CurvePoint point;
        if (!groom.at(curve, s, point) ||
            !(point.screen.x >= 0 && point.screen.x < 320 && point.screen.y >= 0 && point.screen.y < 240))
          continue;
        const auto p = static_cast<std::size_t>(point.screen.y) * 320 + static_cast<std::size_t>(point.screen.x);
        if (samples.strand[p] != 0) continue;
        const auto span = static_cast<std::uint32_t>(s);
        const StrandSurface at = surface_at(scene, spans, {0, strand, span, 0}, s - static_cast<float>(span));
        samples.strand[p] = static_cast<float>(strand + 1), samples.u[p] = at.u, samples.depth[p] = point.depth;
        samples.position[p] = at.position, samples.tangent[p] = at.tangent;
        places.emplace_back(p, s);
      }
    }
  }
};

TEST(SampleCurves, FollowTheGroomThatWasSampled) {
  const Sampled all(0.25f);
  SampleCurves curves(all.samples, {});
  ASSERT_TRUE(curves.camera_error());
  EXPECT_LT(*curves.camera_error(), 0.5f);  // the mean of a pixel's places is 0.41 from its middle
  const Buffer<VisibilitySample> visibility = curves.take_visibility();
  std::size_t looked = 0, close = 0;
  for (const auto& [pixel, s] : all.places) {
    const VisibilitySample& v = visibility[pixel];
    ASSERT_TRUE(v.is_hair());
    StrandCurve made = curves.curve_of(v.primitive()),
                real = all.groom.curve_of(24 * (static_cast<std::uint32_t>(all.samples.strand[pixel]) - 1));
    CurvePoint there, here;
    const float at = static_cast<float>(v.primitive() - made.first_primitive) + v.t;
    ASSERT_TRUE(curves.at(made, at, there));
    ASSERT_TRUE(all.groom.at(real, s, here));
    EXPECT_LT(length(there.screen - here.screen), 1);
    if (length(here.tangent) > 0) {
      EXPECT_GT(dot(v.tangent(), here.tangent), 0.99f);
    }
    // Halfway to the next control point.
    const float ahead = std::min(s + 0.5f, real.end);
    if (!curves.at(made, ahead / real.end * made.end, there)) continue;
    ASSERT_TRUE(all.groom.at(real, ahead, here));
    ++looked, close += length(there.screen - here.screen) < 0.5f && std::fabs(there.depth - here.depth) < 1e-3f;
  }
  EXPECT_GT(looked, 1000u);
  EXPECT_GT(static_cast<double>(close), 0.95 * static_cast<double>(looked));
}

TEST(SampleCurves, RefusePlacesThatNoCameraSeesThere) {
  Sampled all(0.25f);
  Rng rng(1, 8);
  for (const auto& [pixel, s] : all.places) all.samples.position[pixel] = {rng.uniform(), rng.uniform(), rng.uniform()};
  try {
    SampleCurves(all.samples, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.place(), "position");
  }
}

TEST(SampleCurves, NothingIsNothing) {
  SampleCurves curves(no_samples(5, 3), {});
  EXPECT_EQ(curves.strand_count(), 0u);
  for (const VisibilitySample& v : curves.take_visibility()) EXPECT_FALSE(v.is_hair());
}

// Values at the limits of floats end in "not seen", never in a crash.
TEST(SampleCurves, SurviveStrangePlaces) {
  for (const float size : {0.f, 1e-30f, 1e30f}) {
    HairSamples s = no_samples(32, 32);
    for (int i = 0; i < 8; ++i) {
      const auto p = add_on_screen(s, 1, static_cast<float>(i % 4) / 3, {2.5f + 3 * static_cast<float>(i), 5.5f}, {0, 0});
      s.position[p] = {size * static_cast<float>(i), -size, size}, s.tangent[p] = {size, 0, size};
    }
    const SampleCurves curves(s, {});
    for (float u = 0; u <= 1; u += 0.05f) {
      bool seen = false;
      const CurvePoint point = point_at(curves, 0, u, seen);
      EXPECT_TRUE(!seen || (std::isfinite(point.screen.x) && std::isfinite(point.screen.y)));
    }
  }
}

}  // namespace
}  // namespace pelage
