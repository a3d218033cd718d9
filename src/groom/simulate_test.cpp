// Guides in motion: at rest, settled, shaken, and beside a slow step in double precision.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>
#include <pelage/simulate.h>

#include <algorithm>
#include <cmath>

#include "groom/head_grid.h"
#include "groom/head_motion.h"
#include "groom/mannequin.h"
#include "groom/rod.h"
#include "groom/slow_rod.h"
#include "kit/guides_kit.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr float kLength = 0.24f;

Vec3 tip(const GuideAnimation& a, std::size_t frame, std::size_t guide = 0) {
  return a.guides_at(frame)[(guide + 1) * kPoints - 1];
}

float farthest_from(const GuideAnimation& a, std::size_t frame, const std::vector<Vec3>& guides) {
  float most = 0;
  for (std::size_t i = 0; i < guides.size(); ++i) most = std::max(most, length(a.guides_at(frame)[i] - guides[i]));
  return most;
}

/// Largest length of a piece over its length at rest, less one.
float most_stretch(const LodHierarchy& lod, std::span<const Vec3> guides) {
  float most = 0;
  for (std::size_t i = 0; i + 1 < guides.size(); ++i)
    if (i % kPoints + 1 < kPoints)
      most = std::max(most, length(guides[i + 1] - guides[i]) / length(lod.guides[i + 1] - lod.guides[i]) - 1);
  return most;
}

SimulationSettings seconds(float time, float rate = 24) {
  SimulationSettings s;
  s.frame_rate = rate, s.frames = static_cast<std::uint32_t>(std::lround(time * rate)) + 1;
  return s;
}

LodHierarchy grown(HairStyle style) {
  GrowSettings s = grow_defaults(style);
  s.strands = 400, s.points = 24;
  return build_lod(grow(s, mannequin_head()), {.levels = 1, .guides = 24});
}

HeadMotion shaking(float metres, double period, double time) {
  HeadMotion motion;
  for (int i = 0; static_cast<double>(i) * period / 2 <= time + period; ++i) {
    const float side = i % 2 == 0 ? -0.5f : 0.5f;
    const float half = 0.6f * side;
    motion.keys.push_back({static_cast<double>(i) * period / 2,
                           {metres * side, 0.3f * metres * side, 0},
                           {std::sin(half), 0, 0, std::cos(half)}});
  }
  return motion;
}

// --- At rest -----------------------------------------------------------------------------------------------------------

TEST(Simulate, WithoutForcesNothingMoves) {
  const LodHierarchy lod = grown(HairStyle::kCurly);
  SimulationSettings s = seconds(2);
  s.gravity = {};
  const GuideAnimation a = simulate(lod, s);
  EXPECT_LT(farthest_from(a, a.frames() - 1, lod.guides), 1e-6f);
}

TEST(Simulate, AtRestAGroomStaysAsStyled) {
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kCurly, HairStyle::kAfro, HairStyle::kPonytail}) {
    const LodHierarchy lod = grown(style);
    const GuideAnimation a = simulate(lod, seconds(3), {}, make_head_shape(mannequin_head()));
    EXPECT_LT(farthest_from(a, a.frames() - 1, lod.guides), 2e-5f) << static_cast<int>(style);
  }
}

TEST(Simulate, ShakenHairComesBackToItsStyle) {
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kAfro}) {
    const LodHierarchy lod = grown(style);
    HeadMotion motion = head_motion("nod", 2, neck_of(lod));
    motion.keys.back().rotation = {0, 0, 0, 1};
    const GuideAnimation a = simulate(lod, seconds(10), motion, make_head_shape(mannequin_head()));
    EXPECT_GT(farthest_from(a, 12, lod.guides), 0.01f);
    double sum = 0;
    for (std::size_t i = 0; i < lod.guides.size(); ++i)
      sum += static_cast<double>(length(a.guides_at(a.frames() - 1)[i] - lod.guides[i]));
    EXPECT_LT(sum / static_cast<double>(lod.guides.size()), 0.01) << static_cast<int>(style);
  }
}

// --- Physics -----------------------------------------------------------------------------------------------------------

