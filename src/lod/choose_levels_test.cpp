#include "lod/choose_levels.h"

#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/section.h"
#include "lod/draw_levels.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

struct Groom {
  StrandSet strands;
  LodHierarchy lod;
};
const Groom& groom(HairStyle style) {
  static std::map<HairStyle, Groom> kept;
  Groom& g = kept[style];
  if (!g.lod.empty()) return g;
  GrowSettings s = grow_defaults(style);
  s.strands = 1500, s.points = 24;
  g.strands = grow(s, mannequin_head());
  g.lod = build_lod(g.strands, {.levels = 4, .guides = 24, .memory_share = 5});
  return g;
}

CameraView view_from(Vec3 eye, bool orthographic = false) {
  Camera camera;
  camera.eye = eye, camera.target = {0, -0.1f, 0};
  if (orthographic) camera.projection = Camera::Projection::kOrthographic, camera.height = length(eye);
  return make_camera_view(camera, 800, 600);
}

// By its definition: every place of the ellipse, across the hair as it is seen.
float width_by_points(Vec3 major, Vec3 minor, Vec3 along, Vec3 to_eye) {
  const Vec3 across = normalize(cross(along, to_eye));
  float most = 0;
  for (int i = 0; i < 3600; ++i) {
    const float angle = static_cast<float>(i) * 6.2831853f / 3600;
    most = std::fmax(most, std::fabs(dot(major * std::cos(angle) + minor * std::sin(angle), across)));
  }
  return 2 * most;
}

TEST(SectionExtent, IsTheShadowOfTheEllipse) {
  Rng rng(7, 0);
  for (int i = 0; i < 200; ++i) {
    const auto random = [&] { return Vec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.f - Vec3(1, 1, 1); };
    const Vec3 along = random(), to_eye = random() * 5.f;
    const Vec3 a = normalize(cross(along, random())), b = normalize(cross(along, a));
    const Vec3 major = a * 0.3f, minor = b * 0.1f;
    const SectionExtent seen = section_extent(major, minor, along, to_eye);
    EXPECT_NEAR(seen.width, width_by_points(major, minor, along, to_eye), 2e-5f);
    // Width and thickness are those of two directions at a right angle.
    EXPECT_NEAR(seen.width * seen.width + seen.thickness * seen.thickness, 4 * (0.09f + 0.01f), 1e-5f);
  }
}

TEST(SectionExtent, FromItsEndAHairShowsItsAxes) {
  const SectionExtent seen = section_extent({2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 3});
  EXPECT_EQ(seen.width, 4);
  EXPECT_EQ(seen.thickness, 2);
}

struct Look {
  CameraView view;
  Affine to_world;
  LodPlace place(const LodHierarchy& lod) const { return {lod, view, compose(view.world_to_camera, to_world)}; }
};
std::vector<Look> looks() {
  const Affine turned{{{0, 0, 2, 0.1f}, {2, 0, 0, 0}, {0, 2, 0, -0.3f}}};  // and twice as large
  std::vector<Look> all;
  for (const Vec3 eye : {Vec3(0.3f, 0.2f, 1), Vec3(-4, 1, 3), Vec3(0, -1, 20)})
    for (const bool orthographic : {false, true})
      all.push_back({view_from(eye, orthographic), all.size() % 2 ? turned : Affine()});
  return all;
}

// Pixels, by its definition.
float width_by_definition(const LodPlace& place, std::size_t hair, std::size_t k) {
  const std::size_t i = hair * kPoints + k;
  const Vec3 center = transform_point(place.to_camera, place.lod.centers[i]);
  if (center.z < place.view.near_plane) return INFINITY;
  const auto turned = [&](Vec3 v) { return transform_vector(place.to_camera, v); };
  const Vec3 to_eye = place.view.perspective ? Vec3() - center : Vec3(0, 0, -1);
  return section_extent(turned(place.lod.major[i]), turned(place.lod.minor[i]), turned(hair_direction(place.lod, hair, k)),
                        to_eye)
             .width *
         pixels_per_metre(place.view, center.z);
}

