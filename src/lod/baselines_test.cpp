// What thick hairs are measured against: fewer and wider strands, and hair cards.
#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <set>

#include "frame/camera_view.h"
#include "kit/grown_chain.h"
#include "lod/draw_levels.h"
#include "lod/hair_cards.h"
#include "lod/thickened_strands.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

GroomInstance groom_with_chain(HairStyle style, int strands) { return kit::groom_with_chain(style, strands, 4); }
using kit::view_from;

class Baselines : public testing::Test {
 protected:
  std::vector<GroomInstance> draw_strands(const LodCut& cut) const {
    const ThickenedStrands thickened(lod_);
    return draw_levels(groom_, cut, cuts_, groom_.strands->basis,
                       cluster_by_cluster(lod_, thickened.pen(*groom_.strands, lod_, cuts_)));
  }
  std::vector<GroomInstance> draw_cards(const LodCut& cut, const CameraView& view) const {
    const HairCards cards(*groom_.strands, lod_);
    const LodPlace place{lod_, view, compose(view.world_to_camera, groom_.transform)};
    return draw_levels(groom_, cut, cuts_, CurveBasis::kLinear, cluster_by_cluster(lod_, cards.pen(*groom_.strands, place)));
  }
  LodCut all(std::size_t level) const { return one_level(lod_, level); }
  LodCut mixed() const { return HairCards::choose({lod_, view_, view_.world_to_camera}, PrismHairs(lod_), 1, -1, {}); }
  const GroomInstance groom_ = groom_with_chain(HairStyle::kWavy, 1500);
  const LodHierarchy& lod_ = *groom_.lod;
  const StrandCuts cuts_{*groom_.strands};
  const CameraView view_ = view_from({1, 0.3f, 4});
};

double width_sum(const StrandSet& set) {
  double sum = 0;
  for (const float w : set.widths) sum += static_cast<double>(w);
  return sum;
}

// As many strands as the level has thick hairs, and as much width as the groom: every point of it counts, as all strands have as many.
TEST_F(Baselines, ThickenedStrandsKeepWidthsAndTheBudget) {
  StrandSet even = *groom_.strands;
  even.widths = std::vector<float>(even.points.size(), 7e-5f);
  GroomInstance groom = groom_;
  groom.strands = std::make_shared<const StrandSet>(even);
  for (std::size_t l = 0; l < lod_.levels(); ++l) {
    const ThickenedStrands thickened(lod_);
    const auto drawn =
        draw_levels(groom, all(l), cuts_, even.basis, cluster_by_cluster(lod_, thickened.pen(*groom.strands, lod_, cuts_)));
    ASSERT_EQ(drawn.size(), 1u);
    const StrandSet& set = *drawn[0].strands;
    validate(set, "test");
    EXPECT_EQ(set.strand_count(), lod_.level(l).size());
    EXPECT_NEAR(width_sum(set) / width_sum(even), 1, 1e-4);
    const ThickSections& sections = *drawn[0].sections;
    ASSERT_EQ(sections.fibers.size(), set.points.size());
    ASSERT_EQ(sections.levels, std::vector<std::uint8_t>(set.strand_count(), static_cast<std::uint8_t>(l)));
    for (std::size_t i = 0; i < set.points.size(); i += 7)
      ASSERT_NEAR(sections.fibers[i] * sections.diameters[i], set.widths[i], 1e-9f);
  }
}

// What a coarse level keeps, finer ones keep too, and each is a strand of the groom.
TEST_F(Baselines, FewerStrandsAreAPartOfMore) {
  std::set<std::uint32_t> coarser;
  for (std::size_t l = 0; l < lod_.levels(); ++l) {
    const auto drawn = draw_strands(all(l));
    const std::set<std::uint32_t> kept(drawn[0].strands->strand_id.begin(), drawn[0].strands->strand_id.end());
    EXPECT_EQ(kept.size(), drawn[0].strands->strand_count()) << "none twice";
    EXPECT_TRUE(std::includes(kept.begin(), kept.end(), coarser.begin(), coarser.end())) << l;
    coarser = kept;
  }
}

