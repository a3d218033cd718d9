#include "lod/draw_levels.h"
#include "lod/thick_pieces.h"

#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/render.h>
#include <pelage/runtime.h>
#include <pelage/trace.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/strand_part.h"
#include "kit/grown_chain.h"
#include "light/strand_lines.h"
#include "lod/thick_hairs.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

GroomInstance groom_with_chain(int strands = 1500) { return kit::groom_with_chain(HairStyle::kWavy, strands, 3); }
using kit::view_from;

class DrawLevels : public testing::Test {
 protected:
  std::vector<GroomInstance> draw(const LodCut& cut) const {
    const LodPlace place{lod_, view_, compose(view_.world_to_camera, groom_.transform)};
    return draw_levels(groom_, cut, cuts_, CurveBasis::kCatmullRom, thick_hair_pen(*groom_.strands, place));
  }
  LodCut all(std::size_t level) const { return one_level(lod_, level); }
  /// Of every hair of `level` its strands on these segments, the hair on others.
  LodCut strands_on(std::uint16_t segments, std::size_t level) const {
    LodCut cut = all(level);
    for (std::size_t h = lod_.level_offsets[level]; h < lod_.hair_count(); ++h) cut[h] = segments;
    return cut;
  }
  const GroomInstance groom_ = groom_with_chain();
  const LodHierarchy& lod_ = *groom_.lod;
  const StrandCuts cuts_{*groom_.strands};
  const CameraView view_ = view_from({1, 0.3f, 4});
};

// Throws of fibers into a band: the mean share that at least one of them covers.
TEST(CoveredWidth, IsWhatRandomFibersCover) {
  Rng rng(3, 1);
  for (const int fibers : {1, 3, 20}) {
    constexpr float kBand = 1, kFiber = 0.07f;
    constexpr int kThrows = 4000, kPlaces = 50;
    int covered = 0;
    for (int t = 0; t < kThrows; ++t) {
      std::vector<float> at;
      for (int f = 0; f < fibers; ++f) at.push_back(rng.uniform() * kBand);
      for (int p = 0; p < kPlaces; ++p)  // the band has no ends: those of real ones are uneven anyway
        covered += std::any_of(at.begin(), at.end(), [&](float x) {
          const float apart = std::fabs(x - (static_cast<float>(p) + 0.5f) / kPlaces);
          return std::fmin(apart, kBand - apart) < kFiber / 2;
        });
    }
    EXPECT_NEAR(covered_width(kBand, kFiber, static_cast<float>(fibers)), covered / float{kThrows * kPlaces}, 0.005f) << fibers;
  }
}

TEST(CoveredWidth, OneFiberIsAsWideAsItselfAndDenseHairAsItsBand) {
  EXPECT_FLOAT_EQ(covered_width(0.01f, 1e-4f, 1), 1e-4f);
  EXPECT_FLOAT_EQ(covered_width(0.01f, 1e-4f, 10000), 0.01f);
  EXPECT_FLOAT_EQ(covered_width(1e-4f, 2e-4f, 5), 1e-4f);
  EXPECT_FLOAT_EQ(covered_width(0, 2e-4f, 1), 2e-4f);
}

// Fibers that lean by δ toward all sides, counted: what they show from the side, and how far they lean along one axis.
TEST(LeaningFibers, CrossAsOftenAsTheyLookLong) {
  constexpr int kSides = 1000;
  for (const double lean : {0., 0.1, 0.5, 1., 1.4}) {
    double shown = 0, along_one_axis = 0;
    for (int i = 0; i < kSides; ++i) {
      const double side = std::sin(2 * 3.14159265358979 * (i + 0.5) / kSides);
      shown += std::hypot(1, std::tan(lean) * side) / kSides;
      along_one_axis += std::sin(lean) * std::sin(lean) * side * side / kSides;
    }
    const auto ratio = static_cast<float>(1 / std::cos(lean));
    EXPECT_NEAR(crossing_ratio(ratio), shown, 0.006 * shown) << lean;
    EXPECT_NEAR(direction_variance(ratio), along_one_axis, 1e-5) << lean;
  }
  EXPECT_EQ(crossing_ratio(0.9f), 1);
  EXPECT_EQ(direction_variance(0.9f), 0);
}

