// Chains of knitted cloth: their clusters are yarns, plies and parts of plies, and they know how these are twisted.
#include <gtest/gtest.h>
#include <pelage/knit.h>
#include <pelage/lod.h>

#include <algorithm>
#include <numbers>
#include <set>

namespace pelage {
namespace {

KnitSettings small() {
  KnitSettings s;
  s.wales = 4, s.courses = 3;
  s.strands = 40 * 2 * s.wales * s.courses * s.plies;
  return s;
}

struct Cloth {
  explicit Cloth(const KnitSettings& settings, std::uint32_t guides)
      : fibers(grow_knit(settings)), lod(build_lod(fibers, {.levels = 3, .guides = guides, .memory_share = 100})) {}

  /// Pieces of plies that a thick hair has fibers of.
  std::set<std::int32_t> plies(const ThickHair& hair) const {
    std::set<std::int32_t> of;
    for (std::uint32_t i = 0; i < hair.fibers; ++i) of.insert(fibers.guide_id[lod.order[hair.first_strand + i]]);
    return of;
  }
  /// Share of the fibers of a level that stand in thick hairs of one ply.
  double unmixed(std::size_t level) const {
    double alone = 0;
    for (const ThickHair& hair : lod.level(level)) alone += plies(hair).size() == 1 ? hair.fibers : 0;
    return alone / static_cast<double>(lod.strand_count());
  }

  StrandSet fibers;
  LodHierarchy lod;
};

TEST(KnitLod, WithTheGroomsOwnGuidesThickHairsAreYarnsThenPlies) {
  const KnitSettings s = small();
  const Cloth cloth(s, 0);
  const auto yarns = static_cast<std::size_t>(2 * s.wales * s.courses), plies = yarns * static_cast<std::size_t>(s.plies);
  EXPECT_EQ(cloth.lod.guide_count(), plies);
  EXPECT_EQ(cloth.lod.level(0).size(), yarns);
  for (const ThickHair& hair : cloth.lod.level(0)) {
    const std::set<std::int32_t> of = cloth.plies(hair);
    ASSERT_EQ(of.size(), static_cast<std::size_t>(s.plies));
    EXPECT_EQ(*of.begin() / s.plies, *of.rbegin() / s.plies) << "of one piece of yarn";
  }
  EXPECT_GT(cloth.unmixed(1), 0.98);
  EXPECT_LT(cloth.lod.level(1).size(), plies + plies / 20);
  EXPECT_EQ(cloth.unmixed(2), 1);
}

TEST(KnitLod, WithGuidesOfClustersFewFibersStandBetweenPlies) {
  const Cloth cloth(small(), 96);
  EXPECT_GT(cloth.unmixed(1), 0.75);
  EXPECT_GT(cloth.unmixed(2), 0.95);
}

TEST(KnitLod, PliesAreTwistedAsTheirFibersTurn) {
  const KnitSettings s = small();
  const Cloth cloth(s, 0);
  const float expected = -2 * std::numbers::pi_v<float> / (s.fiber_pitch * s.yarn);  // per metre of yarn
  std::vector<float> twists;
  for (std::uint32_t h = cloth.lod.level_offsets[1]; h < cloth.lod.level_offsets[2]; ++h) twists.push_back(cloth.lod.twists[h]);
  std::nth_element(twists.begin(), twists.begin() + static_cast<std::ptrdiff_t>(twists.size() / 2), twists.end());
  EXPECT_NEAR(twists[twists.size() / 2], expected, 0.1f * -expected);
}

}  // namespace
}  // namespace pelage
