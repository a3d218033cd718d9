// Pictures of hair that moves: motion vectors beside where things were, and pictures that are blended over time.
#include <gtest/gtest.h>
#include <pelage/animation.h>
#include <pelage/error.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rotation.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/reproject.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr int kWidth = 128, kHeight = 96;

/// The head in frame `f`: a turn about a slanted axis, and a shift.
Rigid head_in(int f) {
  const float half = 0.02f * static_cast<float>(f);
  return {{std::cos(half), normalize(Vec3(0.3f, 1, 0.1f)) * std::sin(half)},
          Vec3(0.003f, -0.002f, 0.001f) * static_cast<float>(f)};
}

/// Frames 0 to 3 of `strands` on that head; `bent` sways tips aside as well.
Scene moving_scene(StrandSet strands, float bent) {
  Scene scene;
  scene.settings.width = kWidth, scene.settings.height = kHeight, scene.settings.opacity_map_size = 128;
  LodHierarchy lod = build_lod(strands, {.levels = 2, .guides = 12, .memory_share = 50});
  auto animation = std::make_shared<GuideAnimation>();
  animation->first_frame = 0;
  for (int f = 0; f < 4; ++f) {
    const Rigid head = head_in(f);
    for (std::size_t i = 0; i < lod.guides.size(); ++i) {
      const float t = static_cast<float>(i % kPoints) / (kPoints - 1);
      const float phase = static_cast<float>(i / kPoints);
      animation->guides.push_back(
          head(lod.guides[i] + Vec3(std::sin(phase), 0.3f, std::cos(phase)) * (bent * t * t * static_cast<float>(f))));
    }
    animation->head.push_back(to_affine(head));
  }
  lod.animation = animation;
  GroomInstance& groom = scene.grooms.emplace_back();
  groom.strands = std::make_shared<StrandSet>(std::move(strands)), groom.lod = std::make_shared<LodHierarchy>(std::move(lod));
  test::add_tile(scene);
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

Image view_of(const Scene& scene, View view, int frame) {
  Scene now = at_frame(scene, frame), before = at_frame(scene, frame - 1);
  now.settings.view = before.settings.view = view;
  return PictureSequence(before).next(now).linear;
}

Vec2 center(int x, int y) { return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}; }

/// Where `before` sees the point that `now` sees at `at`, when all has moved with the head from frame f − 1 to f.
Vec2 rigid_motion(const CameraView& view, Vec2 at, float depth, int f) {
  const Vec3 here = transform_point(view.camera_to_world, unproject(view, at, depth));
  const Vec3 there = head_in(f - 1)(undo(head_in(f), here));
  return project(view, transform_point(view.world_to_camera, there)) - at;
}

/// Depth of the tile (z = 0 at rest) below a pixel in frame f.
float tile_depth(const CameraView& view, Vec2 at, int f) {
  const Ray ray = camera_ray(view, at.x, at.y);
  const Vec3 o = undo(head_in(f), ray.origin), d = inverse(head_in(f).turn)(ray.direction);
  return -o.z / d.z;
}

/// How levels of detail are chosen: pixels, blend.
using Levels = std::pair<float, float>;
class RigidMotion : public testing::TestWithParam<Levels> {};

TEST_P(RigidMotion, IsThatOfTheHead) {
  Scene scene = moving_scene(test::helices(300, 24, 0.004f, 4e-4f), 0);
  const auto [pixels, blend] = GetParam();
  scene.settings.thick_hairs.pixels = pixels, scene.settings.thick_hairs.blend = blend;
  scene.settings.thick_hairs.on = pixels > 0.2f;
  const Image motion = view_of(scene, View::kMotion, 2), depth = view_of(scene, View::kDepth, 2);
  const CameraView view = make_camera_view(scene.camera, kWidth, kHeight);
  int hairs = 0, tile = 0;
  float most = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float* m = motion.at(x, y);
      if (m[3] == 0) continue;
      const bool hair = depth.at(x, y)[3] > 0;
      (hair ? hairs : tile)++;
      const float z = hair ? depth.at(x, y)[0] : tile_depth(view, center(x, y), 2);
      const Vec2 expected = rigid_motion(view, center(x, y), z, 2);
      ASSERT_NEAR(m[0], expected.x, hair ? 0.1f : 2e-3f) << x << ", " << y << (hair ? " hair" : " tile");
      ASSERT_NEAR(m[1], expected.y, hair ? 0.1f : 2e-3f) << x << ", " << y << (hair ? " hair" : " tile");
      most = std::max(most, length(expected));
    }
  EXPECT_GT(most, 1);
  EXPECT_GT(hairs, 500);
  EXPECT_GT(tile, 20);
}