TEST_F(DrawLevels, AllStrandsAreTheGroomItself) {
  const auto drawn = draw(all(lod_.levels()));
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_EQ(drawn[0].strands, groom_.strands);
  EXPECT_EQ(drawn[0].only, nullptr);
}

// Through the knots of the B-spline, with all fibers of the groom on each level.
TEST_F(DrawLevels, EveryLevelStandsForAllFibers) {
  for (std::size_t l = 0; l < lod_.levels(); ++l) {
    const auto drawn = draw(all(l));
    ASSERT_EQ(drawn.size(), 1u);
    const StrandSet& set = *drawn[0].strands;
    validate(set, "test");
    ASSERT_EQ(set.strand_count(), lod_.level(l).size());
    ASSERT_EQ(drawn[0].sections->major.size(), set.point_count());
    double fibers = 0;
    for (std::size_t s = 0; s < set.strand_count(); ++s) {
      const std::size_t h = lod_.level_offsets[l] + s;
      const Vec3* c = &lod_.centers[h * kPoints];
      ASSERT_EQ(set.points[s * kPoints], c[0]);
      ASSERT_LT(length(set.points[s * kPoints + 7] - (c[6] + c[7] * 4.f + c[8]) / 6.f), 1e-6f);
      const ThickSections& sections = *drawn[0].sections;
      const float all_widths = sections.diameters[s * kPoints + 7] * sections.fibers[s * kPoints + 7],
                  one = 2 * lod_.radii[h * kPoints + 7];
      fibers += static_cast<double>(all_widths / (one * crossing_ratio(lod_.length_ratios[h])));
      ASSERT_LE(set.widths[s * kPoints + 7], all_widths * 1.0001f) << "they can only hide each other";
    }
    EXPECT_NEAR(fibers, static_cast<double>(groom_.strands->strand_count()), 1);
  }
}

// Half of the prisms by strands, the other half thick: nothing twice, nothing lost.
TEST_F(DrawLevels, WholeStrandsAreOnlyThoseOfTheirPrisms) {
  const std::size_t prisms = lod_.level(0).size();
  LodCut cut(lod_.hair_count());
  std::size_t thick = 0, whole = 0;
  for (std::size_t h = 0; h < cut.size(); ++h) {
    const std::uint32_t parent = lod_.hairs[h].parent;
    cut[h] = parent == LodHierarchy::kNone ? (h % 2 == 0 ? 0 : kAllSegments) : cut[parent];
    if (h < prisms) (h % 2 == 0 ? thick : whole) += h % 2 == 0 ? 1 : lod_.hairs[h].fibers;
  }
  const auto drawn = draw(cut);
  ASSERT_EQ(drawn.size(), 2u);
  EXPECT_EQ(drawn_parts(drawn[0]), whole);
  EXPECT_EQ(drawn[1].strands->strand_count(), thick);
  std::set<std::uint32_t> kept;
  for (const StrandPart& part : *drawn[0].only) {
    EXPECT_EQ(part, whole_strand(*groom_.strands, part.strand));
    kept.insert(part.strand);
  }
  for (std::size_t p = 0; p < prisms; ++p)
    for (std::uint32_t i = 0; i < lod_.hairs[p].fibers; ++i)
      ASSERT_EQ(kept.count(lod_.order[lod_.hairs[p].first_strand + i]), p % 2);
}

