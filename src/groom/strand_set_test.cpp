#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/strand_set.h>

#include <cmath>
#include <functional>
#include <limits>

#include "kit/io_kit.h"

namespace pelage {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

// `strands` straight strands of `points` points each.
StrandSet straight(std::size_t strands, std::uint32_t points) {
  StrandSet set;
  set.offsets = {0};
  set.widths = {8e-5f};
  for (std::size_t s = 0; s < strands; ++s) {
    for (std::uint32_t i = 0; i < points; ++i) set.points.emplace_back(static_cast<float>(s), 0.01f * static_cast<float>(i), 0);
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

TEST(StrandSet, RepairLeavesASoundGroomAlone) {
  StrandSet set = kit::full_groom();
  const StrandSet before = set;
  const RepairReport report = repair(set);
  EXPECT_TRUE(report.clean());
  EXPECT_EQ(report.summary(), "no repairs");
  EXPECT_EQ(set.points, before.points);
  EXPECT_EQ(set.offsets, before.offsets);
  EXPECT_EQ(set.strand_id, before.strand_id);
}

TEST(StrandSet, RepairRemovesNonFinitePointsFromTheirStrand) {
  for (const float bad : {kNan, kInf, -kInf, 2 * kMaxCoordinate}) {
    StrandSet set = straight(3, 4);
    set.points[5].y = bad;
    const RepairReport report = repair(set);
    EXPECT_EQ(report.non_finite_points, 1u) << bad;
    EXPECT_EQ(set.offsets, (std::vector<std::uint32_t>{0, 4, 7, 11}));
    EXPECT_EQ(report.dropped_strands(), 0u);
    EXPECT_NO_THROW(validate(set, "groom"));
  }
}

TEST(StrandSet, RepairDropsStrandsOfFewerThanTwoPoints) {
  StrandSet set = straight(3, 4);
  set.offsets = {0, 1, 8, 8, 12};
  const RepairReport report = repair(set);
  EXPECT_EQ(report.short_strands, 2u);
  EXPECT_EQ(report.dropped, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(set.offsets, (std::vector<std::uint32_t>{0, 7, 11}));
  EXPECT_EQ(set.strand_id, (std::vector<std::uint32_t>{1, 3})) << "the others keep their input index as name";
}

TEST(StrandSet, RepairDropsStrandsOfNoLengthAndCountsThemOnce) {
  StrandSet set = straight(2, 4);
  for (std::size_t i = 0; i < 4; ++i) set.points[i] = {1, 2, 3};
  const RepairReport report = repair(set);
  EXPECT_EQ(report.degenerate_strands, 1u);
  EXPECT_EQ(report.zero_length_segments, 0u);
  EXPECT_EQ(report.short_strands, 0u);
  EXPECT_EQ(set.strand_count(), 1u);
}

TEST(StrandSet, RepairRemovesZeroLengthSegments) {
  StrandSet set = straight(1, 5);
  set.points[2] = set.points[1];
  set.points[3] = set.points[1] + Vec3(1e-30f, 0, 0);  // whose square is 0: no direction can be had of it
  const RepairReport report = repair(set);
  EXPECT_EQ(report.zero_length_segments, 2u);
  EXPECT_EQ(set.point_count(), 3u);
}

TEST(StrandSet, RepairMovesEveryAttributeInStep) {
  StrandSet set = kit::full_groom();
  const StrandSet before = set;
  set.points[4] = {kNan, 0, 0};                                // strand 1 loses its root
  for (std::size_t i = 0; i < 4; ++i) set.points[i].x = kInf;  // strand 0 goes
  repair(set);
  ASSERT_EQ(set.offsets, (std::vector<std::uint32_t>{0, 3, 7}));
  EXPECT_EQ(set.points[0], before.points[5]);
  EXPECT_EQ(set.widths[0], before.widths[5]);
  EXPECT_EQ(set.colors[3], before.colors[8]);
  EXPECT_EQ(set.transparency[6], before.transparency[11]);
  EXPECT_EQ(set.root_uv[1], before.root_uv[2]);
  EXPECT_EQ(set.strand_id, (std::vector<std::uint32_t>{before.strand_id[1], before.strand_id[2]}));
  EXPECT_EQ(set.guide_id[0], before.guide_id[1]);
  EXPECT_EQ(set.group[1], before.group[2]);
  EXPECT_NO_THROW(validate(set, "groom"));
}

TEST(StrandSet, RepairMovesStrandColors) {
  StrandSet set = kit::full_groom(false);
  for (std::size_t i = 4; i < 8; ++i) set.points[i].x = kNan;
  const Vec3 last = set.colors[2];
  repair(set);
  ASSERT_EQ(set.colors.size(), 2u);
  EXPECT_EQ(set.colors[1], last);
}

TEST(StrandSet, RepairCutsBezierStrandsToWholeSpans) {
  StrandSet set = straight(3, 8);
  set.basis = CurveBasis::kBezier;
  set.points[8 + 5].x = kNan;   // in the second span
  set.points[16 + 2].x = kNan;  // in the first
  const RepairReport report = repair(set);
  EXPECT_EQ(report.partial_spans, 1u) << "strand 0: 8 points are 7 and one too many";
  EXPECT_EQ(report.non_finite_points, 2u);
  EXPECT_EQ(report.short_strands, 1u);
  EXPECT_EQ(set.offsets, (std::vector<std::uint32_t>{0, 7, 11}));
  EXPECT_NO_THROW(validate(set, "groom"));
}

TEST(StrandSet, RepairKeepsRepeatedBezierPoints) {
  StrandSet set = straight(1, 7);
  set.basis = CurveBasis::kBezier;
  set.points[2] = set.points[3];
  EXPECT_TRUE(repair(set).clean());
  EXPECT_EQ(set.point_count(), 7u);
}

TEST(StrandSet, RepairReplacesBadWidthsByTheStrandsMedian) {
  StrandSet set = straight(2, 5);
  set.widths = {1, 2, 3, kNan, -1, kNan, kNan, kInf, kNan, -5};
  EXPECT_EQ(repair(set).bad_widths, 7u);
  EXPECT_EQ(set.widths[3], 2);
  EXPECT_EQ(set.widths[4], 2);
  for (std::size_t i = 5; i < 10; ++i) EXPECT_EQ(set.widths[i], 2) << "no good one in the strand: that of the groom";
}

TEST(StrandSet, RepairMendsAttributes) {
  StrandSet set = kit::full_groom();
  set.colors[0] = {kNan, 2, -1};
  set.transparency[3] = kInf;
  set.root_uv[1].y = kNan;
  set.guide_id[0] = -7;
  EXPECT_EQ(repair(set).bad_attributes, 4u);
  EXPECT_EQ(set.colors[0], Vec3(0.5f, 1, 0));
  EXPECT_EQ(set.transparency[3], 1);
  EXPECT_EQ(set.guide_id[0], -1);
  EXPECT_NO_THROW(validate(set, "groom"));
}

TEST(StrandSet, RepairCanEmptyAGroom) {
  StrandSet set = straight(2, 3);
  for (Vec3& p : set.points) p.x = kNan;
  const RepairReport report = repair(set);
  EXPECT_EQ(report.dropped_strands(), 2u);
  EXPECT_EQ(set.strand_count(), 0u);
  EXPECT_NO_THROW(validate(set, "groom"));
}

TEST(StrandSet, SummaryNamesEveryCause) {
  RepairReport report;
  report.non_finite_points = 1;
  report.short_strands = 2;
  EXPECT_EQ(report.summary(), "1 non-finite point removed, 2 strands of fewer than two points dropped");
  EXPECT_FALSE(report.clean());
}

TEST(StrandSet, ValidateNamesTheFirstBrokenInvariant) {
  const std::pair<const char*, std::function<void(StrandSet&)>> breakages[] = {
      {"groom: offsets: the first is 1", [](StrandSet& s) { s.offsets[0] = 1; }},
      {"groom: offsets: the last is 11", [](StrandSet& s) { s.offsets[3] = 11; }},
      {"groom: strand 1: its offset lies after",
       [](StrandSet& s) {
         s.offsets = {0, 8, 4, 12};
       }},
      {"groom: strand 0: 1 points", [](StrandSet& s) { s.offsets[1] = 1; }},
      {"groom: widths: 5 entries", [](StrandSet& s) { s.widths.resize(5); }},
      {"groom: widths: none", [](StrandSet& s) { s.widths.clear(); }},
      {"groom: colors: 2 entries", [](StrandSet& s) { s.colors.resize(2); }},
      {"groom: transparency: 3 entries", [](StrandSet& s) { s.transparency.resize(3); }},
      {"groom: root_uv: 1 entries", [](StrandSet& s) { s.root_uv.resize(1); }},
      {"groom: group: 12 entries", [](StrandSet& s) { s.group.resize(12); }},
      {"groom: points[3]: not finite", [](StrandSet& s) { s.points[3].z = kNan; }},
      {"groom: widths[2]:", [](StrandSet& s) { s.widths[2] = -1; }},
      {"groom: colors[1]: not in 0…1", [](StrandSet& s) { s.colors[1].y = 1.5f; }},
      {"groom: transparency[9]", [](StrandSet& s) { s.transparency[9] = kNan; }},
      {"groom: guide_id[1]", [](StrandSet& s) { s.guide_id[1] = -2; }},
      {"groom: strand 0: 3 points, a Bézier",
       [](StrandSet& s) {
         s.basis = CurveBasis::kBezier, s.offsets = {0, 3, 8, 12};
       }},
  };
  for (const auto& [message, breakage] : breakages) {
    StrandSet set = kit::full_groom();
    breakage(set);
    try {
      validate(set, "groom");
      ADD_FAILURE() << "not noticed: " << message;
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).substr(0, std::string(message).size()), message) << e.what();
    }
  }
}

TEST(StrandSet, ValidateAcceptsAnEmptyGroomAndAFullOne) {
  EXPECT_NO_THROW(validate(StrandSet(), "groom"));
  EXPECT_NO_THROW(validate(kit::full_groom(), "groom"));
  EXPECT_NO_THROW(validate(kit::full_groom(false), "groom"));
}

TEST(StrandSet, BoundsAndBytes) {
  EXPECT_TRUE(bounds(StrandSet()).empty());
  const StrandSet set = straight(2, 3);
  EXPECT_EQ(bounds(set).lower, Vec3(0, 0, 0));
  EXPECT_EQ(bounds(set).upper, Vec3(1, 0.02f, 0));
  EXPECT_GE(resident_bytes(set), 6 * sizeof(Vec3) + 3 * sizeof(std::uint32_t) + sizeof(float));
}

}  // namespace
}  // namespace pelage