TEST(Simulate, AStepIsThatOfTheSlowRod) {
  for (const bool curled : {false, true}) {
    const std::vector<Vec3> rest = kit::guide({0, 0, 0}, curled ? 0.012f : 0.f, kLength);
    SimulationSettings s;
    s.support = 0.3f, s.drag = 3, s.longest_step = 2e-3f;
    groom::Rod rod(rest.data(), s, nullptr);
    slow::Rod reference(rest, s);
    groom::RodStep step;
    step.seconds = 2e-3f;
    for (int i = 0; i < 40; ++i) {
      step.head_before = step.head;
      const float angle = 0.01f * static_cast<float>(i + 1);
      step.head = {{std::cos(angle), Vec3(std::sin(angle), 0, 0)}, {0.002f * static_cast<float>(i), 0, 0}};
      rod.step(step), reference.step(step);
      const float allowed = i == 0 ? 2e-7f : 4e-5f;  // roundings of forty steps
      for (std::size_t j = 0; j < kPoints; ++j)
        ASSERT_LT(length(rod.points()[j] - reference.point(j)), allowed) << i << ", " << j;
    }
    EXPECT_GT(length(rod.points()[kPoints - 1] - rest.back()), 0.02f);
  }
}

TEST(Simulate, AFreePendulumGainsNoEnergy) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0, kLength)});
  SimulationSettings s = seconds(2, 240);
  s.gravity = {0, 0, -9.81f};  // aside from where it hangs
  s.support = s.damping = s.drag = s.shape_frequency = 0;
  const GuideAnimation a = simulate(lod, s);
  const auto energy = [&](std::size_t f) {
    double sum = 0;
    for (std::size_t j = 2; j < kPoints; ++j) {
      const Vec3 x = a.guides_at(f)[j], v = (a.guides_at(f)[j] - a.guides_at(f - 1)[j]) * s.frame_rate;
      sum += 0.5 * static_cast<double>(dot(v, v)) - static_cast<double>(dot(s.gravity, x - lod.guides[j]));
    }
    return sum;
  };
  double most = 0;
  for (std::size_t f = 2; f < a.frames(); ++f) most = std::max(most, energy(f));
  EXPECT_LT(most, 0.02 * 9.81 * static_cast<double>(kLength) * kPoints);
  EXPECT_GT(length(tip(a, 40) - lod.guides.back()), 0.1f);
}

TEST(Simulate, SoftHairWithoutSupportHangs) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0, kLength)});
  SimulationSettings s = seconds(8);
  s.gravity = {9.81f, 0, 0}, s.support = 0, s.shape_frequency = 0, s.bend_stiffness = 1e-6f;
  const GuideAnimation a = simulate(lod, s);
  const Vec3 end = tip(a, a.frames() - 1), start = lod.guides[1];
  EXPECT_GT(end.x - start.x, 0.95f * length(lod.guides.back() - start));
  EXPECT_LT(most_stretch(lod, a.guides_at(a.frames() - 1)), 1e-3f);
}

TEST(Simulate, SettlesAlikeAtAnyFrameRateAndStep) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0.01f, kLength), kit::guide({0.02f, 0, 0}, 0, kLength)});
  const auto settled = [&](float rate, float step) {
    SimulationSettings s = seconds(6, rate);
    s.gravity = {7, -7, 0}, s.longest_step = step, s.support = 0.5f;
    const GuideAnimation a = simulate(lod, s);
    return std::vector<Vec3>(a.guides_at(a.frames() - 1).begin(), a.guides_at(a.frames() - 1).end());
  };
  const std::vector<Vec3> reference = settled(24, 2.5e-4f);
  EXPECT_GT(length(reference.back() - lod.guides.back()), 0.03f);
  for (const auto& [rate, step] : {std::pair(24.f, 1e-3f), {96.f, 1e-3f}, {240.f, 1e-3f}, {24.f, 4e-3f}}) {
    const std::vector<Vec3> end = settled(rate, step);
    float most = 0;
    for (std::size_t i = 0; i < end.size(); ++i) most = std::max(most, length(end[i] - reference[i]));
    EXPECT_LT(most, step > 2e-3f ? 2e-3f : 1e-3f) << rate << " frames a second, " << step;
  }
}