// Picks are no prefix of the chain's own order, which is by clusters.
TEST_F(Baselines, StrandsAreKeptAtRandom) {
  const ThickenedStrands thickened(lod_);
  std::size_t same = 0, prisms = 0;
  for (std::size_t p = 0; p < lod_.level(0).size(); ++p) {
    const ThickHair& hair = lod_.hairs[p];
    const auto first = lod_.order.begin() + hair.first_strand;
    ASSERT_NE(std::find(first, first + hair.fibers, thickened.strand(p)), first + hair.fibers);
    if (hair.fibers < 8) continue;
    ++prisms;
    same += thickened.strand(p) == *first;
  }
  ASSERT_GT(prisms, 20u);
  EXPECT_LT(static_cast<double>(same) / static_cast<double>(prisms), 0.3);
}

TEST_F(Baselines, TexturesKeepMeanCoverage) {
  const HairCards cards(*groom_.strands, lod_);
  constexpr float kTexels = HairCards::kRows * HairCards::kColumns;
  for (std::size_t h = 0; h < lod_.level_offsets[HairCards::kLevels]; ++h) {
    int opaque = 0;
    for (std::size_t row = 0; row < HairCards::kRows; ++row) opaque += std::popcount(cards.row(h, row));
    ASSERT_GT(cards.coverage(h), 0);
    const float all = std::clamp(cards.coverage(h) * 1.5707963f * kTexels, 1.f, kTexels);
    ASSERT_NEAR(static_cast<float>(opaque), all, 0.501f) << h;
  }
}

// One straight strand per card, at a known place: its column is opaque, from root to tip, and no other is.
TEST(HairCards, AStrandIsPaintedWhereItIs) {
  LodHierarchy lod;
  StrandSet set;
  set.widths = {0.0016f}, set.offsets = {0, 2}, set.basis = CurveBasis::kLinear;
  set.points = {{0.00375f, 0, 0}, {0.00375f, -0.2f, 0}};
  lod.level_offsets = {0, 1}, lod.order = {0}, lod.hairs.resize(1), lod.hairs[0].fibers = 1, lod.length_ratios = {1};
  for (std::size_t k = 0; k < kPoints; ++k) {
    lod.centers.push_back({0, -0.2f * share_at(k), 0});
    lod.major.push_back({0.01f, 0, 0}), lod.minor.push_back({0, 0, 0.001f});
  }
  const HairCards cards(set, lod);
  for (std::size_t row = 1; row + 1 < HairCards::kRows; ++row) ASSERT_EQ(cards.row(0, row), 1u << 5) << row;
  EXPECT_NEAR(cards.coverage(0), 0.64f / HairCards::kColumns, 0.002f);
}

// Seen from its edge a card is a line; shadows count its fibers whole.
TEST_F(Baselines, CardsAreFlat) {
  const auto front = draw_cards(all(0), view_), side = draw_cards(all(0), view_from({4, 0.3f, -1}));
  const StrandSet& set = *front[0].strands;
  validate(set, "test");
  ASSERT_EQ(set.points, side[0].strands->points);
  EXPECT_NE(set.widths, side[0].strands->widths);
  const ThickSections& sections = *front[0].sections;
  for (std::size_t i = 0; i < set.points.size(); ++i) ASSERT_LE(set.widths[i], 2.0001f * length(sections.major[i]));
  double fibers = 0;  // texel by texel
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    fibers += static_cast<double>(sections.fibers[set.offsets[s]]) * (set.offsets[s + 1] - set.offsets[s] - 1);
  EXPECT_NEAR(fibers / HairCards::kRows, static_cast<double>(groom_.strands->strand_count()), 1);
}

