// Lights as cameras, the environment in pieces and harmonics, shadows of meshes, and the whole rig.
#include "light/light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frame/light_lookup.h"
#include "frame/environment_map.h"
#include "light/environment.h"
#include "light/light_view.h"
#include "light/shadow_map.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;

TriangleMesh sphere(float radius) {
  constexpr std::uint32_t kRings = 96, kSides = 192;
  TriangleMesh mesh;
  for (std::uint32_t r = 0; r <= kRings; ++r)
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const float polar = kPi * static_cast<float>(r) / kRings, azimuth = 2 * kPi * static_cast<float>(s) / kSides;
      mesh.positions.push_back(Vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)) *
                               radius);
    }
  for (std::uint32_t r = 0; r < kRings; ++r)
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const std::uint32_t a = r * kSides + s, b = r * kSides + (s + 1) % kSides;
      mesh.triangles.push_back({a, b, a + kSides}), mesh.triangles.push_back({b, b + kSides, a + kSides});
    }
  return mesh;
}

MeshInstance instance(TriangleMesh mesh) {
  MeshInstance m;
  m.mesh = std::make_shared<TriangleMesh>(std::move(mesh));
  return m;
}

Light directional(Vec3 direction) {
  Light light;
  light.direction = normalize(direction);
  return light;
}

Scene scene_with_strands() {
  auto set = std::make_shared<StrandSet>();
  set->widths = {1e-3f};
  set->basis = CurveBasis::kLinear;
  set->offsets = {0};
  for (int i = 0; i < 50; ++i) {
    const float x = -0.5f + 0.02f * static_cast<float>(i);
    set->points.insert(set->points.end(), {{x, -0.5f, 0.3f * x}, {x, 0.5f, -0.2f}});
    set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
  }
  Scene scene;
  scene.grooms.emplace_back().strands = set;
  scene.settings.opacity_map_size = 64;
  return scene;
}

Environment one_texel(int x, int y) {
  auto map = std::make_shared<Image>(128, 64, std::vector<std::string>{"R", "G", "B"});
  std::fill_n(map->at(x, y), 3, 100.f);
  Environment e;
  e.radiance = {1, 1, 1}, e.map = map;
  return e;
}

TEST(LightView, BoundsFitInsideTheMargin) {
  Bounds box;
  box.extend({-0.3f, -0.1f, -0.2f}), box.extend({0.2f, 0.5f, 0.1f});
  Light point;
  point.type = Light::Type::kPoint, point.position = {1, 1, 2};
  for (const Light& light : {directional({0, -1, 0}), directional({1, 0.2f, -0.4f}), point}) {
    const std::vector<CameraView> views = light_views(light, box, 100);
    ASSERT_EQ(views.size(), 1u);
    EXPECT_EQ(std::max(views[0].width, views[0].height), 100);
    for (int i = 0; i < 8; ++i) {
      const MapPlace p = place_on_map(views[0], {i & 1 ? 0.2f : -0.3f, i & 2 ? 0.5f : -0.1f, i & 4 ? 0.1f : -0.2f});
      EXPECT_TRUE(p.in_front);
      EXPECT_GE(p.x, 1.9f);
      EXPECT_GE(p.y, 1.9f);
      EXPECT_LE(p.x, static_cast<float>(views[0].width) - 1.9f);
      EXPECT_LE(p.y, static_cast<float>(views[0].height) - 1.9f);
    }
  }
}

TEST(LightView, LightInsideSeesAllAround) {
  Bounds box;
  box.extend({-1, -1, -1}), box.extend({1, 1, 1});
  Light light;
  light.type = Light::Type::kPoint, light.position = {0.2f, -0.1f, 0.3f};
  const std::vector<CameraView> views = light_views(light, box, 64);
  ASSERT_EQ(views.size(), 6u);
  for (const Vec3 p : {Vec3(1, 1, 1), Vec3(-0.9f, 0.2f, 0.1f), Vec3(0.1f, -1, 0.5f), Vec3(0.3f, 0.2f, -1)}) {
    int seen = 0;
    for (const CameraView& view : views) {
      const Vec3 c = to_camera(view, p);
      seen += std::max(std::fabs(c.x), std::fabs(c.y)) <= c.z;
    }
    EXPECT_EQ(seen, 1);
  }
}

TEST(Environment, ConstantSkyKeepsItsEnergy) {
  Environment e;
  e.radiance = {1, 2, 3};
  for (const int levels : {0, 3, 4, 7}) {
    Vec3 sum;
    for (const EnvironmentPiece& piece : cut_environment(e, levels)) {
      sum += piece.irradiance;
      EXPECT_NEAR(length(piece.from), 1, 1e-4f);
    }
    EXPECT_NEAR(sum.x, 4 * kPi, 1e-3f);
    EXPECT_NEAR(sum.z, 12 * kPi, 3e-3f);
  }
  for (const Vec3 n : {Vec3(0, 1, 0), Vec3(0.6f, 0, -0.8f)})
    EXPECT_NEAR(environment_irradiance(irradiance_harmonics(e), n).y, 2 * kPi, 1e-2f);
}

TEST(Environment, MapIsOrientedAsDocumented) {
  // Row 0 is straight up, the middle column looks along −Z, columns to the right turn toward +X.
  const auto from = [](const Environment& e) { return cut_environment(e, 0).at(0).from; };
  EXPECT_GT(from(one_texel(5, 0)).y, 0.99f);
  EXPECT_LT(from(one_texel(64, 32)).z, -0.99f);
  EXPECT_GT(from(one_texel(96, 32)).x, 0.99f);
  Environment turned = one_texel(64, 32);
  turned.rotation = kPi / 2;  // counter-clockwise from above: −Z goes to −X
  EXPECT_LT(from(turned).x, -0.99f);
  EXPECT_GT(environment_radiance(turned, normalize({-1, -0.0245f, -0.0245f})).x, 90.f);
  EXPECT_GT(environment_radiance(one_texel(96, 32), normalize({1, -0.0245f, 0.0245f})).x, 90.f);
}

