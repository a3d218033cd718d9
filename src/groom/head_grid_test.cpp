// Distances to meshes beside the slow way, and head motions.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/simulate.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/rng.h"
#include "groom/head_grid.h"
#include "groom/head_motion.h"

namespace pelage {
namespace {

TriangleMesh cube(bool turned_over) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v) mesh.positions.emplace_back(v & 1 ? 0.1f : -0.1f, v & 2 ? 0.1f : -0.1f, v & 4 ? 0.1f : -0.1f);
  for (const auto& [a, b, c, d] :
       {std::array<std::uint32_t, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    for (const auto& t : {std::array<std::uint32_t, 3>{a, b, c}, {a, c, d}}) {
      mesh.triangles.push_back(t);
      if (turned_over) std::swap(mesh.triangles.back()[1], mesh.triangles.back()[2]);
    }
  return mesh;
}

float distance_to_cube(Vec3 p) {
  const Vec3 d(std::fabs(p.x) - 0.1f, std::fabs(p.y) - 0.1f, std::fabs(p.z) - 0.1f);
  return length(max(d, {0, 0, 0})) + std::min(0.f, std::max({d.x, d.y, d.z}));
}

TEST(HeadGrid, ACubeHasItsDistancesWhicheverWayItWinds) {
  for (const bool turned_over : {false, true}) {
    const groom::DistanceGrid grid = groom::mesh_distance(cube(turned_over), 24, {});
    for (int z = 0; z < grid.nz; ++z)
      for (int y = 0; y < grid.ny; ++y)
        for (int x = 0; x < grid.nx; ++x)
          ASSERT_NEAR(grid.distance[grid.index(x, y, z)], distance_to_cube(grid.place(x, y, z)), 1e-6f)
              << x << " " << y << " " << z;
  }
}

TEST(HeadGrid, TheMannequinHasTheDistancesOfAllItsTriangles) {
  const TriangleMesh mesh = mannequin_head();
  const groom::DistanceGrid grid = groom::mesh_distance(mesh, 32, {});
  Rng rng(1, 7);
  float wrong_near = 0, wrong = 0;
  for (int i = 0; i < 300; ++i) {
    const auto any = [&](int n) { return std::min(n - 1, static_cast<int>(rng.uniform() * static_cast<float>(n))); };
    const int x = any(grid.nx), y = any(grid.ny), z = any(grid.nz);
    const Vec3 p = grid.place(x, y, z);
    float nearest = INFINITY;
    for (const auto& t : mesh.triangles)
      nearest = std::min(
          nearest,
          length(p - groom::nearest_on_triangle(p, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]).point));
    float& most = nearest < grid.spacing ? wrong_near : wrong;
    most = std::max(most, std::fabs(std::fabs(grid.distance[grid.index(x, y, z)]) - nearest));
  }
  EXPECT_LT(wrong_near, 1e-6f);
  EXPECT_LT(wrong, 0.2f * grid.spacing);
  EXPECT_LT(groom::sample_distance(grid, {0, 0.03f, 0}).distance, -0.04f);
  EXPECT_GT(groom::sample_distance(grid, {0, 0.15f, 0}).distance, 0.02f);
}

TEST(HeadGrid, TheNearestOfATriangleIsThatOfManyPoints) {
  Rng rng(3, 1);
  const auto any = [&] { return Vec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.f - Vec3(1, 1, 1); };
  for (int i = 0; i < 40; ++i) {
    const Vec3 a = any(), b = any(), c = any(), p = any();
    float least = INFINITY;
    constexpr int kSteps = 200;
    for (int u = 0; u <= kSteps; ++u)
      for (int v = 0; u + v <= kSteps; ++v)
        least = std::min(
            least, length(p - (a + (b - a) * (static_cast<float>(u) / kSteps) + (c - a) * (static_cast<float>(v) / kSteps))));
    const float d = length(p - groom::nearest_on_triangle(p, a, b, c).point);
    EXPECT_LE(d, least + 1e-5f);
    EXPECT_GT(d, least - 0.02f);
  }
}

TEST(HeadGrid, MistakesAreNamed) {
  EXPECT_THROW(make_head_shape({}), Error);
  TriangleMesh mesh = cube(false);
  EXPECT_THROW(make_head_shape(mesh, 4), Error);
  mesh.triangles[0][0] = 99;
  EXPECT_THROW(make_head_shape(mesh), Error);
}

TEST(HeadMotion, PassesItsKeysSmoothlyAndRestsAtBothEnds) {
  const float half = std::sqrt(0.5f);
  HeadMotion motion;
  motion.pivot = {0, -0.1f, 0};
  motion.keys = {{0, {}}, {0.5, {0.1f, 0, 0}, {0, half, 0, half}}, {1.5, {0, 0.2f, 0}, {0, 0, -half, -half}}, {2, {}}};
  for (const HeadKey& key : motion.keys) {
    const Rigid pose = groom::head_pose(motion, key.time);
    EXPECT_LT(length(pose(motion.pivot) - motion.pivot - key.translation), 1e-6f);
  }
  EXPECT_LT(length(transform_vector(head_at(motion, 0.5), {1, 0, 0}) - Vec3(0, 0, -1)), 1e-6f);
  const auto place = [&](double t) { return transform_point(head_at(motion, t), {0.1f, 0.2f, 0.3f}); };
  constexpr double kStep = 1e-3;
  for (double t = -0.01; t < 2.01; t += kStep) {
    const Vec3 speed = place(t + kStep) - place(t), before = place(t) - place(t - kStep);
    ASSERT_LT(length(speed - before), 2e-5f) << t;
    const Affine a = head_at(motion, t);
    ASSERT_NEAR(length(Vec3(a.m[0][0], a.m[0][1], a.m[0][2])), 1, 1e-5f);
  }
  EXPECT_EQ(place(-1), place(0));
  EXPECT_EQ(place(3), place(2));
}

TEST(HeadMotion, ThoseWithANameBeginAtRest) {
  for (const std::string& name : head_motion_names()) {
    const HeadMotion motion = head_motion(name, 3, {0, -0.1f, 0});
    EXPECT_LT(length(transform_point(head_at(motion, 0), {0, 0.1f, 0.1f}) - Vec3(0, 0.1f, 0.1f)), 1e-6f) << name;
    float most = 0;
    for (int i = 0; i < 60; ++i)
      most = std::max(most, length(transform_point(head_at(motion, 0.05 * i), {0, 0.1f, 0.1f}) - Vec3(0, 0.1f, 0.1f)));
    EXPECT_EQ(most > 0.01f, name != "still") << name;
    EXPECT_GE(motion.keys.empty() ? 3 : motion.keys.back().time, 3) << name;
  }
}

}  // namespace
}  // namespace pelage
