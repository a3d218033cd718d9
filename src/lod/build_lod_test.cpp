// The chain of thick hairs: what the slow way makes, and what must hold for any groom.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/lod.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "frame/curve_basis.h"
#include "frame/strand_path.h"
#include "lod/cross_section.h"
#include "lod/guide_hairs.h"
#include "lod/slow_lod.h"
#include "lod/stations.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

StrandSet groom(HairStyle style, int strands, int points = 32) {
  GrowSettings s = grow_defaults(style);
  s.strands = strands, s.points = points;
  return grow(s, mannequin_head());
}

StrandSet of_one_width(StrandSet set) {
  set.widths = {8e-5f};
  return set;
}

class Styles : public testing::TestWithParam<HairStyle> {};
INSTANTIATE_TEST_SUITE_P(LodChain, Styles,
                         testing::Values(HairStyle::kStraight, HairStyle::kWavy, HairStyle::kCurly, HairStyle::kAfro));

TEST_P(Styles, ChainIsThatOfTheSlowWay) {
  const StrandSet set = of_one_width(groom(GetParam(), 2000));
  const LodSettings settings{.levels = 3, .guides = 40, .memory_share = 20};
  const LodHierarchy fast = build_lod(set, settings);
  const slow::Chain chain = slow::build(set, settings);
  ASSERT_EQ(fast.guide_strands, chain.guides);
  ASSERT_EQ(fast.levels(), chain.levels.size());
  for (std::size_t l = 0; l < fast.levels(); ++l) {
    ASSERT_EQ(fast.level(l).size(), chain.levels[l].size()) << "level " << l;
    for (std::size_t h = 0; h < chain.levels[l].size(); ++h) {
      const ThickHair& hair = fast.level(l)[h];
      const auto first = fast.order.begin() + hair.first_strand;
      slow::Strands strands(first, first + hair.fibers), expected = chain.levels[l][h];
      std::sort(strands.begin(), strands.end());
      ASSERT_EQ(strands, expected) << "level " << l << " hair " << h;
    }
  }
}

TEST_P(Styles, StationsAreThoseOfTheSlowFit) {
  const StrandSet set = groom(GetParam(), 200, 64);
  const Stations stations = fit_stations(set, {});
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    const slow::Strand expected = slow::fit(set, s);
    for (std::size_t k = 0; k < kPoints; ++k) ASSERT_LT(length(stations.strand(s)[k] - expected[k]), 2e-6f) << s << " " << k;
    EXPECT_EQ(stations.strand(s)[0], set.points[set.offsets[s]]);
    EXPECT_EQ(stations.strand(s)[kPoints - 1], set.points[set.offsets[s + 1] - 1]);
  }
}

/// Control points of B-splines at x 0…kPoints − 1.
Vec3 on_spline(const Vec3* c, float x) {
  const std::size_t span = std::min(static_cast<std::size_t>(x), kPoints - 2);
  const Vec4 w = basis_weights(CurveBasis::kBSpline, x - static_cast<float>(span));
  const Vec3 before = span > 0 ? c[span - 1] : c[0] * 2.f - c[1];
  const Vec3 after = span + 2 < kPoints ? c[span + 2] : c[kPoints - 1] * 2.f - c[kPoints - 2];
  return before * w.x + c[span] * w.y + c[span + 1] * w.z + after * w.w;
}

/// How cross-sections of a level fit the real strands between all control points.
struct Fit {
  double inside = 0;  ///< share of places on strands that are in their hair's section
  double mean_ratio =
      0;  ///< of the section's width in a random direction over the extent of the strands there, mean of logarithms
};

