#include "groom/roots.h"

#include <gtest/gtest.h>
#include <pelage/error.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "groom/frames.h"
#include "groom/point_grid.h"

namespace pelage::groom {
namespace {

/// 1 m × 1 m, made of a large and a small triangle on each side of a diagonal that is cut unevenly.
TriangleMesh plate() {
  TriangleMesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0.1f, 0, 0.2f}};
  m.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  m.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.1f, 0.2f}};
  return m;
}

float nearest_pair(const std::vector<Root>& roots, std::size_t count) {
  float best = INFINITY;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j) best = std::min(best, length(roots[i].position - roots[j].position));
  return best;
}

TEST(ScatterRoots, EveryPrefixIsSpreadEvenly) {
  const std::vector<Root> roots = scatter_roots(plate(), 2000, 3);
  ASSERT_EQ(roots.size(), 2000u);
  for (const std::size_t count : {100u, 500u, 2000u})
    EXPECT_GT(nearest_pair(roots, count), 0.5f / std::sqrt(static_cast<float>(count))) << count;
}

TEST(ScatterRoots, AnotherSeedIsAnotherPlaceForEveryRoot) {
  const std::vector<Root> one = scatter_roots(plate(), 300, 1), again = scatter_roots(plate(), 300, 1);
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].position, again[i].position);
  for (const std::uint64_t seed : {std::uint64_t{2}, (std::uint64_t{1} << 40) + 1}) {  // the low half and the high
    for (const Root& other : scatter_roots(plate(), 300, seed))
      for (const Root& root : one) ASSERT_NE(other.position, root.position) << seed;
  }
}

TEST(ScatterRoots, FollowsAreaNotTriangles) {
  const std::vector<Root> roots = scatter_roots(plate(), 4000, 5);
  int quadrant[4] = {};
  for (const Root& r : roots) ++quadrant[(r.position.x > 0.5f ? 1 : 0) + (r.position.z > 0.5f ? 2 : 0)];
  for (const int n : quadrant) EXPECT_NEAR(n, 1000, 40);
}

TEST(ScatterRoots, FollowsTheDensity) {
  const std::vector<Root> roots = scatter_roots(plate(), 3000, 5, [](Vec3 p) {
    return p.x < 0.5f ? 0.f : p.z < 0.5f ? 1.f : 0.5f;
  });
  int sparse = 0;
  for (const Root& r : roots) {
    EXPECT_GE(r.position.x, 0.5f);
    sparse += r.position.z > 0.5f;
  }
  EXPECT_GT(sparse, 850);  // 1000 by density; the discs even it out a little
  EXPECT_LT(sparse, 1350);
}

TEST(ScatterRoots, InterpolatesUvAndFallsBackToFaceNormals) {
  for (const Root& r : scatter_roots(plate(), 50, 1)) {
    EXPECT_NEAR(r.uv.x, r.position.x, 1e-5f);
    EXPECT_NEAR(r.uv.y, r.position.z, 1e-5f);
    EXPECT_NEAR(std::abs(r.normal.y), 1, 1e-5f);
  }
}

TEST(ScatterRoots, FillsATinySurfaceToTheLast) {
  TriangleMesh sliver;
  sliver.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-4f, 0}};
  sliver.triangles = {{0, 1, 2}};
  EXPECT_EQ(scatter_roots(sliver, 500, 1).size(), 500u);
}

TEST(PointGrid, AgreesWithLookingAtEveryPoint) {
  PointGrid grid(0.1f, 64);  // fewer than it gets: buckets are shared
  std::vector<Vec3> points;
  Rng rng(7, 1);
  const auto draw = [&] {
    const float x = rng.uniform() * 2 - 1, y = rng.uniform() * 0.3f;
    return Vec3(x, y, rng.uniform() * 2 - 1);
  };
  for (int i = 0; i < 400; ++i) points.push_back(draw()), grid.insert(points.back());
  for (int query = 0; query < 200; ++query) {
    const Vec3 p = draw() * (query % 10 == 0 ? 20.f : 1.f);
    std::vector<std::pair<float, std::uint32_t>> sorted;
    for (std::uint32_t i = 0; i < points.size(); ++i) sorted.push_back({dot(points[i] - p, points[i] - p), i});
    std::sort(sorted.begin(), sorted.end());
    std::uint32_t index[5];
    float d2[5];
    ASSERT_EQ(grid.nearest(p, 5, index, d2), 5);
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(index[k], sorted[k].second);
    for (const float radius : {0.02f, 0.1f, 0.35f}) EXPECT_EQ(grid.any_within(p, radius), sorted[0].first < radius * radius);
  }
}

TEST(PointGrid, FewerPointsThanAskedFor) {
  PointGrid grid(1, 2);
  std::uint32_t index[3];
  float d2[3];
  EXPECT_EQ(grid.nearest({0, 0, 0}, 3, index, d2), 0);
  grid.insert({100, 0, 0});
  EXPECT_EQ(grid.nearest({0, 0, 0}, 3, index, d2), 1);
  EXPECT_EQ(index[0], 0u);
}

TEST(Frames, AreOrthonormalAlongAnyCurve) {
  std::vector<Vec3> p, side(40), up(40);
  for (int i = 0; i < 40; ++i) {
    const float t = 0.3f * static_cast<float>(i);
    p.push_back({std::cos(t), 0.2f * t, std::sin(2 * t)});
  }
  p[20] = p[19];  // a repeated point
  rotation_minimizing_frames(p.data(), 40, {0, 1, 0}, side.data(), up.data());
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_NEAR(length(side[i]), 1, 1e-5f);
    EXPECT_NEAR(length(up[i]), 1, 1e-5f);
    EXPECT_NEAR(dot(side[i], up[i]), 0, 1e-5f);
    const Vec3 tangent = normalize(p[std::min<std::size_t>(i + 1, 39)] - p[i > 0 ? i - 1 : 0]);
    EXPECT_NEAR(dot(cross(side[i], up[i]), tangent), 1, 1e-4f);
  }
}

TEST(Frames, DoNotTwistAlongAPlaneCurve) {
  std::vector<Vec3> p, side(50), up(50);
  for (int i = 0; i < 50; ++i) p.push_back({std::cos(0.1f * static_cast<float>(i)), std::sin(0.1f * static_cast<float>(i)), 0});
  rotation_minimizing_frames(p.data(), 50, {0, 0, 1}, side.data(), up.data());
  for (const Vec3 s : side) EXPECT_NEAR(s.z, 1, 1e-4f);
}

TEST(Frames, StraightAlongTheNormalStillHasAFrame) {
  const Vec3 p[3] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
  Vec3 side[3], up[3];
  rotation_minimizing_frames(p, 3, {0, 1, 0}, side, up);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(length(side[i]), 1, 1e-5f);
}

}  // namespace
}  // namespace pelage::groom
