// Flyaway parts of strands whose place on the screen is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/metrics.h>
#include <pelage/runtime.h>

#include <memory>

#include "core/rng.h"

namespace pelage {
namespace {

/// 100 × 80 pixels of a centimeter each, looking along −z; strands are a fifth of a pixel wide.
Scene scene_of(const std::vector<std::vector<Vec3>>& strands, float width = 0.002f) {
  auto set = std::make_shared<StrandSet>();
  set->offsets = {0}, set->widths = {width}, set->basis = CurveBasis::kLinear;
  for (const auto& points : strands) {
    set->points.insert(set->points.end(), points.begin(), points.end());
    set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
  }
  Scene scene;
  scene.settings.width = 100, scene.settings.height = 80;
  scene.camera.projection = Camera::Projection::kOrthographic;
  scene.camera.eye = {0, 0, 5}, scene.camera.target = {0, 0, 0}, scene.camera.height = 0.8f;
  scene.grooms.emplace_back().strands = set;
  return scene;
}

/// Where pixel (x, y) is in the world.
Vec3 at(float x, float y, float z = 0) { return {(x - 50) / 100, (40 - y) / 100, z}; }

TEST(FlyawayPaths, AreTheStrandInSteps) {
  const FlyawayPaths paths = flyaway_paths(scene_of({{at(20.1f, 30.5f), at(60.1f, 30.5f), at(60.6f, 70)}}));
  ASSERT_EQ(paths.part_count(), 1u);
  EXPECT_EQ(paths.width, 100);
  EXPECT_EQ(paths.height, 80);
  ASSERT_NEAR(static_cast<double>(paths.places.size()), 2 * 79.5, 2);
  EXPECT_NEAR(paths.places[0].x, 20.1, 1e-3);
  EXPECT_NEAR(paths.places[0].y, 30.5, 1e-3);
  for (std::size_t i = 0; i + 1 < paths.places.size(); ++i)
    EXPECT_NEAR(length(paths.places[i + 1] - paths.places[i]), 0.5, i == 79 || i == 80 ? 0.15 : 1e-3) << i;
}

TEST(FlyawayPaths, EndAtTheBorder) {
  const FlyawayPaths paths = flyaway_paths(scene_of({{at(-500, 30.5f), at(500, 30.5f)}, {at(20, 10.5f), at(150, 10.5f)}}));
  ASSERT_EQ(paths.part_count(), 2u);
  for (const Vec2 p : paths.places) EXPECT_TRUE(p.x >= 0 && p.x < 100 && p.y >= 0 && p.y < 80) << p.x;
  EXPECT_NEAR(paths.offsets[2] - paths.offsets[1], 160, 2);
}

TEST(FlyawayPaths, LeaveOutDenseHair) {
  std::vector<std::vector<Vec3>> strands = {{at(10, 30.5f), at(90, 30.5f)}};
  for (int i = 0; i < 40; ++i)
    strands.push_back({at(40 + 0.25f * static_cast<float>(i), 0), at(40 + 0.25f * static_cast<float>(i), 80)});
  const FlyawayPaths paths = flyaway_paths(scene_of(strands));
  ASSERT_EQ(paths.part_count(), 2u) << "before and behind the lock";
  for (const Vec2 p : paths.places) EXPECT_TRUE(p.x < 40.01f || p.x > 49.7f) << p.x;
  EXPECT_EQ(flyaway_paths(scene_of(strands), 1.1f).part_count(), 41u) << "unless all coverage counts";
}

TEST(FlyawayPaths, StayInFrontOfMeshes) {
  Scene scene = scene_of({{at(10, 30.5f, -1), at(90, 30.5f, -1)}, {at(10, 30.5f, 1), at(90, 30.5f, 1)}}, 0.001f);
  auto wall = std::make_shared<TriangleMesh>();
  wall->positions = {at(50, -10), at(50, 90), at(75, 90), at(75, -10)};
  wall->triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.emplace_back().mesh = wall;
  const FlyawayPaths paths = flyaway_paths(scene);
  ASSERT_EQ(paths.part_count(), 3u) << "left and right of the wall, and before it, though the picture shows hair all along";
  for (std::size_t i = 0; i < paths.offsets[2]; ++i)
    EXPECT_TRUE(paths.places[i].x < 50.1f || paths.places[i].x > 74.9f) << paths.places[i].x;
}

TEST(FlyawayPaths, LeaveOutWhatIsShort) {
  const Scene scene = scene_of({{at(10, 30.5f), at(17, 30.5f)}, {at(10, 50.5f), at(19, 50.5f)}});
  EXPECT_EQ(flyaway_paths(scene).part_count(), 1u);
  EXPECT_EQ(flyaway_paths(scene, kFlyawayCoverage, 5).part_count(), 2u);
}

TEST(FlyawayPaths, SameForAnyThreads) {
  std::vector<std::vector<Vec3>> strands;
  for (std::uint32_t i = 0; i < 600; ++i) {
    const RandomBits r = pcg4d(i, 7, 0, 0);
    const auto u = [](std::uint32_t bits) { return 80 * uniform_from_bits(bits); };
    strands.push_back({at(u(r.x), u(r.y)), at(u(r.z), u(r.w))});
  }
  const Scene scene = scene_of(strands, 0.0005f);
  set_thread_count(1);
  const FlyawayPaths alone = flyaway_paths(scene);
  set_thread_count(3);
  const FlyawayPaths together = flyaway_paths(scene);
  set_thread_count(0);
  ASSERT_GT(alone.part_count(), 100u);
  EXPECT_EQ(alone.offsets, together.offsets);
  EXPECT_EQ(alone.places, together.places);
}

TEST(FlyawayPaths, OfNoHairAreNone) {
  Scene scene = scene_of({});
  EXPECT_EQ(flyaway_paths(scene).part_count(), 0u);
}

}  // namespace
}  // namespace pelage