// A strand that turns into thick hair: its part starts and ends where the hair does, to half a span, and no place is drawn twice.
TEST_F(DrawLevels, PartsOfStrandsAreCutWhereTheHairIs) {
  const auto drawn = draw(strands_on(0b000000111110000, 1));
  ASSERT_EQ(drawn.size(), 2u);
  const StrandSet& whole = *groom_.strands;
  ASSERT_EQ(drawn[0].strands, groom_.strands);
  ASSERT_EQ(drawn[0].only->size(), whole.strand_count());
  double off = 0;
  for (const StrandPart& part : *drawn[0].only) {
    std::vector<float> at{0};
    for (std::size_t i = whole.offsets[part.strand] + 1; i < whole.offsets[part.strand + 1]; ++i)
      at.push_back(at.back() + length(whole.points[i] - whole.points[i - 1]));
    for (const auto& [span, share] : {std::pair(part.first_span, 4 / 15.f), {part.first_span + part.spans, 9 / 15.f}}) {
      const float wanted = share * at.back();
      ASSERT_LE(wanted, 0.5f * (at[span] + at[span + 1]) * 1.00001f);
      ASSERT_GE(wanted, 0.5f * (at[span] + at[span - 1]) * 0.99999f);
      off += static_cast<double>((at[span] - wanted) / at.back()) / static_cast<double>(whole.strand_count());
    }
  }
  EXPECT_LT(std::fabs(off), 0.25 / 23) << "as often too long as too short";
  const StrandSet& hairs = *drawn[1].strands;
  validate(hairs, "test");
  ASSERT_EQ(hairs.strand_count(), lod_.level(1).size()) << "whole, so that places along them are those of the hair";
  ASSERT_EQ(drawn[1].only->size(), 2 * hairs.strand_count());
  for (std::uint32_t s = 0; s < hairs.strand_count(); ++s) {
    ASSERT_EQ((*drawn[1].only)[2 * s], (StrandPart{s, 0, 4}));
    ASSERT_EQ((*drawn[1].only)[2 * s + 1], (StrandPart{s, 9, 6}));
  }
}

// Hairs of the same prism may have different levels, and so may segments of one.
TEST_F(DrawLevels, ChildrenStandForAPartOfTheirParent) {
  LodCut cut(lod_.hair_count());
  const ThickHair& parent = lod_.hairs[0];
  cut[0] = 0b000000000000111;
  const auto drawn = draw(cut);
  ASSERT_EQ(drawn.size(), 1u);
  const StrandSet& set = *drawn[0].strands;
  ASSERT_EQ(set.strand_count(), lod_.level(0).size() + parent.children);
  EXPECT_EQ(drawn[0].only->front(), (StrandPart{0, 3, 12})) << "from control point 3 to 15";
  for (std::size_t c = 0; c < parent.children; ++c) {
    const std::size_t s = lod_.level(0).size() + c;
    EXPECT_EQ((*drawn[0].only)[s], (StrandPart{static_cast<std::uint32_t>(s), 0, 3}));
    EXPECT_EQ(drawn[0].sections->levels[s], 1);
  }
}

TEST_F(DrawLevels, AnyNumberOfThreadsDrawsTheSame) {
  const LodCut cut = strands_on(0b000000111110000, 2);
  set_thread_count(1);
  const auto one = draw(cut);
  set_thread_count(3);
  const auto three = draw(cut);
  set_thread_count(0);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t g = 0; g < one.size(); ++g) {
    ASSERT_EQ(one[g].only == nullptr, three[g].only == nullptr);
    EXPECT_TRUE(!one[g].only || *one[g].only == *three[g].only);
    EXPECT_EQ(one[g].strands->points, three[g].strands->points);
    EXPECT_EQ(one[g].strands->widths, three[g].strands->widths);
  }
}

/// Every third strand, told by GroomInstance::only or by leaving out the others.
Scene every_third(bool by_only) {
  GrowSettings s = grow_defaults(HairStyle::kCurly);
  s.strands = 300, s.points = 16;
  auto all = std::make_shared<StrandSet>(grow(s, mannequin_head()));
  all->widths = {0.002f}, all->colors.clear();
  Scene scene;
  scene.grooms.resize(1);
  std::vector<StrandPart> parts;
  auto some = std::make_shared<StrandSet>();
  some->basis = all->basis, some->widths = all->widths, some->offsets = {0};
  for (std::uint32_t i = 1; i < all->strand_count(); i += 3) {
    parts.push_back(whole_strand(*all, i));
    for (std::uint32_t p = all->offsets[i]; p < all->offsets[i + 1]; ++p) some->points.push_back(all->points[p]);
    some->offsets.push_back(static_cast<std::uint32_t>(some->points.size()));
  }
  if (by_only) {
    scene.grooms[0].strands = all;
    scene.grooms[0].only = std::make_shared<const std::vector<StrandPart>>(parts);
  } else {
    scene.grooms[0].strands = some;
  }
  scene.camera.eye = {0, 0, 1.6f}, scene.camera.target = {0, -0.1f, 0};
  scene.settings.width = scene.settings.height = 96;
  scene.settings.samples = 4, scene.settings.subdivisions = 2;
  scene.lights.push_back({});
  return scene;
}