// Texels obey the rule that thick hairs obey; what would need finer levels than cards have is strands.
TEST_F(Baselines, CardsAreChosenByTheirTexels) {
  const LodPlace place{lod_, view_, compose(view_.world_to_camera, groom_.transform)};
  const PrismHairs prisms(lod_);
  const LodCut cards = HairCards::choose(place, prisms, 0.25f, -1, {}),
               hairs = choose_levels(place, prisms, 0.25f * HairCards::kColumns);
  ASSERT_GT(lod_.levels(), HairCards::kLevels);
  for (std::size_t h = 0; h < cards.size(); ++h)
    ASSERT_EQ(cards[h], h < lod_.level_offsets[HairCards::kLevels] ? hairs[h] : cards[lod_.hairs[h].parent]);
  EXPECT_EQ(HairCards::choose(place, prisms, 1, 9, {}), all(HairCards::kLevels - 1));
}

TEST_F(Baselines, AnyNumberOfThreadsDrawsTheSame) {
  const auto expect_same = [](const std::vector<GroomInstance>& a, const std::vector<GroomInstance>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t g = 0; g < a.size(); ++g) {
      EXPECT_EQ(a[g].strands->points, b[g].strands->points);
      EXPECT_EQ(a[g].strands->widths, b[g].strands->widths);
    }
  };
  set_thread_count(1);
  const auto strands = draw_strands(mixed()), cards = draw_cards(mixed(), view_);
  set_thread_count(3);
  expect_same(strands, draw_strands(mixed()));
  expect_same(cards, draw_cards(mixed(), view_));
  set_thread_count(0);
}

/// Sum of coverage of a picture.
double coverage(Scene& scene, float distance, std::optional<LodShape> shape) {
  scene.camera.eye = {0.3f * distance, 0, distance}, scene.camera.target = {0, -0.1f, 0}, scene.camera.fov_y = 0.7f;
  scene.settings.thick_hairs.on = shape.has_value();
  if (shape) scene.settings.thick_hairs.shape = *shape;
  const RenderResult picture = render(scene);
  double total = 0;
  for (std::size_t p = 0; p < picture.linear.pixels.size(); p += static_cast<std::size_t>(picture.linear.channel_count()))
    total += static_cast<double>(picture.linear.pixels[p]);
  return total;
}

TEST(LodShapes, KeepCoverageFarAway) {
  Scene scene;
  scene.grooms.push_back(groom_with_chain(HairStyle::kWavy, 6000));
  scene.settings.width = scene.settings.height = 256;
  scene.settings.view = View::kCoverage;
  for (const float distance : {4.f, 12.f, 40.f}) {
    const double all = coverage(scene, distance, {});
    const double strands = coverage(scene, distance, LodShape::kStrands) / all;
    EXPECT_GT(strands, 0.99) << distance << ": few wide strands hide each other less than many thin ones";
    EXPECT_LT(strands, 1.12) << distance;
    EXPECT_NEAR(coverage(scene, distance, LodShape::kCards) / all, 1, 0.2) << distance;
  }
}

// Gray where strands show, a level's number where it does.
TEST(LodView, TellsLevels) {
  Scene scene;
  scene.grooms.push_back(groom_with_chain(HairStyle::kStraight, 1500));
  scene.settings.width = scene.settings.height = 64;
  scene.settings.view = View::kLod;
  scene.camera.eye = {0, 0, 1}, scene.camera.target = {0, -0.1f, 0};
  const auto levels = [&](ThickHairSettings settings) {
    scene.settings.thick_hairs = settings;
    const RenderResult picture = render(scene);
    std::set<float> found;
    for (std::size_t p = 0; p < picture.linear.pixels.size(); p += 4)
      if (picture.linear.pixels[p + 3] > 0) found.insert(picture.linear.pixels[p]);
    return found;
  };
  EXPECT_EQ(levels({.on = false}), std::set<float>{-1});
  EXPECT_EQ(levels({.level = 1}), std::set<float>{1});
  EXPECT_EQ(levels({.shape = LodShape::kStrands, .level = 2}), std::set<float>{2});
  EXPECT_EQ(levels({.shape = LodShape::kCards, .level = 0}), std::set<float>{0});
  EXPECT_GT(levels({.pixels = 8}).size(), 1u);
}

}  // namespace
}  // namespace pelage