Fit measure(const StrandSet& set, const LodHierarchy& lod, std::size_t level) {
  constexpr std::size_t kPlaces = 4 * (kPoints - 1) + 1, kReach = 2;
  double inside = 0, places = 0, logs = 0, sections = 0;
  Rng random(5, static_cast<std::uint32_t>(level));
  for (std::size_t h = lod.level_offsets[level]; h < lod.level_offsets[level + 1]; ++h) {
    const ThickHair& hair = lod.hairs[h];
    if (hair.fibers < 3) continue;
    std::vector<std::vector<Vec3>> strands(hair.fibers, std::vector<Vec3>(kPlaces));
    StrandPath path;
    for (std::uint32_t f = 0; f < hair.fibers; ++f) {
      path.assign(set, lod.order[hair.first_strand + f]);
      path.walk(kPlaces, [&](std::size_t i, const StrandPath::Knot& a, const StrandPath::Knot& b, float t) {
        strands[f][i] = lerp(a.p, b.p, t);
      });
    }
    for (std::size_t j = kReach; j + kReach < kPlaces; j += 3) {
      const auto at = [&](const std::vector<Vec3>& curve, std::size_t i) {
        return on_spline(&curve[h * kPoints], static_cast<float>(i) / 4);
      };
      const Vec3 a = at(lod.major, j), b = at(lod.minor, j), center = at(lod.centers, j);
      const float turn = 6.2831853f * random.uniform();
      const Vec3 direction = normalize(normalize(a) * std::cos(turn) + normalize(b) * std::sin(turn));
      float low = 1e9f, high = -1e9f;
      for (const auto& strand : strands) {
        const Vec3 off = strand[j] - center;
        const float x = dot(off, a) / dot(a, a), y = dot(off, b) / dot(b, b);
        inside += x * x + y * y <= 1, places += 1;
        for (std::size_t i = j - kReach; i <= j + kReach; ++i) {
          const float d = dot(strand[i] - at(lod.centers, i), direction);
          low = std::min(low, d), high = std::max(high, d);
        }
      }
      const float width = 2 * std::hypot(dot(a, direction), dot(b, direction));
      logs += std::log(static_cast<double>(width / (high - low + 2 * lod.radii[h * kPoints + j / 4]))), sections += 1;
    }
  }
  return {inside / places, std::exp(logs / sections)};
}

TEST_P(Styles, SectionsHoldTheirFibersAndNotMuchMore) {
  const StrandSet set = groom(GetParam(), 6000, 64);
  const LodHierarchy lod = build_lod(set, {.levels = 3, .guides = 64, .memory_share = 20});
  for (std::size_t l = 0; l < lod.levels(); ++l) {
    const Fit fit = measure(set, lod, l);
    EXPECT_GE(fit.inside, 0.93) << "level " << l;
    EXPECT_GE(fit.mean_ratio, 0.95) << "level " << l;
    EXPECT_LE(fit.mean_ratio, 1.65) << "level " << l;
    RecordProperty("inside" + std::to_string(l), std::to_string(fit.inside));
    RecordProperty("ratio" + std::to_string(l), std::to_string(fit.mean_ratio));
  }
}

TEST_P(Styles, AxesStandAcrossTheHairAndDoNotTurnOver) {
  const StrandSet set = groom(GetParam(), 3000);
  const LodHierarchy lod = build_lod(set, {.levels = 3, .guides = 48, .memory_share = 20});
  for (std::size_t h = 0; h < lod.hair_count(); ++h) {
    float longer = 0;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Vec3 a = lod.major[h * kPoints + k], b = lod.minor[h * kPoints + k];
      ASSERT_GT(length(a), 0);
      ASSERT_GT(length(b), 0);
      EXPECT_LT(std::fabs(dot(normalize(a), normalize(b))), 1e-5f);
      longer += length(a) - length(b);
      if (k == 0) continue;
      const Vec3 before = lod.major[h * kPoints + k - 1];
      const Vec3 along = cross(a, b), along_before = cross(before, lod.minor[h * kPoints + k - 1]);
      // Where the hair itself turns by less than a right angle, its axes do as well.
      if (dot(along, along_before) > 0.5f * length(along) * length(along_before)) {
        EXPECT_GT(dot(a, before), -0.1f * length(a) * length(before)) << h << " " << k;
      }
    }
    EXPECT_GT(longer, -1e-6f) << h;
  }
}

TEST_P(Styles, AreaFallsAsAsked) {
  const StrandSet set = groom(GetParam(), 8000);
  for (const float ratio : {2.f, 4.f}) {
    const LodHierarchy lod = build_lod(set, {.levels = 3, .guides = 48, .area_ratio = ratio, .memory_share = 20});
    ASSERT_EQ(lod.levels(), 3u);
    const Stations stations = fit_stations(set, {});
    std::vector<double> area(3);
    for (std::size_t l = 0; l < 3; ++l)
      for (const ThickHair& hair : lod.level(l)) {
        const std::span<const std::uint32_t> strands(&lod.order[hair.first_strand], hair.fibers);
        area[l] += static_cast<double>(mean_area(fit_cross_sections(stations, strands, 0.95f, false))) * hair.fibers;
      }
    for (std::size_t l = 1; l < 3; ++l) EXPECT_NEAR(std::log(area[l - 1] / area[l]), std::log(ratio), 0.12) << l;
  }
}