TEST(Environment, SmallBrightSourcesMakeSmallPieces) {
  const std::vector<EnvironmentPiece> sun = cut_environment(one_texel(40, 20), 4);
  for (const EnvironmentPiece& piece : sun) EXPECT_LT(piece.spread, 0.05f);
  Environment sky;
  sky.radiance = {1, 1, 1};
  const std::vector<EnvironmentPiece> even = cut_environment(sky, 4);
  EXPECT_EQ(even.size(), 16u);
  for (const EnvironmentPiece& piece : even) {
    EXPECT_GT(piece.spread, 0.2f);
    EXPECT_LT(piece.spread, 0.8f);
  }
  EXPECT_TRUE(cut_environment({}, 4).empty());
}

TEST(ShadowMap, SphereThrowsARoundShadow) {
  const MeshTracer meshes({instance(sphere(0.5f))});
  Bounds box;
  box.extend({-1, -1, -1}), box.extend({1, 1, 1});
  Light point;
  point.type = Light::Type::kPoint, point.position = {0, 0, 4};
  for (const Light& light : {directional({0, 0, -1}), point}) {
    const ShadowMap map = build_shadow_map(meshes, light_views(light, box, 256).front());
    // Radius of the shadow at z = −1: the cone that touches the sphere.
    const float radius = light.type == Light::Type::kPoint ? 5 * std::tan(std::asin(0.5f / 4)) : 0.5f;
    for (float angle = 0; angle < 6.2f; angle += 0.3f) {
      const Vec3 edge{radius * std::cos(angle), radius * std::sin(angle), -1};
      const auto at = [&](float scale) { return mesh_visibility(map, {edge.x * scale, edge.y * scale, -1}, {0.001f, 1}); };
      EXPECT_EQ(at(0.94f), 0) << angle;
      EXPECT_EQ(at(1.06f), 1) << angle;
      EXPECT_NEAR(at(1), 0.5f, 0.3f) << angle;
    }
    EXPECT_EQ(mesh_visibility(map, {0, 0, 0.9f}, {0.001f, 1}), 1);
    EXPECT_EQ(mesh_visibility(map, {0, 0, 0.5f}, {0.001f, 1}), 1) << "the sphere does not shade itself";
  }
  EXPECT_TRUE(build_shadow_map(MeshTracer({}), CameraView{}).depth.empty());
}

TEST(LightRig, EmptySceneAndDarkLights) {
  Scene scene;
  const MeshTracer none({});
  EXPECT_TRUE(prepare_lights(scene, none).lights.empty());
  scene.lights.push_back(directional({0, -1, 0}));
  scene.lights.push_back(directional({0, -1, 0}));
  scene.lights[1].intensity = {0, 0, 0};
  const LightRig rig = prepare_lights(scene, none);
  ASSERT_EQ(rig.lights.size(), 1u);
  EXPECT_TRUE(rig.lights[0].opacity.crossings.empty());
  EXPECT_EQ(resident_bytes(rig), 0u);
}

TEST(LightRig, LightInsideTheHairLightsEveryPlaceOnce) {
  Scene scene = scene_with_strands();
  Light light;
  light.type = Light::Type::kPoint, light.position = {0.05f, 0.1f, -0.02f};
  scene.lights.push_back(light);
  const LightRig rig = prepare_lights(scene, MeshTracer({}));
  ASSERT_EQ(rig.lights.size(), 6u);
  for (const Vec3 p : {Vec3(0.4f, 0.2f, 0.1f), Vec3(-0.3f, -0.4f, 0), Vec3(0, 0.3f, -0.15f)}) {
    Vec3 sum;
    for (const PreparedLight& face : rig.lights) sum += illuminate(face, p).irradiance;
    const Vec3 d = light.position - p;
    EXPECT_NEAR(sum.x, 1 / dot(d, d), 1e-3f / dot(d, d));
  }
}

TEST(LightRig, ShadowsCanBeTurnedOff) {
  Scene scene = scene_with_strands();
  scene.lights.push_back(directional({0, -1, -1}));
  EXPECT_FALSE(prepare_lights(scene, MeshTracer({})).lights[0].opacity.crossings.empty());
  scene.lights[0].casts_shadow = false;
  EXPECT_TRUE(prepare_lights(scene, MeshTracer({})).lights[0].opacity.crossings.empty());
  scene.lights[0].casts_shadow = true, scene.settings.shadows = false;
  EXPECT_TRUE(prepare_lights(scene, MeshTracer({})).lights[0].opacity.crossings.empty());
}

TEST(Illumination, SpotFadesBetweenItsAnglesAndFallsOffSquared) {
  PreparedLight spot;
  spot.light.type = Light::Type::kSpot;
  spot.light.position = {0, 2, 0}, spot.light.direction = {0, -1, 0}, spot.light.intensity = {8, 8, 8};
  EXPECT_FLOAT_EQ(illuminate(spot, {0, 0, 0}).irradiance.x, 2);
  EXPECT_FLOAT_EQ(illuminate(spot, {0, 1, 0}).irradiance.x, 8);
  EXPECT_EQ(illuminate(spot, {2 * std::tan(0.41f), 0, 0}).irradiance.x, 0);
  const float between = illuminate(spot, {2 * std::tan(0.35f), 0, 0}).irradiance.x;
  EXPECT_GT(between, 0.1f);
  EXPECT_LT(between, 1.9f);
}

}  // namespace
}  // namespace pelage
