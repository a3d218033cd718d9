#include "lod/choose_levels.h"

#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/rng.h"
#include "frame/camera_view.h"

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

TEST(LevelBounds, HairsOfAPrismHoldItsStrands) {
  const LodHierarchy& lod = groom(HairStyle::kWavy).lod;
  const LevelBounds bounds(lod);
  ASSERT_EQ(bounds.prisms(), lod.level(0).size());
  for (std::size_t p = 0; p < bounds.prisms(); ++p)
    for (std::size_t l = 0; l < lod.levels(); ++l) {
      const LevelBounds::Range range = bounds.hairs(l, p);
      std::uint32_t next = lod.hairs[p].first_strand, fibers = 0;
      for (std::uint32_t h = range.first; h < range.last; ++h) {
        ASSERT_EQ(lod.hairs[h].first_strand, next);
        next += lod.hairs[h].fibers, fibers += lod.hairs[h].fibers;
      }
      ASSERT_EQ(fibers, lod.hairs[p].fibers);
    }
}

// Every hair of every level, one by one.
float widest_by_definition(const LodPlace& place, const LevelBounds::Range& hairs, std::size_t k) {
  float widest = 0;
  for (std::size_t h = hairs.first; h < hairs.last; ++h) {
    const std::size_t i = h * kPoints + k;
    const Vec3* c = &place.lod.centers[h * kPoints];
    const Vec3 center = transform_point(place.to_camera, c[k]);
    if (center.z < place.view.near_plane) return INFINITY;
    const auto turned = [&](Vec3 v) { return transform_vector(place.to_camera, v); };
    const Vec3 along = turned(c[std::min(k + 1, kPoints - 1)] - c[k == 0 ? 0 : k - 1]);
    const Vec3 to_eye = place.view.perspective ? Vec3() - center : Vec3(0, 0, -1);
    const float width = width_by_points(turned(place.lod.major[i]), turned(place.lod.minor[i]), along, to_eye);
    widest = std::fmax(widest, width * pixels_per_metre(place.view, center.z));
  }
  return widest;
}

TEST(ChooseLevels, TakesTheCoarsestThatIsNarrow) {
  std::size_t between = 0;
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kCurly})
    for (const Vec3 eye : {Vec3(0.3f, 0.2f, 1), Vec3(-4, 1, 3), Vec3(0, -1, 20)})
      for (const bool orthographic : {false, true}) {
        const LodHierarchy& lod = groom(style).lod;
        const LevelBounds bounds(lod);
        const CameraView view = view_from(eye, orthographic);
        const LodPlace place{lod, view, compose(view.world_to_camera, Affine())};
        for (const float pixels : {0.7f, 2.f, 9.f}) {
          const LodLevels levels = choose_levels(place, bounds, pixels);
          for (std::size_t p = 0; p < bounds.prisms(); p += 3)
            for (std::size_t k = 0; k < kLodSegments; ++k) {
              const std::size_t level = levels[p * kLodSegments + k];
              const auto widest = [&](std::size_t l) {
                return std::fmax(widest_by_definition(place, bounds.hairs(l, p), k),
                                 widest_by_definition(place, bounds.hairs(l, p), k + 1));
              };
              const float drawn = level < lod.levels() ? widest(level) : 0, coarser = level > 0 ? widest(level - 1) : INFINITY;
              ASSERT_LE(drawn, pixels * 1.001f);
              ASSERT_GE(coarser, pixels * 0.999f);
              between += level > 0 && level < lod.levels();
            }
        }
      }
  EXPECT_GT(between, 1000u);
}

// Eq. 16 with its hysteresis: what is drawn goes to a coarser level only when that is narrower by a tenth.
TEST(ChooseLevels, AWidthAtTheLimitDoesNotChangeLevelsBackAndForth) {
  const LodHierarchy& lod = groom(HairStyle::kWavy).lod;
  const LevelBounds bounds(lod);
  const auto at = [&](float distance, const LodLevels& before) {
    const CameraView view = view_from({0, 0, distance});
    return choose_levels({lod, view, compose(view.world_to_camera, Affine())}, bounds, 2, before);
  };
  LodLevels levels = at(8, {});
  for (int frame = 0; frame < 60; ++frame) ASSERT_EQ(at(8, levels), levels) << "a still camera";
  const auto changes = [&](bool remembering) {
    LodLevels now = at(8, {});
    std::size_t changed = 0;
    for (int frame = 0; frame < 20; ++frame) {
      const LodLevels next = at(frame % 2 ? 8 : 8.3f, remembering ? now : LodLevels());
      for (std::size_t i = 0; i < next.size(); ++i) changed += next[i] != now[i];
      now = next;
    }
    return changed;
  };
  EXPECT_GT(changes(false), 100u);
  EXPECT_EQ(changes(true), 0u);
  const LodLevels far = at(16, levels), never = at(16, {});
  std::size_t coarser = 0;
  for (std::size_t i = 0; i < far.size(); ++i) {
    ASSERT_GE(far[i], never[i]);
    coarser += far[i] < levels[i];
  }
  EXPECT_GT(coarser, far.size() / 20) << "who goes far enough away changes all the same";
}

TEST(ChooseLevels, BeforeTheNearPlaneThereAreStrands) {
  const LodHierarchy& lod = groom(HairStyle::kStraight).lod;
  const LevelBounds bounds(lod);
  const CameraView view = view_from({0, 0.1f, 0.01f});
  const LodLevels levels = choose_levels({lod, view, compose(view.world_to_camera, Affine())}, bounds, 64);
  EXPECT_GT(std::count(levels.begin(), levels.end(), lod.levels()), 0);
}

TEST(ChooseLevels, AnyNumberOfThreadsChoosesTheSame) {
  const LodHierarchy& lod = groom(HairStyle::kCurly).lod;
  const CameraView view = view_from({0, 0, 6});
  const LodPlace place{lod, view, compose(view.world_to_camera, Affine())};
  set_thread_count(1);
  const LodLevels one = choose_levels(place, LevelBounds(lod), 2);
  set_thread_count(3);
  EXPECT_EQ(choose_levels(place, LevelBounds(lod), 2), one);
  set_thread_count(0);
}

}  // namespace
}  // namespace pelage
