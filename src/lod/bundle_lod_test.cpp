#include "lod/bundle_lod.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frame/camera_view.h"
#include "groom/hairmesh/prepared.h"
#include "kernel/scalar.h"
#include "kit/hair_mesh_scene.h"

namespace pelage {
namespace {

using testing::deferred_grooms;
using testing::every_operator;
using testing::hair_mesh_scene;
using testing::small_hair_mesh;

LodSelection select(const Scene& scene, int width = 320, int height = 240) {
  const CameraView view = make_camera_view(scene.camera, width, height);
  return select_lod(scene, deferred_grooms(scene), std::span(&view, 1));
}

// Lipp 2026, eq. 1, 2, 4 and 5, by hand.
TEST(BundleLod, FollowsItsEquations) {
  EXPECT_FLOAT_EQ(kernel::lod_selection({10, 20}, {13, 24}, 100, 3), 0.15f);
  EXPECT_FLOAT_EQ(kernel::lod_selection({0, 0}, {300, 400}, 100, 3), 1);
  EXPECT_EQ(kernel::lod_strands(0.1f, 1000, 0.5f), 101);
  EXPECT_EQ(kernel::lod_strands(0, 1000, 0.5f), 1);
  EXPECT_EQ(kernel::lod_strands(1, 1000, 0.99f), 1000);
  EXPECT_EQ(kernel::lod_points(1, 127, 8), 127);
  EXPECT_EQ(kernel::lod_points(0.25f, 127, 8), 65);  // ⌊63.5⌋ − 1 = 62 → 64 + 1
  EXPECT_EQ(kernel::lod_points(0.01f, 127, 8), 17);  // ⌊12.7⌋ − 1 = 11 → 16 + 1
  EXPECT_EQ(kernel::lod_points(0, 127, 9), 9);       // 9 − 1 is a power already
  EXPECT_EQ(kernel::lod_points(0, 127, 2), 3);
  EXPECT_FLOAT_EQ(kernel::lod_depth_shift(1), 0);
  EXPECT_NEAR(kernel::lod_depth_shift(0.25f), std::log(4.f), 1e-6f);
}

// Thickened strands grow to a share of their bundle's width and no farther; the published ones are left out all the same.
TEST(BundleLod, StrandsStayThinBesideTheirBundle) {
  EXPECT_EQ(kernel::lod_least_strands(1000, 1e-4f, 0.1f), std::ceil(1000 * 1e-4f / (0.1f * kernel::kLodWidestStrand)));
  EXPECT_EQ(kernel::lod_least_strands(10, 1e-4f, 1), 1);
  EXPECT_EQ(kernel::lod_least_strands(100, 0.1f, 0.1f), 100);
  const auto mesh = small_hair_mesh(every_operator(), 2, 5, 4000);
  const PreparedHairMesh prepared(std::make_shared<const HairMesh>(mesh));
  Scene scene = hair_mesh_scene(mesh);
  scene.camera.eye = {0, 0.1f, 100};
  for (const BundleDraw& b : select(scene).bundles) {
    const float widest = kernel::kLodWidestStrand * prepared.across[b.bundle];
    EXPECT_LE(mesh.width * b.width_scale, widest * 1.0001f);
    EXPECT_GT(mesh.width * 4000 / static_cast<float>(b.strands - 1), widest);  // one strand less is too few
  }
  scene.settings.swr.thicken = false;
  for (const BundleDraw& b : select(scene).bundles)
    EXPECT_GT(mesh.width * b.width_scale * 4000 / static_cast<float>(b.strands),
              kernel::kLodWidestStrand * prepared.across[b.bundle]);
}

// Waves are not drawn from fewer than six points a turn, as far as there are any, nor spans from one chord.
TEST(BundleLod, AWaveKeepsItsPoints) {
  Scene scene = hair_mesh_scene(small_hair_mesh({{StyleOperator::Kind::kCurl, 0.01f, 8, 0, 0}}));
  scene.camera.eye = {0, 0.1f, 30};
  for (const BundleDraw& b : select(scene).bundles) EXPECT_EQ(b.points, 65u);  // 48 → 2⁶ + 1
  scene = hair_mesh_scene(small_hair_mesh({{StyleOperator::Kind::kCurl, 0.01f, 100, 0, 0}}));
  scene.camera.eye = {0, 0.1f, 30};
  for (const BundleDraw& b : select(scene).bundles) EXPECT_EQ(b.points, 127u);
  scene = hair_mesh_scene(small_hair_mesh({}, 2, 14));
  scene.camera.eye = {0, 0.1f, 30};
  for (const BundleDraw& b : select(scene).bundles) EXPECT_EQ(b.points, 33u);  // 27 → 2⁵ + 1
}

// What has to stay thin beside a braid is a strand beside its lock.
TEST(BundleLod, LocksOfABraidKeepMoreStrands) {
  std::uint64_t strands[2];
  for (const bool braided : {false, true}) {
    const auto style =
        braided ? std::vector<StyleOperator>{{StyleOperator::Kind::kBraid, 0.5f, 4, 0, 0}} : std::vector<StyleOperator>{};
    Scene scene = hair_mesh_scene(small_hair_mesh(style, 2, 5, 4000));
    scene.camera.eye = {0, 0.1f, 100};
    strands[braided] = select(scene).strands;
  }
  EXPECT_NEAR(static_cast<double>(strands[1]), 2.0 * static_cast<double>(strands[0]), 8);
}

TEST(BundleLod, WholeWithoutIt) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator()));
  scene.camera.eye = {0, 0, 30};
  scene.settings.swr.lod = false;
  const LodSelection s = select(scene);
  EXPECT_EQ(s.strands, 160u);
  EXPECT_EQ(s.points, 160u * 127);
}