TEST(Simulate, MovesAlikeAtAnyFrameRate) {
  const LodHierarchy lod = grown(HairStyle::kStraight);
  const HeadMotion motion = head_motion("turn", 1, neck_of(lod));
  const GuideAnimation slow = simulate(lod, seconds(1, 24), motion), fast = simulate(lod, seconds(1, 96), motion);
  for (std::size_t f = 0; f < slow.frames(); f += 6) {
    double sum = 0;
    for (std::size_t i = 0; i < lod.guides.size(); ++i)
      sum += static_cast<double>(length(slow.guides_at(f)[i] - fast.guides_at(4 * f)[i]));
    EXPECT_LT(sum / static_cast<double>(lod.guides.size()), 1e-3) << f;
  }
}

TEST(Simulate, WindBlowsHairItsWay) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0, kLength)});
  SimulationSettings s = seconds(4);
  s.wind = {3, 0, 0};
  EXPECT_GT(tip(simulate(lod, s), 96).x, 0.03f);
  s.wind = {-3, 0, 0};
  EXPECT_LT(tip(simulate(lod, s), 96).x, -0.03f);
}

TEST(Simulate, GustsVaryAroundTheWind) {
  SimulationSettings s;
  s.wind = {0, 0, 5}, s.gusts = 0.5f;
  Vec3 sum;
  float least = INFINITY, most = 0;
  constexpr int kTimes = 4000;
  for (int i = 0; i < kTimes; ++i) {
    const Vec3 w = groom::wind_at(s, {0.1f, 0.2f, 0.3f}, 0.05 * i);
    sum += w, least = std::min(least, w.z), most = std::max(most, w.z);
  }
  EXPECT_NEAR(sum.z / kTimes, 5, 0.15f);
  EXPECT_NEAR(sum.x / kTimes, 0, 0.15f);
  EXPECT_LT(least, 4);
  EXPECT_GT(most, 6);
  EXPECT_EQ(groom::wind_at(s, {1, 2, 3}, 7), groom::wind_at(s, {1, 2, 3}, 7));
}

// --- Whatever happens --------------------------------------------------------------------------------------------------

class Violence : public testing::TestWithParam<float> {};