TEST(HairWidths, AreTheShadowsOfTheSections) {
  const LodHierarchy& lod = groom(HairStyle::kCurly).lod;
  for (const Look& look : looks()) {
    const LodPlace place = look.place(lod);
    const LodEye eye(place);
    const float scale = similarity_scale(place.to_camera);
    for (std::uint32_t h = 0; h < lod.hair_count(); h += 5) {
      const HairWidths widths = hair_widths(lod, eye, h);
      for (std::size_t k = 0; k < kPoints; ++k) {
        const float pixels = width_by_definition(place, h, k);
        if (std::isinf(pixels)) {
          EXPECT_EQ(widths.pixels[k], pixels);
          continue;
        }
        ASSERT_NEAR(widths.pixels[k], pixels, 2e-3f * pixels) << h << ' ' << k;
        const float z = transform_point(place.to_camera, lod.centers[h * kPoints + k]).z;
        ASSERT_NEAR(widths.metres[k] * scale * pixels_per_metre(look.view, z), pixels, 2e-3f * pixels);
      }
    }
  }
}

TEST(HairErrors, AreTheGrainOfWhatIsCoveredBelowTheWidthOfTheHair) {
  const LodHierarchy& lod = groom(HairStyle::kCurly).lod;
  for (const Look& look : looks()) {
    const LodEye eye(look.place(lod));
    for (std::uint32_t h = 0; h < lod.hair_count(); h += 5) {
      const HairWidths widths = hair_widths(lod, eye, h);
      const HairErrors errors = hair_errors(lod, eye, h);
      const double crossed = lod.hairs[h].fibers * static_cast<double>(crossing_ratio(lod.length_ratios[h])),
                   lean = static_cast<double>(direction_variance(lod.length_ratios[h]));
      for (std::size_t k = 0; k < kPoints; ++k) {
        const auto metres = static_cast<double>(widths.metres[k]), pixels = static_cast<double>(widths.pixels[k]);
        const double covered = 1 - std::exp(-crossed * 2 * static_cast<double>(lod.radii[h * kPoints + k]) / metres);
        const double expected = (covered + 2 * lean) * pixels * std::max(1 / 1.5 - 1 / pixels, 0.);
        if (std::isinf(pixels)) {
          EXPECT_EQ(errors.variance[k], INFINITY);
          continue;
        }
        ASSERT_NEAR(static_cast<double>(errors.variance[k]), expected, 1e-3 * expected + 1e-5) << h << ' ' << k;
      }
    }
  }
}

TEST(PredictedFlip, GrowsWithTheVarianceUpToItsLimitAndBack) {
  EXPECT_EQ(predicted_flip(0), 0);
  float before = 0;
  for (const float x : {0.01f, 0.1f, 0.5f, 2.f, 10.f, 1000.f, INFINITY}) {
    const float flip = predicted_flip(x);
    EXPECT_GT(flip, before);
    if (x < 100) {
      EXPECT_NEAR(variance_for_flip(flip), x, 1e-3f * x);
    }
    before = flip;
  }
  EXPECT_EQ(variance_for_flip(before * 1.01f), INFINITY);
}

TEST(HairWidths, FromItsEndAHairShowsItsLongerAxis) {
  LodHierarchy lod;
  for (std::size_t k = 0; k < kPoints; ++k) {
    lod.centers.push_back({0, 0, -0.1f * static_cast<float>(k)});
    lod.major.push_back({0.02f, 0, 0}), lod.minor.push_back({0, 0.01f, 0});
  }
  const CameraView view = view_from({0, 0, 1});
  CameraView straight = view;
  straight.world_to_camera = {{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 1}}};
  const HairWidths widths = hair_widths(lod, LodEye({lod, straight, straight.world_to_camera}), 0);
  for (const float w : widths.metres) EXPECT_FLOAT_EQ(w, 0.04f);
}

