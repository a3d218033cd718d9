// What follows the guides follows them.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/lod.h>

#include <cmath>

#include "core/rng.h"
#include "lod/rotation.h"

namespace pelage {
namespace {

StrandSet groom(HairStyle style, int strands) {
  GrowSettings s = grow_defaults(style);
  s.strands = strands, s.points = 24;
  return grow(s, mannequin_head());
}

/// A turn about an axis that is none of the coordinates', and a shift.
Vec3 moved_rigidly(Vec3 p) {
  const Rotation turn{std::cos(0.6f), normalize(Vec3(1, -2, 0.5f)) * std::sin(0.6f)};
  return turn(p) + Vec3(0.3f, -0.1f, 0.2f);
}

class Skinning : public testing::TestWithParam<HairStyle> {
 protected:
  const StrandSet strands_ = groom(GetParam(), 1500);
  const LodHierarchy lod_ = build_lod(strands_, {.levels = 3, .guides = 24});
};

TEST_P(Skinning, GuidesAtRestLeaveEverything) {
  ThickHairPose pose;
  pose_hairs(lod_, lod_.guides, pose);
  for (std::size_t i = 0; i < lod_.centers.size(); ++i) {
    ASSERT_LT(length(pose.centers[i] - lod_.centers[i]), 1e-6f) << i;
    ASSERT_LT(length(pose.major[i] - lod_.major[i]), 1e-7f) << i;
    ASSERT_LT(length(pose.minor[i] - lod_.minor[i]), 1e-7f) << i;
  }
  const StrandSet posed = pose_strands(lod_, strands_, lod_.guides);
  for (std::size_t i = 0; i < strands_.points.size(); ++i) ASSERT_LT(length(posed.points[i] - strands_.points[i]), 1e-6f) << i;
}

TEST_P(Skinning, ARigidMotionMovesEverythingAlike) {
  std::vector<Vec3> guides;
  for (const Vec3 p : lod_.guides) guides.push_back(moved_rigidly(p));
  ThickHairPose pose;
  pose_hairs(lod_, guides, pose);
  const Vec3 origin = moved_rigidly({});
  for (std::size_t i = 0; i < lod_.centers.size(); ++i) {
    ASSERT_LT(length(pose.centers[i] - moved_rigidly(lod_.centers[i])), 1e-6f) << i;
    ASSERT_LT(length(pose.major[i] - (moved_rigidly(lod_.major[i]) - origin)), 1e-6f) << i;
    ASSERT_LT(length(pose.minor[i] - (moved_rigidly(lod_.minor[i]) - origin)), 1e-6f) << i;
  }
  const StrandSet posed = pose_strands(lod_, strands_, guides);
  for (std::size_t i = 0; i < strands_.points.size(); ++i)
    ASSERT_LT(length(posed.points[i] - moved_rigidly(strands_.points[i])), 1e-6f) << i;
}

INSTANTIATE_TEST_SUITE_P(Styles, Skinning, testing::Values(HairStyle::kStraight, HairStyle::kCurly, HairStyle::kAfro));

/// Guides bend away: thick hairs stay where the strands of their cluster are.
TEST(SkinningBend, CentersStayTheMeanOfTheirStrands) {
  const StrandSet strands = groom(HairStyle::kWavy, 1500);
  const LodHierarchy lod = build_lod(strands, {.levels = 3, .guides = 24});
  std::vector<Vec3> guides = lod.guides;
  for (std::size_t g = 0; g < lod.guide_count(); ++g) {
    const float swing = 0.02f + 0.02f * Rng(3, static_cast<std::uint32_t>(g)).uniform();
    for (std::size_t k = 0; k < LodHierarchy::kPoints; ++k) {
      const float u = static_cast<float>(k) / 15;
      guides[g * LodHierarchy::kPoints + k] += Vec3(swing * u * u, 0, 0);
    }
  }
  ThickHairPose pose;
  pose_hairs(lod, guides, pose);
  // The same clusters in the posed groom: their mean tips.
  const StrandSet posed = pose_strands(lod, strands, guides);
  double most = 0, shift = 0;
  for (std::size_t h = 0; h < lod.hair_count(); ++h) {
    Vec3 tip;
    for (std::uint32_t i = 0; i < lod.hairs[h].fibers; ++i)
      tip += posed.points[posed.offsets[lod.order[lod.hairs[h].first_strand + i] + 1] - 1];
    tip = tip / static_cast<float>(lod.hairs[h].fibers);
    const std::size_t last = h * LodHierarchy::kPoints + LodHierarchy::kPoints - 1;
    most = std::max(most, static_cast<double>(length(pose.centers[last] - tip)));
    shift = std::max(shift, static_cast<double>(length(pose.centers[last] - lod.centers[last])));
  }
  EXPECT_GT(shift, 0.02);
  EXPECT_LT(most, 1e-5);
}

TEST(SkinningSpread, SectionsGrowWhereGuidesPart) {
  const StrandSet strands = groom(HairStyle::kStraight, 1500);
  const LodHierarchy lod = build_lod(strands, {.levels = 1, .guides = 24});
  std::vector<Vec3> guides = lod.guides;
  for (Vec3& p : guides) p = p * 2.f;
  ThickHairPose pose;
  pose_hairs(lod, guides, pose);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < lod.centers.size(); ++i)
    before += static_cast<double>(length(lod.major[i])), after += static_cast<double>(length(pose.major[i]));
  EXPECT_GT(after, 1.2 * before);
  EXPECT_LT(after, 2.05 * before);
}

TEST(Skinning, MistakesAreNamed) {
  const StrandSet strands = groom(HairStyle::kStraight, 100);
  const LodHierarchy lod = build_lod(strands, {.levels = 1, .guides = 8});
  ThickHairPose pose;
  EXPECT_THROW(pose_hairs(lod, std::span(lod.guides).first(16), pose), Error);
  EXPECT_THROW(pose_strands(lod, groom(HairStyle::kStraight, 99), lod.guides), Error);
}

TEST(BestRotation, IsFoundFromAnyPoints) {
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    Rng random(11, trial);
    const auto point = [&] { return Vec3(random.normal(), random.normal(), random.normal()); };
    const float angle = 3.1f * random.uniform();
    const Rotation turn{std::cos(0.5f * angle), normalize(point()) * std::sin(0.5f * angle)};
    std::vector<Vec3> rest, moved;
    const bool flat = trial % 2;
    for (int i = 0; i < 9; ++i) {
      Vec3 p = point();
      if (flat) p.z = 0;
      rest.push_back(p), moved.push_back(turn(p) + Vec3(1, 2, 3));
    }
    const Rotation found = best_rotation(rest, moved);
    for (const Vec3 p : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) EXPECT_LT(length(found(p) - turn(p)), 1e-5f) << trial;
  }
}

TEST(BestRotation, WhatALineLeavesOpenIsNotTurned) {
  const std::vector<Vec3> line = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}, across = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const Rotation none = best_rotation(line, line), quarter = best_rotation(line, across);
  EXPECT_LT(length(none({1, 0, 0}) - Vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(length(quarter({0, 1, 0}) - Vec3(1, 0, 0)), 1e-5f);
  EXPECT_LT(length(quarter({0, 0, 1}) - Vec3(0, 0, 1)), 1e-5f);  // the least turn that does it
}

}  // namespace
}  // namespace pelage