// Farther away there are fewer strands and points, of the same width in sum.
TEST(BundleLod, FallsWithDistance) {
  Scene scene = hair_mesh_scene(small_hair_mesh({}, 2, 5, 4000));
  std::uint64_t before = ~std::uint64_t{0};
  for (const float distance : {0.5f, 2.f, 8.f, 32.f}) {
    scene.camera.eye = {0, 0.1f, distance};
    const LodSelection s = select(scene);
    EXPECT_LE(s.strands, before);
    before = s.strands;
    for (const BundleDraw& b : s.bundles) {
      EXPECT_NEAR(b.width_scale * static_cast<float>(b.strands), 4000, 1);
      EXPECT_TRUE(b.points == 127 || ((b.points - 1) & (b.points - 2)) == 0) << b.points;
    }
  }
  EXPECT_LT(before, 16000u / 20);
}

TEST(BundleLod, ABundleOutOfViewIsLeftOut) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator()));
  EXPECT_EQ(select(scene).bundles.size(), 4u);
  scene.camera.target = scene.camera.eye + Vec3(0, 0, 1);  // looks away
  EXPECT_EQ(select(scene).bundles.size(), 0u);
  scene.camera.target = scene.camera.eye + Vec3(1, 0, -1);
  EXPECT_EQ(select(scene).bundles.size(), 0u);
}

// Several views show as much of a bundle as the one that asks for the most; who sees it is told.
TEST(BundleLod, ViewsShareWhatOneAsksFor) {
  Scene scene = hair_mesh_scene(small_hair_mesh(every_operator(), 2, 5, 4000));
  const auto grooms = deferred_grooms(scene);
  std::vector<CameraView> views;
  for (const float distance : {8.f, 2.f, 32.f}) {
    scene.camera.eye = {0, 0.1f, distance};
    views.push_back(make_camera_view(scene.camera, 320, 240));
  }
  scene.camera.target = scene.camera.eye + Vec3(0, 0, 1);  // looks away
  views.push_back(make_camera_view(scene.camera, 320, 240));
  const LodSelection all = select_lod(scene, grooms, views), nearest = select_lod(scene, grooms, std::span(&views[1], 1));
  ASSERT_EQ(all.bundles.size(), 4u);
  EXPECT_EQ(all.strands, nearest.strands);
  EXPECT_EQ(all.points, nearest.points);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(all.bundles[i].strands, nearest.bundles[i].strands);
    EXPECT_EQ(all.bundles[i].points, nearest.bundles[i].points);
    EXPECT_EQ(all.bundles[i].width_scale, nearest.bundles[i].width_scale);
    EXPECT_EQ(all.bundles[i].nearest, nearest.bundles[i].nearest);
    EXPECT_EQ(all.bundles[i].views, 0b0111u);
  }
}

TEST(BundleLod, NearestFirst) {
  const LodSelection s = select(hair_mesh_scene(small_hair_mesh(every_operator(), 4)));
  ASSERT_EQ(s.bundles.size(), 16u);
  for (std::size_t i = 1; i < s.bundles.size(); ++i) EXPECT_LE(s.bundles[i - 1].nearest, s.bundles[i].nearest);
}

}  // namespace
}  // namespace pelage
