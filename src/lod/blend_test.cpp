// Levels of detail that blend: shares of what is drawn, what they cover, the light they stop, and pictures on the way from level to level.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/render.h>
#include <pelage/runtime.h>
#include <pelage/trace.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "frame/camera_view.h"
#include "frame/segment_lookup.h"
#include "frame/strand_part.h"
#include "kit/grown_chain.h"
#include "light/strand_lines.h"
#include "lod/choose_levels.h"
#include "lod/draw_levels.h"
#include "lod/thick_pieces.h"
#include "lod/fading_strands.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

const GroomInstance& groom() {
  static const GroomInstance wavy = kit::groom_with_chain(HairStyle::kWavy, 2000, 3);
  return wavy;
}
const LodHierarchy& chain() { return *groom().lod; }

LodPlace place_of(const LodHierarchy& lod, const CameraView& view) { return {lod, view, view.world_to_camera}; }

/// Hairs of `level` everywhere, of which `passed` of each is left to the next finer ones.
BlendedCut between_levels(const LodHierarchy& lod, std::size_t level, float passed) {
  BlendedCut cut{LodCut(lod.hair_count()), LodCut(lod.hair_count()), std::vector<float>(lod.hair_count() * kPoints)};
  for (std::size_t h = 0; h < lod.level_offsets[level + 1]; ++h) {
    const bool above = h < lod.level_offsets[level];
    const float share = above ? 1 : passed;
    std::fill_n(&cut.passed[h * kPoints], kPoints, share);
    cut.split[h] = share > 0 ? kAllSegments : 0, cut.shown[h] = share < 1 ? kAllSegments : 0;
  }
  if (level + 1 < lod.levels() && passed > 0)
    std::fill(cut.shown.begin() + lod.level_offsets[level + 1], cut.shown.begin() + lod.level_offsets[level + 2], kAllSegments);
  return cut;
}

std::vector<GroomInstance> draw(const GroomInstance& from, const BlendedCut& cut, const CameraView& view) {
  const StrandCuts cuts(*from.strands);
  return draw_levels(from, cut, cuts, CurveBasis::kCatmullRom, thick_hair_pen(*from.strands, place_of(*from.lod, view), &cut));
}

// s·n and (1 − s)·n fibers at random in a band pass in product what n do.
TEST(CoveredWidth, OfTwoSharesPassesWhatAllFibersPass) {
  for (const auto& [fiber, fibers] : {std::pair(0.02f, 7.f), {0.3f, 2.f}, {0.001f, 900.f}, {0.5f, 40.f}})
    for (const float share : {0.01f, 0.3f, 0.5f, 0.97f}) {
      const auto passes = [&](float n) { return 1 - covered_width(1, fiber, n); };
      EXPECT_NEAR(passes(share * fibers) * passes((1 - share) * fibers), passes(fibers), 2e-6f) << fiber << ' ' << share;
    }
  EXPECT_FLOAT_EQ(covered_width(1e-4f, 1e-4f, 0.25f), 0.25e-4f);
  EXPECT_FLOAT_EQ(covered_width(1e-4f, 2e-4f, 0.25f), 0.25e-4f);
  EXPECT_EQ(covered_width(1e-2f, 1e-4f, 0), 0);
}

// On the way from the root of the tree to every strand the shares of all that is drawn are 1, at every control point, and each is what its width says.
TEST(BlendedCut, SharesOfAllLevelsAreOne) {
  const GroomInstance deep = kit::groom_with_chain(HairStyle::kCurly, 3000, 6);
  const LodHierarchy& lod = *deep.lod;
  const CameraView view = kit::view_from({0, 0, 2});
  const LodPlace place = place_of(lod, view);
  const LodEye eye(place);
  const BlendedCut cut = choose_blended(place, PrismHairs(lod), 2, 0.5f);
  std::size_t partly = 0, once = 0;
  const auto expected = [&](std::size_t h, std::size_t k) {
    const float t = hair_widths(lod, eye, static_cast<std::uint32_t>(h)).pixels[k] - 1;  // from 1 pixel to 2
    const bool at_once = lod.hairs[h].children == 1 || lod.hairs[h].fibers == 1;
    return at_once ? (t > 0 ? 1.f : 0.f) : std::clamp(t, 0.f, 1.f);
  };
  for (std::size_t h = lod.level_offsets[lod.levels() - 1]; h < lod.hair_count(); ++h)
    for (std::size_t k = 0; k < kPoints; ++k) {
      float sum = cut.passed[h * kPoints + k], whole = 1;
      for (std::size_t up = h; up != LodHierarchy::kNone; up = lod.hairs[up].parent) {
        sum += cut.share(lod, up, k), partly += cut.share(lod, up, k) > 0.01f && cut.share(lod, up, k) < 0.99f;
        whole *= expected(up, k);
        once += lod.hairs[up].children == 1 && cut.share(lod, up, k) == 0 && cut.passed[up * kPoints + k] == 1;
      }
      ASSERT_NEAR(sum, 1, 1e-6f);
      ASSERT_NEAR(cut.passed[h * kPoints + k], whole, 1e-3f) << h << ' ' << k;
    }
  EXPECT_GT(partly, 1000u);
  EXPECT_GT(once, 1000u);
}