INSTANTIATE_TEST_SUITE_P(WidestThickHairs, RigidMotion,
                         testing::Values(Levels(0.1f, 0), Levels(1.5f, 0), Levels(4, 0), Levels(64, 0), Levels(2, 0.9f),
                                         Levels(6, 0.9f)));

/// The curves of a groom as many points: where they are in two poses, in pixels, and their depth now.
struct Track {
  Vec2 now, before;
  float depth;
};
std::vector<Track> tracks_of(const StrandSet& now, const StrandSet& before, const CameraView& view) {
  constexpr int kSteps = 24;
  std::vector<Track> tracks;
  const auto seen = [&](const StrandSet& set, std::size_t i, std::size_t first, std::size_t last, float t) {
    const Vec3 p1 = set.points[i], p2 = set.points[i + 1];
    const Vec3 p0 = i > first ? set.points[i - 1] : p1 * 2.f - p2, p3 = i + 2 < last ? set.points[i + 2] : p2 * 2.f - p1;
    const Vec4 w = basis_weights(set.basis, t);
    return transform_point(view.world_to_camera, p0 * w.x + p1 * w.y + p2 * w.z + p3 * w.w);
  };
  for (std::size_t s = 0; s < now.strand_count(); ++s)
    for (std::size_t i = now.offsets[s]; i + 1 < now.offsets[s + 1]; ++i)
      for (int k = 0; k < kSteps; ++k) {
        const float t = static_cast<float>(k) / kSteps;
        const Vec3 c = seen(now, i, now.offsets[s], now.offsets[s + 1], t),
                   d = seen(before, i, now.offsets[s], now.offsets[s + 1], t);
        tracks.push_back({project(view, c), project(view, d), c.z});
      }
  return tracks;
}

/// Largest and mean error of motion vectors, pixels, beside the track that is nearest to each pixel at its depth.
void expect_tracks(const Image& motion, const Image& depth, const std::vector<Track>& tracks, double most_mean) {
  double sum = 0;
  int pixels = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (!(depth.at(x, y)[3] > 0)) continue;
      const Vec2 at = center(x, y);
      const Track* best = nullptr;
      float nearest = 4;
      for (const Track& t : tracks) {
        if (std::fabs(t.depth - depth.at(x, y)[0]) > 1e-3f) continue;
        const Vec2 off = t.now - at;
        if (const float d = dot(off, off); d < nearest) nearest = d, best = &t;
      }
      if (!best) continue;
      const Vec2 error = Vec2(motion.at(x, y)[0], motion.at(x, y)[1]) - (best->before - best->now);
      sum += static_cast<double>(length(error)), ++pixels;
    }
  ASSERT_GT(pixels, 300);
  EXPECT_LT(sum / pixels, most_mean);
}

TEST(BendingMotion, IsThatOfEachStrand) {
  Scene scene = moving_scene(test::helices(40, 24, 0.004f, 8e-4f), 0.01f);
  scene.meshes.clear();
  scene.settings.thick_hairs.on = false;
  const CameraView view = make_camera_view(scene.camera, kWidth, kHeight);
  const auto tracks = tracks_of(*at_frame(scene, 3).grooms[0].strands, *at_frame(scene, 2).grooms[0].strands, view);
  expect_tracks(view_of(scene, View::kMotion, 3), view_of(scene, View::kDepth, 3), tracks, 0.05);
}