TEST(BuildLod, IsTheSameForAnyThreadCount) {
  const StrandSet set = groom(HairStyle::kCurly, 3000);
  const auto build = [&](int threads) {
    set_thread_count(threads);
    const LodHierarchy lod = build_lod(set, {.levels = 3, .guides = 48, .memory_share = 20});
    set_thread_count(0);
    return lod;
  };
  const LodHierarchy one = build(1), three = build(3);
  EXPECT_EQ(one.order, three.order);
  EXPECT_EQ(one.guides, three.guides);
  EXPECT_EQ(one.centers, three.centers);
  EXPECT_EQ(one.major, three.major);
  EXPECT_EQ(one.minor_weights, three.minor_weights);
  EXPECT_EQ(one.strand_weights, three.strand_weights);
}

TEST(BuildLod, SatisfiesItsRulesAndItsMemory) {
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kCurly})
    for (const float share : {0.1f, 0.5f, 5.f}) {
      const StrandSet strands = groom(style, 3000, 64);
      const LodHierarchy lod = build_lod(strands, {.levels = 6, .guides = 48, .memory_share = share});
      validate(lod, strands, "test");
      const std::size_t groom_bytes = strands.points.size() * sizeof(Vec3) + strands.widths.size() * sizeof(float);
      if (lod.levels() > 1) {
        EXPECT_LE(static_cast<double>(resident_bytes(lod)), static_cast<double>(share) * static_cast<double>(groom_bytes));
      }
      std::size_t hairs = 0, bytes = 0;
      for (const LodLevelSummary& s : summarize(lod)) hairs += s.hairs, bytes += s.bytes;
      EXPECT_EQ(hairs, lod.hair_count());
      EXPECT_LE(bytes, resident_bytes(lod));
    }
}

TEST(BuildLod, UsesTheMemoryThatItMay) {
  const StrandSet set = groom(HairStyle::kStraight, 3000, 64);
  const LodHierarchy whole = build_lod(set, {.levels = 3, .guides = 48, .memory_share = 20});
  const auto share =
      static_cast<float>(static_cast<double>(resident_bytes(whole)) /
                         static_cast<double>(set.points.size() * sizeof(Vec3) + set.widths.size() * sizeof(float)));
  EXPECT_EQ(build_lod(set, {.levels = 3, .guides = 48, .memory_share = share * 1.0001f}).levels(), 3u);
  EXPECT_EQ(build_lod(set, {.levels = 3, .guides = 48, .memory_share = share * 0.9999f}).levels(), 2u);
}

TEST(BuildLod, TakesAnyGroom) {
  StrandSet set;
  set.widths = {1e-4f};
  set.basis = CurveBasis::kLinear;
  const auto add = [&](std::vector<Vec3> points) {
    set.points.insert(set.points.end(), points.begin(), points.end());
    if (set.offsets.empty()) set.offsets.push_back(0);
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  };
  add({{0, 0, 0}, {0, 0.1f, 0}});
  for (int more = 0; more < 4; ++more) {  // one strand, two alike, a third of no length, a fourth elsewhere
    const LodHierarchy lod = build_lod(set, {.memory_share = 100});
    validate(lod, set, "test");
    EXPECT_EQ(lod.strand_count(), set.strand_count());
    if (more == 0) {
      ASSERT_EQ(lod.hair_count(), 1u);
      EXPECT_NEAR(length(lod.major[3]), 5e-5f, 1e-8f);
      EXPECT_NEAR(length(lod.minor[3]), 5e-5f, 1e-8f);
      EXPECT_NEAR(lod.length_ratios[0], 1, 1e-5f);
    }
    if (more == 0) add({{0, 0, 0}, {0, 0.1f, 0}});
    if (more == 1) add({{0.1f, 0, 0}, {0.1f, 0, 0}, {0.1f, 0, 0}});
    if (more == 2) add({{0, 0, 0.1f}, {0, 0.05f, 0.1f}, {0.05f, 0.1f, 0.1f}});
  }
}