// What has a share is drawn, and what has none is not.
TEST(BlendedCut, DrawsSegmentsThatHaveAShare) {
  const LodHierarchy& lod = chain();
  for (const bool by_error : {false, true}) {
    const CameraView view = kit::view_from({0.3f, 0, 5});
    const LodPlace place = place_of(lod, view);
    const PrismHairs prisms(lod);
    const BlendedCut cut =
        by_error ? choose_blended_by_error(place, prisms, 0.08f, 0.4f) : choose_blended(place, prisms, 2, 0.4f);
    std::size_t both = 0;
    for (std::size_t h = 0; h < lod.hair_count(); ++h)
      for (std::size_t k = 0; k < kLodSegments; ++k) {
        const float *passed = &cut.passed[h * kPoints], own = std::max(cut.share(lod, h, k), cut.share(lod, h, k + 1));
        ASSERT_EQ(cut.shown[h] >> k & 1, own > 0) << h << ' ' << k;
        ASSERT_EQ(cut.split[h] >> k & 1, std::max(passed[k], passed[k + 1]) > 0) << h << ' ' << k;
        both += (cut.shown[h] & cut.split[h]) >> k & 1;
      }
    EXPECT_GT(both, 500u);
  }
}

// By predicted error: the limit is that of choose_levels_by_error(), and where less than (1 − β)² of its variance is predicted a hair is whole.
TEST(BlendedCut, ByErrorGoesByTheVariance) {
  const LodHierarchy& lod = chain();
  const CameraView view = kit::view_from({0, 0, 5});
  const LodPlace place = place_of(lod, view);
  const LodEye eye(place);
  const float most = variance_for_flip(0.08f);
  const BlendedCut cut = choose_blended_by_error(place, PrismHairs(lod), 0.08f, 0.4f);
  std::size_t partly = 0;
  for (std::uint32_t h = 0; h < lod.level_offsets[1]; ++h)
    for (std::size_t k = 0; k < kPoints && lod.hairs[h].children > 1; ++k) {
      const float x = hair_errors(lod, eye, h).variance[k] / most, t = std::clamp((x - 0.36f) / 0.64f, 0.f, 1.f);
      ASSERT_NEAR(cut.passed[std::size_t{h} * kPoints + k], t, 1e-4f);
      partly += t > 0 && t < 1;
    }
  EXPECT_GT(partly, 50u);
  const BlendedCut all = choose_blended_by_error(place, PrismHairs(lod), 0.3f, 0.4f);  // no picture differs by so much
  EXPECT_EQ(std::count_if(all.split.begin(), all.split.end(), [](auto c) { return c != 0; }), 0);
}

// Strands that fade keep all they have, and are as wide as their share; others are those of the groom. No place is in both.
TEST(FadingStrands, AreStrandsWithAShareOfTheirWidth) {
  const LodHierarchy& lod = chain();
  const StrandSet& whole = *groom().strands;
  BlendedCut cut = between_levels(lod, lod.levels() - 1, 1);
  for (std::size_t h = lod.level_offsets[lod.levels() - 1]; h < lod.hair_count(); ++h)
    for (std::size_t k = 0; k < kPoints; ++k) cut.passed[h * kPoints + k] = k < 5 ? 1 : k < 10 ? 0.25f : 0.75f;
  std::fill(cut.shown.begin() + lod.level_offsets[lod.levels() - 1], cut.shown.end(), std::uint16_t{0x7ff0});
  const auto drawn = draw(groom(), cut, kit::view_from({0, 0, 2}));
  ASSERT_EQ(drawn.size(), 3u);
  EXPECT_EQ(drawn[0].strands, groom().strands);
  EXPECT_EQ(drawn[0].shares, nullptr);
  const StrandSet& copies = *drawn[1].strands;
  validate(copies, "test");
  ASSERT_EQ(copies.strand_count(), whole.strand_count());
  EXPECT_EQ(copies.points, whole.points);
  EXPECT_EQ(copies.strand_id.size(), whole.strand_count());
  EXPECT_EQ(copies.colors, whole.colors);
  EXPECT_EQ(copies.root_uv, whole.root_uv);
  EXPECT_EQ(drawn[1].sections, nullptr);
  std::size_t middle = 0;
  for (std::size_t i = 0; i < copies.point_count(); ++i) {
    ASSERT_FLOAT_EQ(copies.widths[i], whole.width(i) * (*drawn[1].shares)[i]);
    middle += (*drawn[1].shares)[i] == 0.25f;
  }
  EXPECT_GT(middle, 3 * whole.strand_count());
  std::vector<std::uint32_t> spans(whole.strand_count());
  for (std::size_t g = 0; g < 2; ++g)
    for (const StrandPart& part : *drawn[g].only) {
      EXPECT_EQ(part.first_span == 0, g == 0);
      spans[part.strand] += part.spans;
    }
  for (std::uint32_t s = 0; s < spans.size(); ++s) ASSERT_EQ(spans[s], whole_strand(whole, s).spans);
}