TEST(PrismHairs, HoldTheirStrands) {
  const LodHierarchy& lod = groom(HairStyle::kWavy).lod;
  const PrismHairs prisms(lod);
  ASSERT_EQ(prisms.prisms(), lod.level(0).size());
  for (std::size_t p = 0; p < prisms.prisms(); ++p)
    for (std::size_t l = 0; l < lod.levels(); ++l) {
      const PrismHairs::Range range = prisms.hairs(l, p);
      std::uint32_t next = lod.hairs[p].first_strand, fibers = 0;
      for (std::uint32_t h = range.first; h < range.last; ++h) {
        ASSERT_EQ(lod.hairs[h].first_strand, next);
        next += lod.hairs[h].fibers, fibers += lod.hairs[h].fibers;
      }
      ASSERT_EQ(fibers, lod.hairs[p].fibers);
    }
}

// Of every hair: it is shown where it is narrow and none above it is.
TEST(ChooseLevels, TakesTheCoarsestThatIsNarrow) {
  std::size_t between = 0;
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kCurly})
    for (const Look& look : looks()) {
      const LodHierarchy& lod = groom(style).lod;
      const LodPlace place = look.place(lod);
      for (const float pixels : {0.7f, 2.f, 9.f}) {
        const LodCut cut = choose_levels(place, PrismHairs(lod), pixels);
        for (std::size_t h = 0; h < lod.hair_count(); h += 3)
          for (std::size_t k = 0; k < kLodSegments; ++k) {
            const auto widest = [&](std::size_t hair) {
              return std::fmax(width_by_definition(place, hair, k), width_by_definition(place, hair, k + 1));
            };
            const bool shown = shown_segments(lod, cut, h) >> k & 1, strands = cut[h] >> k & 1;
            ASSERT_TRUE(!shown || widest(h) <= pixels * 1.003f);
            ASSERT_TRUE(!strands || widest(h) >= pixels * 0.997f);
            for (std::uint32_t up = lod.hairs[h].parent; up != LodHierarchy::kNone; up = lod.hairs[up].parent)
              ASSERT_TRUE(!(shown || strands) || widest(up) >= pixels * 0.997f);
            between += shown && h >= lod.level_offsets[1];
          }
      }
    }
  EXPECT_GT(between, 1000u);
}

// A cut: on the way from the root of the tree to every strand exactly one hair, or else the strand, is shown at every segment.
TEST(ChooseLevels, ShowsEveryStrandOnce) {
  const LodHierarchy& lod = groom(HairStyle::kWavy).lod;
  for (const Look& look : looks()) {
    const LodCut cut = choose_levels(look.place(lod), PrismHairs(lod), 2);
    const std::size_t finest = lod.level_offsets[lod.levels() - 1];
    for (std::size_t h = finest; h < lod.hair_count(); ++h) {
      std::uint32_t seen = cut[h], twice = 0;
      for (std::size_t up = h; up != LodHierarchy::kNone; up = lod.hairs[up].parent) {
        const std::uint32_t shown = shown_segments(lod, cut, up);
        twice |= seen & shown, seen |= shown;
      }
      ASSERT_EQ(seen, kAllSegments);
      ASSERT_EQ(twice, 0u);
    }
  }
}

