#include "groom/mannequin.h"

#include <gtest/gtest.h>
#include <pelage/grow.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "groom/head_shape.h"
#include "groom/surface_nets.h"

namespace pelage::groom {
namespace {

/// Every directed edge once, and its opposite once: closed, consistently wound, no edge with more than two faces.
void expect_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  std::size_t wrong = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    wrong += count != 1 || back == edges.end() || back->second != 1;
  }
  EXPECT_EQ(wrong, 0u);
}

Vec3 face_normal(const TriangleMesh& mesh, std::size_t t) {
  const auto& v = mesh.triangles[t];
  return cross(mesh.positions[v[1]] - mesh.positions[v[0]], mesh.positions[v[2]] - mesh.positions[v[0]]);
}

TEST(Mannequin, IsClosedAndOfAModestSize) {
  const TriangleMesh head = mannequin_head();
  expect_closed(head);
  EXPECT_GT(head.triangles.size(), 10000u);
  EXPECT_LT(head.triangles.size(), 50000u);
  ASSERT_EQ(head.normals.size(), head.positions.size());
  ASSERT_EQ(head.uv.size(), head.positions.size());
}

TEST(Mannequin, LiesOnItsSurface) {
  const TriangleMesh head = mannequin_head();
  std::size_t off = 0;
  for (const Vec3 p : head.positions) off += std::abs(head_distance(p)) > 2e-4f;
  EXPECT_LE(off, head.positions.size() / 200);  // creases, where the smooth unions are not smooth enough
}

TEST(Mannequin, NormalsPointOut) {
  const TriangleMesh head = mannequin_head();
  std::size_t against = 0;
  for (std::size_t t = 0; t < head.triangles.size(); ++t)
    for (const std::uint32_t v : head.triangles[t]) {
      EXPECT_NEAR(length(head.normals[v]), 1, 1e-4f);
      against += dot(head.normals[v], normalize(face_normal(head, t))) < 0.2f;
    }
  EXPECT_LE(against, head.triangles.size() * 3 / 200);
}

TEST(Mannequin, HasTheSizeOfAHeadAndFacesForward) {
  const TriangleMesh head = mannequin_head();
  Vec3 nose;
  float crown = -1;
  for (const Vec3 p : head.positions) {
    if (p.z > nose.z) nose = p;
    crown = std::max(crown, p.y);
  }
  EXPECT_NEAR(nose.x, 0, 0.004f);
  EXPECT_NEAR(nose.y, -0.034f, 0.008f);
  EXPECT_NEAR(crown + 0.115f, 0.235f, 0.01f);  // the chin ends 0.115 below the eyes
  EXPECT_GT(head_distance({0, -0.122f, 0.08f}), 0);
  EXPECT_LT(head_distance({0, -0.100f, 0.07f}), 0);
}

TEST(Mannequin, IsSymmetric) {
  for (const Vec3 p : {Vec3(0.03f, 0.01f, 0.09f), Vec3(0.08f, -0.02f, -0.01f), Vec3(0.12f, -0.2f, 0)})
    EXPECT_EQ(head_distance(p), head_distance({-p.x, p.y, p.z}));
}

TEST(Mannequin, ScalpUvHasNoSeam) {
  const TriangleMesh head = mannequin_head();
  for (const auto& t : head.triangles) {
    if (head.positions[t[0]].y < -0.08f) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 a = head.uv[t[i]], b = head.uv[t[(i + 1) % 3]];
      EXPECT_LT(length(a - b), 0.06f);
      EXPECT_GE(std::min(a.x, a.y), 0);
      EXPECT_LE(std::max(a.x, a.y), 1);
    }
  }
}

TEST(Mannequin, IsRecognizedAfterRounding) {
  TriangleMesh head = mannequin_head();
  EXPECT_TRUE(is_mannequin(head));
  for (Vec3& p : head.positions) p = p + Vec3(3e-5f, -3e-5f, 0);
  EXPECT_TRUE(is_mannequin(head));
  head.positions[7].x += 1e-3f;
  EXPECT_FALSE(is_mannequin(head));
}

float ball(Vec3 p) { return length(p) - 0.5f; }

TEST(SurfaceNets, BallIsClosedRoundAndWoundOutward) {
  const DistanceGrid grid = bake_distance(ball, {-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f}, 0.05f);
  const TriangleMesh mesh = surface_nets(grid);
  expect_closed(mesh);
  const auto count = [](std::size_t n) { return static_cast<long>(n); };
  EXPECT_EQ(count(mesh.positions.size()) - count(mesh.triangles.size()) / 2, 2);  // Euler: V − E + F with 2E = 3F
  double volume = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    volume += static_cast<double>(dot(face_normal(mesh, t), mesh.positions[mesh.triangles[t][0]])) / 6;
  EXPECT_NEAR(volume, 4.0 / 3 * 3.14159265 * 0.125, 0.02);
  for (const Vec3 p : mesh.positions) EXPECT_NEAR(length(p), 0.5f, 0.005f);
}

TEST(DistanceGrid, InterpolatesAndExtends) {
  const DistanceGrid grid = bake_distance(ball, {-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f}, 0.02f);
  for (const Vec3 p : {Vec3(0.31f, 0.2f, -0.33f), Vec3(-0.1f, 0.52f, 0.07f), Vec3(0.6f, 0.6f, 0.6f)}) {
    const DistanceSample s = sample_distance(grid, p);
    EXPECT_NEAR(s.distance, ball(p), 1e-3f);
    EXPECT_GT(dot(normalize(s.gradient), normalize(p)), 0.999f);
  }
  EXPECT_NEAR(sample_distance(grid, {5, 0, 0}).distance, 4.5f, 1e-3f);
}

}  // namespace
}  // namespace pelage::groom