double light_of(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) sum += i % 4 == 3 ? 0 : static_cast<double>(image.pixels[i]);
  return sum;
}

TEST(Only, StrandsThatAreLeftOutAreNotThere) {
  Scene told = every_third(true), made = every_third(false);
  TraceSettings settings;
  settings.samples = 2;
  EXPECT_EQ(trace(told, settings).linear.pixels, trace(made, settings).linear.pixels);
  told.settings.background = made.settings.background = {};
  const double light = light_of(render(made).linear);
  EXPECT_NEAR(light_of(render(told).linear) / light, 1, 0.02) << "maps of the light reach as far as all strands";
  Scene all = told;
  all.grooms[0].only = nullptr;
  EXPECT_GT(std::fabs(light_of(render(all).linear) / light - 1), 0.2);
  told.settings.view = made.settings.view = View::kDepth;
  EXPECT_EQ(render(told).linear.pixels, render(made).linear.pixels);
}

/// All strands in two parts each, or whole.
Scene in_parts(CurveBasis basis, bool cut) {
  Scene scene = every_third(true);
  auto set = std::make_shared<StrandSet>(*scene.grooms[0].strands);
  set->basis = basis;
  scene.grooms[0].strands = set;
  std::vector<StrandPart> parts;
  for (std::uint32_t s = 0; s < set->strand_count(); ++s) {
    const StrandPart whole = whole_strand(*set, s);
    if (cut) parts.push_back({s, 0, 2}), parts.push_back({s, 2, whole.spans - 2});
    else parts.push_back(whole);
  }
  scene.grooms[0].only = std::make_shared<const std::vector<StrandPart>>(parts);
  return scene;
}

// A strand in two parts is the strand, in every basis: only the caps of bands where it is cut differ, by less than their width.
TEST(Only, PartsOfStrandsMakeThem) {
  TraceSettings settings;
  settings.samples = 1;
  for (const CurveBasis basis : {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier}) {
    Scene cut = in_parts(basis, true), whole = in_parts(basis, false), lacking = whole;
    std::vector<StrandPart> fewer = *cut.grooms[0].only;
    std::erase_if(fewer, [](const StrandPart& part) { return part.first_span == 0; });
    lacking.grooms[0].only = std::make_shared<const std::vector<StrandPart>>(fewer);
    EXPECT_EQ(trace(cut, settings).linear.pixels, trace(whole, settings).linear.pixels);
    cut.settings.background = whole.settings.background = lacking.settings.background = {};
    const double light = light_of(render(whole).linear);
    EXPECT_NEAR(light_of(render(cut).linear) / light, 1, 0.003) << static_cast<int>(basis);
    EXPECT_LT(light_of(render(lacking).linear) / light, 0.99) << static_cast<int>(basis);
    for (Scene* scene : {&cut, &whole}) scene->settings.view = View::kU;
    const Image a = render(cut).linear, b = render(whole).linear;
    std::size_t differ = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) differ += std::fabs(a.pixels[i] - b.pixels[i]) > 1e-4f;
    EXPECT_LT(differ, a.pixels.size() / 50) << static_cast<int>(basis);
  }
}

// Maps of large grooms are drawn from one strand in `stride`.
TEST(Only, MapsOfLightPickFromThoseThatAreDrawn) {
  const Scene scene = every_third(true);
  const StrandLines lines(scene.grooms[0]);
  EXPECT_EQ(lines.part_count(), scene.grooms[0].only->size());
  for (const std::size_t stride : {1u, 5u}) {
    const std::vector<StrandPart> picked = lines.pick(stride, view_from({0, 0, 2}));
    EXPECT_EQ(picked.size(), (scene.grooms[0].only->size() + stride - 1) / stride);
    for (const StrandPart& part : picked) EXPECT_EQ(part.strand % 3, 1u);
  }
}

