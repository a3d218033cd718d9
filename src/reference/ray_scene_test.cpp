#include "reference/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/rng.h"
#include "frame/segment_lookup.h"
#include "kit/trace_kit.h"

namespace pelage {
namespace {

constexpr CurveBasis kBases[] = {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier};

/// A few random strands of 7 points, some widths, and a transform.
Scene random_scene(CurveBasis basis) {
  std::vector<std::vector<Vec3>> all;
  for (std::uint32_t s = 0; s < 6; ++s) {
    Rng rng(9, s);
    std::vector<Vec3> points;
    for (int i = 0; i < 7; ++i)
      points.push_back(Vec3(0.2f * static_cast<float>(i), 0, 0) + Vec3(rng.normal(), rng.normal(), rng.normal()) * 0.05f);
    all.push_back(points);
  }
  Scene scene = kit::scene_of(kit::strands(all, 0.02f, basis), 1, 8);
  scene.grooms[0].transform.m[0][0] = 0, scene.grooms[0].transform.m[0][1] = -2, scene.grooms[0].transform.m[0][3] = 1;
  scene.grooms[0].transform.m[1][0] = 2, scene.grooms[0].transform.m[1][1] = 0;
  scene.grooms[0].transform.m[2][2] = 2;
  scene.grooms[0].width_scale = 1.5f;
  return scene;
}

// The curve that rays meet is the curve that raster draws: same place, tangent, u and width for every span and parameter.
TEST(RayScene, PlacesAreThoseOfTheSegmentLookUp) {
  for (const CurveBasis basis : kBases) {
    const Scene scene = random_scene(basis);
    const RayScene rays(scene, CurveShape::kFlat);
    const SegmentNumbering numbering{{0, 42}, {1}};
    const std::uint32_t spans = basis == CurveBasis::kBezier ? 2 : 6;
    ASSERT_EQ(rays.span_total(), 6 * spans);
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    for (std::uint32_t primitive = 0; primitive < 6 * spans; ++primitive)
      for (const float t : {0.f, 0.3f, 0.9f}) {
        const SceneHit hit{SceneHit::Kind::kStrand, 1, 0, primitive, t, 0};
        const StrandPlace place = rays.strand_place(hit);
        const StrandLabel label = rays.strand_label(hit);
        const StrandSurface expected = surface_at(scene, numbering, {0, label.strand, label.span, 0}, t);
        seen.insert({label.strand, label.span});
        EXPECT_LT(length(place.axis - expected.position), 2e-6f);
        EXPECT_LT(length(place.tangent - expected.tangent), 2e-5f);
        EXPECT_NEAR(label.u, expected.u, 1e-6f);
        EXPECT_NEAR(2 * place.radius, expected.width, 1e-6f);
      }
    EXPECT_EQ(seen.size(), 6 * spans) << "every span of every strand is there";
    EXPECT_LT(seen.rbegin()->first, 6u);
    EXPECT_LT(seen.rbegin()->second, spans);
  }
}

// What a ray meets is where the axis is, within the radius; rays beside the strand meet nothing.
TEST(RayScene, RaysMeetTheCurves) {
  for (const CurveBasis basis : kBases)
    for (const CurveShape shape : {CurveShape::kFlat, CurveShape::kRound}) {
      const Scene scene = random_scene(basis);
      const RayScene rays(scene, shape);
      int met = 0;
      for (std::uint32_t i = 0; i < 2000; ++i) {
        Rng rng(11, i);
        const std::uint32_t span = static_cast<std::uint32_t>(rng.uniform() * static_cast<float>(rays.span_total()));
        const SceneHit aimed{SceneHit::Kind::kStrand, 1, 0, span, rng.uniform(), 0};
        const StrandPlace aim = rays.strand_place(aimed);
        const Vec3 direction = normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
        const float along = dot(direction, aim.tangent);
        if (std::fabs(along) > 0.9f) continue;
        const Vec3 side = normalize(cross(direction, aim.tangent));
        const float offset = (rng.uniform() - 0.5f) * 1.6f * aim.radius;
        const SceneHit hit = rays.intersect({aim.axis + side * offset - direction * 5.f, direction});
        ASSERT_EQ(hit.kind, SceneHit::Kind::kStrand);
        const StrandPlace place = rays.strand_place(hit);
        const Vec3 at = aim.axis + side * offset + direction * (hit.distance - 5);
        EXPECT_LT(length(at - place.axis), 1.2f * place.radius);
        met += rays.strand_label(hit).strand == rays.strand_label(aimed).strand;
      }
      EXPECT_GT(met, 1000);
    }
}

// Strands along y, a ray along z: it crosses those with |x − x_i| < r, each once, at joints of spans too.
TEST(RayScene, EveryStrandOnARayIsCounted) {
  std::vector<std::vector<Vec3>> all;
  std::vector<float> at;
  for (std::uint32_t s = 0; s < 200; ++s) {
    Rng rng(13, s);
    const float x = rng.uniform(), z = rng.uniform();
    std::vector<Vec3> points;
    for (int i = 0; i <= 12; ++i) points.push_back({x, static_cast<float>(i) / 6 - 1, z});
    all.push_back(points), at.push_back(x);
  }
  for (const CurveBasis basis : kBases) {
    const Scene scene = kit::scene_of(kit::strands(all, 0.1f, basis), 1, 8);
    const RayScene rays(scene, CurveShape::kFlat);
    std::size_t total = 0;
    for (std::uint32_t i = 0; i < 500; ++i) {
      Rng rng(14, i);
      const float x = rng.uniform(), y = rng.uniform() - 0.5f;
      std::size_t counted = 0, expected = 0;
      EXPECT_TRUE(rays.cross_strands({{x, y, -3}, {0, 0, 1}}, [&](const SceneHit&) { ++counted; }));
      for (const float strand : at) expected += std::fabs(strand - x) < 0.05f;
      EXPECT_EQ(counted, expected) << x;
      total += counted;
    }
    EXPECT_GT(total, 5000u);
  }
}

TEST(RayScene, MeshesStopWhatStrandsLetPass) {
  Scene scene = kit::scene_of(kit::strands({{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}}, 0.1f), 1, 8);
  auto triangle = std::make_shared<TriangleMesh>();
  triangle->positions = {{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}, triangle->triangles = {{0, 1, 2}};
  scene.meshes.emplace_back();
  scene.meshes[0].mesh = triangle;
  const RayScene rays(scene, CurveShape::kFlat);
  int counted = 0;
  const auto count = [&](const SceneHit&) { ++counted; };
  EXPECT_FALSE(rays.cross_strands({{0, 0, 1}, {0, 0, -1}}, count));
  counted = 0;
  EXPECT_TRUE(rays.cross_strands({{0.01f, 0, 1}, {0, 0, -1}, 0, 1.5f}, count));
  EXPECT_EQ(counted, 1);
  EXPECT_EQ(rays.intersect({{0, 0, -3}, {0, 0, 1}}).kind, SceneHit::Kind::kMesh);
  EXPECT_EQ(rays.intersect({{0, 0, 3}, {0, 0, -1}}).kind, SceneHit::Kind::kStrand);
  EXPECT_TRUE(rays.occluded({{0, 0, 3}, {0, 0, -1}}));
  EXPECT_FALSE(rays.occluded({{0.9f, 0.9f, 3}, {0, 0, -1}}));
}

}  // namespace
}  // namespace pelage