TEST(BuildLod, CurlsThatControlPointsCannotFollowAreInside) {
  StrandSet set;
  set.widths = {1e-4f}, set.offsets = {0};
  for (int i = 0; i < 400; ++i) {
    const float t = static_cast<float>(i) / 399, turn = 6.2831853f * 25 * t;
    set.points.emplace_back(0.004f * std::cos(turn), -0.3f * t, 0.004f * std::sin(turn));
  }
  set.offsets.push_back(400);
  const LodHierarchy lod = build_lod(set);
  for (std::size_t k = 2; k + 2 < kPoints; ++k) {
    EXPECT_GT(length(lod.minor[k]), 0.003f);
    EXPECT_LT(length(lod.major[k]), 0.007f);
  }
  EXPECT_GT(lod.length_ratios[0], 2);  // the coil is longer than the line along it
}

TEST(BuildLod, LengthsAreThoseOfCentersAsTheyAreDrawn) {
  StrandSet set;  // one strand that goes left and right between control points, whose polygon is longer than the curve
  set.widths = {1e-4f}, set.offsets = {0}, set.basis = CurveBasis::kCatmullRom;
  for (int i = 0; i < 16; ++i) set.points.emplace_back(i % 2 == 0 ? 0.f : 0.005f, -0.02f * static_cast<float>(i), 0.f);
  set.offsets.push_back(16);
  const LodHierarchy lod = build_lod(set, {.memory_share = 100});
  ASSERT_EQ(lod.hair_count(), 1u);
  double polygon = 0;
  for (std::size_t k = 1; k < kPoints; ++k) polygon += static_cast<double>(length(lod.centers[k] - lod.centers[k - 1]));
  EXPECT_GT(polygon, 0.31);
  EXPECT_NEAR(lod.length_ratios[0], 1, 0.02f);
}