// Eq. 16 with its hysteresis: what is drawn goes to a coarser level only when that is narrower by a tenth.
TEST(ChooseLevels, AWidthAtTheLimitDoesNotChangeLevelsBackAndForth) {
  const LodHierarchy& lod = groom(HairStyle::kWavy).lod;
  const PrismHairs prisms(lod);
  const auto at = [&](float distance, const LodCut& before) {
    const CameraView view = view_from({0, 0, distance});
    return choose_levels({lod, view, compose(view.world_to_camera, Affine())}, prisms, 2, before);
  };
  const auto bits = [](const LodCut& cut) {
    std::size_t all = 0;
    for (const std::uint16_t c : cut) all += static_cast<std::size_t>(std::popcount(c));
    return all;
  };
  const LodCut cut = at(8, {});
  for (int frame = 0; frame < 60; ++frame) ASSERT_EQ(at(8, cut), cut) << "a still camera";
  const auto changes = [&](bool remembering) {
    LodCut now = at(8, {});
    std::size_t changed = 0;
    for (int frame = 0; frame < 20; ++frame) {
      const LodCut next = at(frame % 2 ? 8 : 8.3f, remembering ? now : LodCut());
      for (std::size_t h = 0; h < next.size(); ++h)
        changed += static_cast<std::size_t>(std::popcount(static_cast<std::uint16_t>(next[h] ^ now[h])));
      now = next;
    }
    return changed;
  };
  EXPECT_GT(changes(false), 100u);
  EXPECT_EQ(changes(true), 0u);
  const LodCut far = at(16, cut), never = at(16, {});
  for (std::size_t h = 0; h < far.size(); ++h) ASSERT_EQ(far[h] & never[h], never[h]);
  EXPECT_GT(bits(far), bits(never));
  EXPECT_LT(bits(far), bits(cut) * 9 / 10) << "who goes far enough away changes all the same";
}

// By definition, hair by hair: a segment shows its children where its parent does and more than the limit is predicted at one of its ends.
TEST(ChooseLevels, ByErrorTheCoarsestIsShownOfWhichNoMoreIsPredicted) {
  const LodHierarchy& lod = groom(HairStyle::kCurly).lod;
  const CameraView view = view_from({0, 0, 6});
  const LodPlace place{lod, view, compose(view.world_to_camera, Affine())};
  const LodEye eye(place);
  std::size_t before = SIZE_MAX;
  for (const float flip : {0.01f, 0.05f, 0.12f}) {
    const LodCut cut = choose_levels_by_error(place, PrismHairs(lod), flip);
    std::size_t split = 0;
    for (std::uint32_t h = 0; h < lod.hair_count(); ++h) {
      const HairErrors errors = hair_errors(lod, eye, h);
      const std::uint32_t parent = lod.hairs[h].parent, open = parent == LodHierarchy::kNone ? kAllSegments : cut[parent];
      for (std::size_t k = 0; k < kLodSegments; ++k) {
        const float worst = predicted_flip(std::max(errors.variance[k], errors.variance[k + 1]));
        if (std::fabs(worst / flip - 1) < 1e-4f) continue;  // rounding
        ASSERT_EQ(cut[h] >> k & 1, (open >> k & 1) && worst > flip) << h << ' ' << k;
        split += cut[h] >> k & 1;
      }
    }
    EXPECT_LT(split, before);
    before = split;
    EXPECT_EQ(choose_levels_by_error(place, PrismHairs(lod), flip, cut), cut) << "a still camera";
  }
  EXPECT_GT(before, 0u);
  const LodCut all = choose_levels_by_error(place, PrismHairs(lod), 0.3f);  // no picture differs by so much
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](auto c) { return c != 0; }), 0);
}

TEST(ChooseLevels, BeforeTheNearPlaneThereAreStrands) {
  const LodHierarchy& lod = groom(HairStyle::kStraight).lod;
  const CameraView view = view_from({0, 0.1f, 0.01f});
  const LodCut cut = choose_levels({lod, view, compose(view.world_to_camera, Affine())}, PrismHairs(lod), 64);
  EXPECT_GT(std::count_if(cut.begin() + lod.level_offsets[lod.levels() - 1], cut.end(), [](auto c) { return c != 0; }), 0);
}

TEST(ChooseLevels, AnyNumberOfThreadsChoosesTheSame) {
  const LodHierarchy& lod = groom(HairStyle::kCurly).lod;
  const CameraView view = view_from({0, 0, 6});
  const LodPlace place{lod, view, compose(view.world_to_camera, Affine())};
  set_thread_count(1);
  const LodCut one = choose_levels(place, PrismHairs(lod), 2);
  set_thread_count(3);
  EXPECT_EQ(choose_levels(place, PrismHairs(lod), 2), one);
  set_thread_count(0);
}

}  // namespace
}  // namespace pelage