// Shading asks how wide the fiber is, not how much of it is drawn.
TEST(FadingStrands, AreShadedAsWhatTheyAre) {
  const BlendedCut cut = between_levels(chain(), chain().levels() - 1, 0.3f);
  Scene scene;
  const CameraView view = kit::view_from({0, 0, 2});
  scene.grooms = draw(groom(), cut, view);
  ASSERT_EQ(scene.grooms.size(), 2u);
  SegmentNumbering numbering;
  numbering.subdivisions = {1, 1};
  const StrandSet& copies = *scene.grooms[0].strands;
  for (std::uint32_t s = 0; s < copies.strand_count(); s += 50) {
    const SegmentRef segment{0, s, 4, 0};
    const std::size_t i = copies.offsets[s] + 4;
    EXPECT_NEAR(surface_at(scene, numbering, segment, 0.5f).width,
                0.5f * (groom().strands->width(i) + groom().strands->width(i + 1)), 1e-8f);
  }
}

/// Hair that lights meet: area times crossings.
double stopping_area(const std::vector<GroomInstance>& grooms, const CameraView& view) {
  double sum = 0;
  for (const StrandLines& lines : strand_lines(grooms)) {
    LineBlock block;
    const std::vector<StrandPart> all = lines.pick(1, view);
    for (std::size_t i = 0; i < all.size();) {
      i = lines.fill(all, i, all.size(), 1, block);
      for (std::size_t j = 0; j + 1 < block.count; ++j) {
        const Vec3 way = Vec3(block.x[j + 1], block.y[j + 1], block.z[j + 1]) - Vec3(block.x[j], block.y[j], block.z[j]);
        sum += static_cast<double>(block.width[j] * block.density[j] * length(way));
      }
    }
  }
  return sum;
}

// Maps of lights meet as many fibers on the way from level to level as before and after.
TEST(LevelsThatBlend, StopLightAsOneLevelDoes) {
  const CameraView view = kit::view_from({1, 0.3f, 4});
  for (std::size_t level = 0; level < chain().levels(); ++level) {
    const auto area = [&](float passed) {
      return stopping_area(draw(groom(), between_levels(chain(), level, passed), view), view);
    };
    const double from = area(0), to = area(1);
    for (const double t : {0.2, 0.5, 0.8})
      EXPECT_NEAR(area(static_cast<float>(t)) / (from + (to - from) * t), 1, 1e-4) << level;
  }
}

struct Seen {
  double coverage = 0, light = 0;
};

void expect_between(double value, double from, double to, double tolerance) {
  EXPECT_LE(value, std::max(from, to) * (1 + tolerance));
  EXPECT_GE(value, std::min(from, to) * (1 - tolerance));
}

/// What a picture of `grooms` shows in sum.
Seen seen(std::vector<GroomInstance> grooms, const Camera& camera, int size) {
  Scene scene;
  scene.grooms = std::move(grooms), scene.camera = camera;
  for (GroomInstance& g : scene.grooms) g.lod = nullptr;
  scene.settings.width = scene.settings.height = size, scene.settings.samples = 16, scene.settings.background = {};
  scene.lights.emplace_back().direction = normalize(Vec3(-1, -0.4f, -0.6f));
  const auto sum = [&](std::size_t first, std::size_t last) {
    const Image picture = render(scene).linear;
    double total = 0;
    for (std::size_t p = 0; p < picture.pixels.size(); p += static_cast<std::size_t>(picture.channel_count()))
      for (std::size_t c = first; c < last; ++c) total += static_cast<double>(picture.pixels[p + c]);
    return total;
  };
  Seen s;
  s.light = sum(0, 3);
  scene.settings.view = View::kCoverage;
  s.coverage = sum(0, 1);
  return s;
}