/// Fibers that turn about a line `turns` times on its whole length of 0.1 m; bent: the line is an arc.
StrandSet twisted(float turns, bool bent) {
  StrandSet set;
  set.widths = {2e-5f}, set.offsets = {0};
  constexpr int kFibers = 60, kSamples = 64;
  for (std::uint32_t i = 0; i < kFibers; ++i) {
    Rng rng(5, i);
    const float radius = 4e-4f * std::sqrt(rng.uniform()), phase = 6.2831853f * rng.uniform();
    for (int j = 0; j < kSamples; ++j) {
      const float t = static_cast<float>(j) / (kSamples - 1), angle = phase + 6.2831853f * turns * t,
                  x = radius * std::cos(angle), y = radius * std::sin(angle);
      const float a = bent ? 2 * t : 0;  // in a plane, so that side and binormal turn about the line not at all
      if (bent) set.points.emplace_back((0.05f - x) * std::cos(a), (0.05f - x) * std::sin(a), y);
      else set.points.emplace_back(x, y, 0.1f * t);
    }
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

TEST(BuildLod, TwistIsHowFastFibersTurn) {
  for (const bool bent : {false, true})
    for (const float turns : {0.f, 1.5f, -3.f}) {
      const LodHierarchy lod = build_lod(twisted(turns, bent), {.levels = 1, .guides = 1, .memory_share = 100});
      ASSERT_EQ(lod.hair_count(), 1u);
      const float expected = 6.2831853f * turns / 0.1f;
      EXPECT_NEAR(lod.twists[0], expected, 0.03f * std::fabs(expected) + 0.3f) << turns << bent;
    }
}

TEST(BuildLod, GuidesCanBeThoseThatStrandsName) {
  StrandSet set = groom(HairStyle::kWavy, 300);
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    set.strand_id[s] = static_cast<std::uint32_t>(1000 + s), set.guide_id[s] = static_cast<std::int32_t>(1000 + s / 50 * 50);
  EXPECT_THAT(build_lod(set, {.levels = 1, .guides = 0}).guide_strands, testing::ElementsAre(0, 50, 100, 150, 200, 250));
  set.strand_id.clear();
  set.guide_id.assign(set.strand_count(), 7), set.guide_id[0] = 2, set.guide_id[1] = -1;
  EXPECT_THAT(build_lod(set, {.levels = 1, .guides = 0}).guide_strands, testing::ElementsAre(2, 7));
}

TEST(BuildLod, MistakesAreNamed) {
  const StrandSet set = groom(HairStyle::kStraight, 20);
  EXPECT_THROW(build_lod(set, {.levels = 0}), Error);
  StrandSet without_guides = set;
  without_guides.guide_id.clear();
  EXPECT_THROW(build_lod(without_guides, {.guides = 0}), Error);
  EXPECT_THROW(build_lod(set, {.area_ratio = 1}), Error);
  EXPECT_THROW(build_lod(set, {.covered = 0.2f}), Error);
  EXPECT_THROW(build_lod(set, {.covered = NAN}), Error);
  EXPECT_THROW(build_lod(set, {.memory_share = 0}), Error);
  EXPECT_THROW(build_lod(StrandSet()), Error);
  EXPECT_THROW(build_lod(set, {}, [](std::string_view, double) { return false; }), Error);
  EXPECT_THROW(extract_level(build_lod(set), 99), Error);
}

TEST(ValidateLod, OfOtherStrandsItIsRefused) {
  const StrandSet set = groom(HairStyle::kStraight, 200), other = groom(HairStyle::kWavy, 200);
  const LodHierarchy lod = build_lod(set, {.guides = 8});
  validate(lod, set, "test");
  EXPECT_THROW(validate(lod, other, "test"), Error);
}

TEST(PrismWeights, GiveBackWhatTheyMade) {
  const StrandSet set = groom(HairStyle::kWavy, 30);
  const Stations stations = fit_stations(set, {});
  const Vec3 *a = stations.strand(0), *b = stations.strand(10), *c = stations.strand(20);
  for (const Vec2 w : {Vec2(1, 0), Vec2(0, 1), Vec2(0, 0), Vec2(0.2f, 0.5f), Vec2(0.5f, 0.5f)}) {
    slow::Strand strand;
    for (std::size_t k = 0; k < kPoints; ++k) strand[k] = a[k] * w.x + b[k] * w.y + c[k] * (1 - w.x - w.y);
    const Vec2 found = prism_weights(strand.data(), a, b, c);
    EXPECT_NEAR(found.x, w.x, 2e-3f);
    EXPECT_NEAR(found.y, w.y, 2e-3f);
  }
  // Beyond the triangle: the nearest place of it, by a search.
  slow::Strand beyond;
  for (std::size_t k = 0; k < kPoints; ++k) beyond[k] = a[k] * 1.5f + b[k] * -0.2f + c[k] * -0.3f;
  const auto off = [&](Vec2 w) {
    double sum = 0;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Vec3 d = beyond[k] - (a[k] * w.x + b[k] * w.y + c[k] * (1 - w.x - w.y));
      sum += static_cast<double>(dot(d, d));
    }
    return sum;
  };
  double least = 1e9;
  for (int i = 0; i <= 200; ++i)
    for (int j = 0; i + j <= 200; ++j) least = std::min(least, off({static_cast<float>(i) / 200, static_cast<float>(j) / 200}));
  EXPECT_LT(off(prism_weights(beyond.data(), a, b, c)), least * 1.001);
}

TEST(BSplineThrough, RunsThroughItsStations) {
  std::array<Vec3, kPoints> stations, control;
  for (std::uint32_t k = 0; k < kPoints; ++k) stations[k] = {Rng(1, k).normal(), Rng(2, k).normal(), Rng(3, k).normal()};
  bspline_through(stations.data(), control.data());
  for (std::size_t k = 0; k < kPoints; ++k)
    EXPECT_LT(length(on_spline(control.data(), static_cast<float>(k)) - stations[k]), 1e-5f) << k;
  std::array<Vec3, kPoints> same = stations;
  bspline_through(same.data(), same.data());
  EXPECT_EQ(same, control);
}

TEST(MeanWidth, IsTheShadowOverAllDirections) {
  for (const float b : {1.f, 0.5f, 0.1f, 0.f}) {
    double sum = 0;
    for (int i = 0; i < 1000; ++i)
      sum += std::hypot(std::cos(i * 3.14159265 / 1000), static_cast<double>(b) * std::sin(i * 3.14159265 / 1000));
    EXPECT_NEAR(mean_width(1, b), 2 * sum / 1000, 0.006 * 2 * sum / 1000) << b;
    EXPECT_EQ(mean_width(1, b), mean_width(b, 1));
  }
  EXPECT_EQ(mean_width(0, 0), 0);
}

}  // namespace
}  // namespace pelage