TEST(BendingMotion, IsThatOfEachThickHair) {
  Scene scene = moving_scene(test::helices(200, 24, 0.002f, 8e-4f), 0.01f);
  scene.meshes.clear();
  scene.settings.thick_hairs.pixels = 64;
  const CameraView view = make_camera_view(scene.camera, kWidth, kHeight);
  // Level 0 as grooms of the knots of its centers.
  const auto level = [&](int f) {
    const Scene posed = at_frame(scene, f);
    StrandSet set;
    set.offsets = {0}, set.basis = CurveBasis::kCatmullRom;
    for (std::size_t h = 0; h < posed.grooms[0].lod->level(0).size(); ++h) {
      const Vec3* c = &posed.grooms[0].lod->centers[h * kPoints];
      for (std::size_t k = 0; k < kPoints; ++k)
        set.points.push_back(k > 0 && k + 1 < kPoints ? (c[k - 1] + c[k] * 4.f + c[k + 1]) / 6.f : c[k]);
      set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
    }
    return set;
  };
  expect_tracks(view_of(scene, View::kMotion, 3), view_of(scene, View::kDepth, 3), tracks_of(level(3), level(2), view), 0.05);
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::pow(static_cast<double>(a.pixels[i] - b.pixels[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

TEST(MovingHair, BlendingOverTimeFollowsIt) {
  Scene scene = moving_scene(test::helices(300, 24, 0.004f, 2e-4f), 0);
  for (const Method method : {Method::kTaa, Method::kLinkTaa}) {
    scene.settings.method = method, scene.settings.samples = 1, scene.settings.frames = 8;
    PictureSequence sequence(at_frame(scene, 0)), still(at_frame(scene, 0));
    Image last, torn;
    for (int f = 0; f < 4; ++f) {
      last = sequence.next(at_frame(scene, f)).linear;
      // The same poses without their motion: each is told as a scene of its own that the history knows nothing of.
      Scene alone = at_frame(scene, f);
      torn = PictureSequence(alone).next(alone.camera).linear;
    }
    Scene truth = at_frame(scene, 3);
    truth.settings.method = Method::kSsaa, truth.settings.samples = 64;
    Scene one = truth;
    one.settings.samples = 1;
    const Image reference = render(truth).linear;
    if (method == Method::kTaa) {
      EXPECT_LT(rms(last, reference), 0.8 * rms(render(one).linear, reference));
    }
    EXPECT_LT(rms(last, reference), 2 * rms(torn, reference)) << static_cast<int>(method);
  }
}

TEST(MovingHair, APictureOfAFrameIsThatOfTheFrameAlone) {
  Scene scene = moving_scene(test::helices(100, 16), 0.01f);
  scene.settings.thick_hairs.level = 1;  // levels that are chosen depend on the frame before
  PictureSequence sequence(at_frame(scene, 0));
  for (int f = 1; f < 4; ++f)
    EXPECT_EQ(sequence.next(at_frame(scene, f)).linear.pixels, render(at_frame(scene, f)).linear.pixels) << f;
}

TEST(MovingHair, AnotherSceneIsRefused) {
  const Scene scene = moving_scene(test::helices(100, 16), 0);
  PictureSequence sequence(scene);
  Scene other = scene;
  other.grooms.clear();
  EXPECT_THROW(sequence.next(other), Error);
  other = scene, other.grooms[0].strands = std::make_shared<StrandSet>(test::helices(99, 16));
  EXPECT_THROW(sequence.next(other), Error);
}

TEST(AtFrame, MovesHairAndMeshesWithTheHead) {
  Scene scene = moving_scene(test::helices(100, 16), 0);
  scene.grooms[0].transform.m[0][3] = 0.5f;
  for (int i = 0; i < 3; ++i) scene.grooms[0].transform.m[i][i] = 2;
  const Scene posed = at_frame(scene, 2);
  const Vec3 place(0.01f, 0.02f, 0.03f);  // of the groom, and of a mesh that stands in the world
  const Affine &groom = scene.grooms[0].transform, &mesh = posed.meshes[0].transform;
  EXPECT_LT(length(transform_point(mesh, transform_point(groom, place)) - transform_point(groom, head_in(2)(place))), 1e-6f);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_LT(length(posed.grooms[0].strands->points[i] - head_in(2)(scene.grooms[0].strands->points[i])), 1e-6f);
  EXPECT_EQ(transform_point(at_frame(scene, 2, true).meshes[0].transform, place), place);
  EXPECT_EQ(at_frame(scene, 9).grooms[0].strands->points, at_frame(scene, 3).grooms[0].strands->points);
  EXPECT_EQ(at_frame(scene, -9).grooms[0].strands->points, at_frame(scene, 0).grooms[0].strands->points);
  EXPECT_EQ(animated_frames(scene)->first, 0);
  EXPECT_EQ(animated_frames(scene)->last, 3);
  scene.grooms[0].lod = nullptr;
  EXPECT_FALSE(animated_frames(scene));
}

}  // namespace
}  // namespace pelage