// From level to level what is covered and the light that comes back stay between those of the two, less what a hair in the middle of its children hides of them.
TEST(LevelsThatBlend, CoverAndShineAsOneLevelDoes) {
  constexpr double kTolerance = 0.015;
  Camera camera;
  camera.eye = {3, 0.3f, 6}, camera.target = {0, -0.1f, 0}, camera.fov_y = 0.14f;
  const CameraView view = make_camera_view(camera, 160, 160);
  for (std::size_t level = 0; level < chain().levels(); ++level) {
    const auto at = [&](float passed) {
      return seen(draw(groom(), between_levels(chain(), level, passed), view), camera, 160);
    };
    const Seen from = at(0), to = at(1);
    ASSERT_GT(from.coverage, 500);
    for (const float t : {0.1f, 0.3f, 0.5f, 0.7f, 0.9f}) {
      const Seen now = at(t);
      expect_between(now.coverage, from.coverage, to.coverage, kTolerance);
      expect_between(now.light, from.light, to.light, kTolerance);
    }
  }
}

/// A tuft of parallel strands, which is one hair of one level.
GroomInstance tuft() {
  auto set = std::make_shared<StrandSet>();
  set->offsets = {0}, set->widths = {1.2e-4f};
  for (int s = 0; s < 40; ++s) {
    const float a = 2.4f * static_cast<float>(s), r = 0.002f * std::sqrt((static_cast<float>(s) + 0.5f) / 40);
    for (int i = 0; i <= 15; ++i)
      set->points.push_back({r * std::cos(a), 0.04f - 0.005f * static_cast<float>(i), r * std::sin(a)});
    set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
  }
  GroomInstance groom;
  groom.lod = std::make_shared<const LodHierarchy>(build_lod(*set, {.levels = 1, .guides = 1, .memory_share = 100}));
  groom.strands = set;
  return groom;
}

/// The largest change between neighboring pictures of a camera that goes away in small steps, root of the mean square.
double largest_step(float blend) {
  constexpr int kFrames = 60;
  Scene scene;
  scene.grooms.push_back(tuft());
  scene.settings.width = scene.settings.height = 128, scene.settings.samples = 16, scene.settings.background = {};
  scene.settings.thick_hairs.pixels = 16, scene.settings.thick_hairs.blend = blend;
  scene.lights.emplace_back().direction = normalize(Vec3(-1, -0.4f, -0.6f));
  PictureSequence sequence(scene);
  Image before;
  double largest = 0;
  for (int f = 0; f < kFrames; ++f) {
    Camera camera;
    camera.fov_y = 0.1f, camera.eye = {0, 0, 0.3f * std::pow(1.01f, static_cast<float>(f))}, camera.target = {};
    Image now = sequence.next(camera).linear;
    double sum = 0;
    for (std::size_t i = 0; f > 0 && i < now.pixels.size(); ++i)
      sum += std::pow(static_cast<double>(now.pixels[i] - before.pixels[i]), 2);
    largest = std::max(largest, std::sqrt(sum / static_cast<double>(now.pixels.size())));
    before = std::move(now);
  }
  return largest;
}

TEST(LevelsThatBlend, DoNotJump) { EXPECT_LT(largest_step(0.5f), 0.3 * largest_step(0)) << "what is left is motion"; }

TEST(LevelsThatBlend, AreTheSameForAnyNumberOfThreads) {
  Scene scene;
  scene.grooms.push_back(groom());
  scene.settings.width = scene.settings.height = 96, scene.settings.thick_hairs.blend = 0.6f;
  scene.camera.eye = {1, 0.3f, 3}, scene.camera.fov_y = 0.3f;
  scene.lights.push_back({});
  set_thread_count(1);
  const Image one = render(scene).linear;
  set_thread_count(2);
  EXPECT_EQ(render(scene).linear.pixels, one.pixels);
  set_thread_count(0);
  scene.settings.thick_hairs.blend = 0;
  EXPECT_NE(render(scene).linear.pixels, one.pixels);
}

TEST(LevelsThatBlend, AreRefusedWhereTheyCannotBe) {
  Scene scene;
  scene.grooms.push_back(groom());
  scene.settings.width = scene.settings.height = 8;
  ThickHairSettings& s = scene.settings.thick_hairs;
  const auto refused = [&](float blend, LodShape shape, int level) {
    s.blend = blend, s.shape = shape, s.level = level;
    try {
      render(scene);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(0.9f, LodShape::kThickHairs, -1));
  EXPECT_TRUE(refused(0.95f, LodShape::kThickHairs, -1));
  EXPECT_TRUE(refused(-0.1f, LodShape::kThickHairs, -1));
  EXPECT_TRUE(refused(NAN, LodShape::kThickHairs, -1));
  EXPECT_TRUE(refused(0.5f, LodShape::kStrands, -1));
  EXPECT_TRUE(refused(0.5f, LodShape::kCards, -1));
  EXPECT_TRUE(refused(0.5f, LodShape::kThickHairs, 1));
  s = {.blend = 0.9f};
  EXPECT_THROW(trace(with_thick_hairs(scene), {}), Error) << "levels that blend are not traced";
}

}  // namespace
}  // namespace pelage