TEST_P(Violence, NothingExplodesAndHairStaysOutside) {
  const LodHierarchy lod = grown(HairStyle::kStraight);
  const auto head = make_head_shape(mannequin_head());
  SimulationSettings s = seconds(1.5f, GetParam());
  s.wind = {20, 0, -10}, s.gusts = 2;
  const HeadMotion motion = shaking(2, 0.25, 1);  // accelerations of a thousand m/s²
  const GuideAnimation a = simulate(lod, s, motion, head);
  std::size_t inside = 0, wedged = 0;
  for (std::size_t f = 0; f < a.frames(); ++f) {
    const float stretch = most_stretch(lod, a.guides_at(f));
    ASSERT_LT(stretch, 0.35f) << f;  // wedged between chin, neck and shoulder
    wedged += stretch > 1.01f * s.most_stretch ? 1 : 0;
    const Rigid pose = groom::head_pose(motion, static_cast<double>(f) / static_cast<double>(s.frame_rate));
    for (std::size_t i = 0; i < lod.guides.size(); ++i) {
      const Vec3 p = a.guides_at(f)[i];
      ASSERT_TRUE(is_finite(p));
      const float rest = groom::sample_distance(head->grid, lod.guides[i]).distance;
      if (i % kPoints >= 2 && groom::sample_distance(head->grid, undo(pose, p)).distance < std::min(0.f, rest) - 5e-4f)
        ++inside;
    }
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_LT(5 * wedged, 2 * a.frames());
}

INSTANTIATE_TEST_SUITE_P(FrameRates, Violence, testing::Values(24.f, 60.f, 240.f));

TEST(Simulate, HairFallsOnTheHeadAndStaysOutside) {
  const LodHierarchy lod = grown(HairStyle::kAfro);
  const auto head = make_head_shape(mannequin_head());
  SimulationSettings s = seconds(3);
  s.support = 0, s.shape_frequency = 0, s.bend_stiffness = 1e-6f;
  const GuideAnimation a = simulate(lod, s, {}, head);
  EXPECT_GT(farthest_from(a, a.frames() - 1, lod.guides), 0.02f);
  for (std::size_t i = 0; i < lod.guides.size(); ++i) {
    const float rest = std::min(s.clearance, groom::sample_distance(head->grid, lod.guides[i]).distance);
    EXPECT_GT(groom::sample_distance(head->grid, a.guides_at(a.frames() - 1)[i]).distance, rest - 3e-4f) << i;
  }
}

TEST(Simulate, TheSameBitsForAnyNumberOfThreads) {
  const LodHierarchy lod = grown(HairStyle::kWavy);
  SimulationSettings s = seconds(0.5f);
  s.wind = {4, 0, 0};
  const HeadMotion motion = head_motion("nod", 0.5, neck_of(lod));
  set_thread_count(1);
  const GuideAnimation one = simulate(lod, s, motion, make_head_shape(mannequin_head()));
  set_thread_count(4);
  const GuideAnimation four = simulate(lod, s, motion, make_head_shape(mannequin_head()));
  set_thread_count(0);
  EXPECT_EQ(one.guides, four.guides);
}

TEST(Simulate, CoincidentPointsGoWithTheHead) {
  const LodHierarchy lod = kit::guides_only({std::vector<Vec3>(kPoints, Vec3(0, 0.1f, 0))});
  const HeadMotion motion = head_motion("nod", 1, {});
  const GuideAnimation a = simulate(lod, seconds(1), motion);
  const Affine head = head_at(motion, 1);
  EXPECT_LT(length(tip(a, 24) - transform_point(head, {0, 0.1f, 0})), 1e-6f);
}

TEST(Simulate, RootsGoWithTheHead) {
  const LodHierarchy lod = grown(HairStyle::kStraight);
  const HeadMotion motion = head_motion("walk", 1, neck_of(lod));
  const GuideAnimation a = simulate(lod, seconds(1), motion);
  for (const std::size_t f : {7u, 24u})
    for (std::size_t g = 0; g < lod.guide_count(); ++g)
      for (std::size_t j = 0; j < 2; ++j)
        ASSERT_LT(length(a.guides_at(f)[g * kPoints + j] - transform_point(a.head[f], lod.guides[g * kPoints + j])), 1e-6f);
  validate(a, lod.guide_count(), "test");
}

TEST(Simulate, PrerollLetsWindBlowFirst) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0, kLength)});
  SimulationSettings s = seconds(0.1f);
  s.wind = {3, 0, 0};
  EXPECT_EQ(simulate(lod, s).guides_at(0).back(), lod.guides.back());
  s.preroll = 2;
  EXPECT_GT(tip(simulate(lod, s), 0).x, 0.03f);
}

TEST(Simulate, MistakesAreNamed) {
  const LodHierarchy lod = kit::guides_only({kit::guide({0, 0, 0}, 0, kLength)});
  const auto refusal = [&](const SimulationSettings& s, const HeadMotion& motion = {}) -> std::string {
    try {
      simulate(lod, s, motion);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  SimulationSettings s;
  s.frame_rate = 0;
  EXPECT_THAT(refusal(s), testing::HasSubstr("frame_rate"));
  s = {}, s.wind = {NAN, 0, 0};
  EXPECT_THAT(refusal(s), testing::HasSubstr("wind"));
  s = {}, s.frames = 0;
  EXPECT_THAT(refusal(s), testing::HasSubstr("frames"));
  s = {}, s.longest_step = 0;
  EXPECT_THAT(refusal(s), testing::HasSubstr("longest_step"));
  EXPECT_THAT(refusal({}, {{}, {{1, {}}, {0, {}}}}), testing::HasSubstr("key 1"));
  EXPECT_THAT(refusal({}, {{}, {{0, {}, {0, 0, 0, 2}}}}), testing::HasSubstr("quaternion"));
  EXPECT_THROW(simulate(LodHierarchy(), {}), Error);
  EXPECT_THROW(head_motion("dance", 1, {}), Error);
  EXPECT_THROW(simulate(lod, {}, {}, nullptr, [](std::string_view, double share) { return share < 0.5; }), Error);
}

}  // namespace
}  // namespace pelage