/// Sum of a picture of the scene's first groom, from `distance` metres away.
double sum_from(Scene& scene, float distance, bool thick) {
  scene.camera.eye = {0.3f * distance, 0, distance}, scene.camera.target = {0, -0.1f, 0}, scene.camera.fov_y = 0.7f;
  scene.settings.thick_hairs.on = thick;
  const RenderResult picture = render(scene);
  double total = 0;
  for (std::size_t p = 0; p < picture.linear.pixels.size(); p += static_cast<std::size_t>(picture.linear.channel_count()))
    total += static_cast<double>(picture.linear.pixels[p]);
  return total;
}

// A picture from far away: thick hairs cover as much as their strands.
TEST(ThickHairs, KeepCoverageFarAway) {
  Scene scene;
  scene.grooms.push_back(groom_with_chain(6000));
  scene.settings.width = scene.settings.height = 256;
  scene.settings.samples = 16, scene.settings.view = View::kCoverage;
  for (const float distance : {4.f, 12.f, 40.f})
    EXPECT_NEAR(sum_from(scene, distance, true) / sum_from(scene, distance, false), 1, 0.03) << distance;
}

/// Light of thick hairs over that of their strands, far away and without shadows, under a light that is `degrees` from the eye.
double light_over_strands(HairStyle style, double degrees) {
  Scene scene;
  scene.grooms.push_back(kit::groom_with_chain(style, 6000, 3));
  scene.settings.width = scene.settings.height = 128, scene.settings.samples = 16;
  scene.settings.dual_scattering = false, scene.settings.shadows = false;
  scene.settings.background = {0, 0, 0}, scene.environment.radiance = {0, 0, 0};
  const double turned = std::atan(0.3) + degrees * 3.14159265358979 / 180;
  Light light;
  light.type = Light::Type::kDirectional;
  light.direction = normalize({static_cast<float>(-std::sin(turned)), -0.36f, static_cast<float>(-std::cos(turned))});
  light.intensity = {3, 3, 3};
  scene.lights = {light};
  return sum_from(scene, 12, true) / sum_from(scene, 12, false);
}

// Curls lean to all sides: as one fiber at their mean inclination afro hair would have three times the light from aside.
TEST(ThickHairs, ShineAsTheirStrandsDo) {
  for (const double degrees : {0., 45., 90., 135., 180.})
    EXPECT_NEAR(light_over_strands(HairStyle::kAfro, degrees), 1, 0.3) << degrees;
}

// Maps of lights need no more texels than are seen.
TEST(ThickHairs, SmallHairTakesSmallMaps) {
  Scene scene;
  scene.grooms.push_back(groom_with_chain());
  ThickHairs thick(scene);
  const auto size_of = [](ThickHairs& hairs, const Scene& of, float distance) {
    hairs.choose(of, view_from({0, 0, distance}));
    return hairs.drawn(of, view_from({0, 0, distance})).settings.opacity_map_size;
  };
  const auto size = [&](float distance) { return size_of(thick, scene, distance); };
  EXPECT_EQ(size(0.1f), scene.settings.opacity_map_size);
  EXPECT_EQ(size(1000), 64);
  EXPECT_TRUE(thick.changed());
  const int middle = size(8);
  EXPECT_GT(middle, 64);
  EXPECT_LT(middle, scene.settings.opacity_map_size);
  EXPECT_EQ(size(8), middle);
  EXPECT_FALSE(thick.changed());
  scene.grooms.push_back(scene.grooms[0]);
  scene.grooms[1].lod = nullptr;  // of which it is not known how large it is
  ThickHairs other(scene);
  EXPECT_EQ(size_of(other, scene, 1000), scene.settings.opacity_map_size);
}

}  // namespace
}  // namespace pelage
