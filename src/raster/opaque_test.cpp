// Opaque shading against closed forms: a lit wall, its shadows, its ambient light, its depth.
#include "raster/opaque.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "frame/camera_view.h"
#include "kernel/scalar.h"
#include "frame/sample_positions.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;

/// A square of half side `half` about (x, y, z) that faces +z.
MeshInstance wall(Vec3 center, float half) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec2 c : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
    mesh->positions.push_back(center + Vec3(c.x * half, c.y * half, 0)),
        mesh->uv.push_back({0.5f + 0.5f * c.x, 0.5f + 0.5f * c.y});
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  MeshInstance instance;
  instance.mesh = mesh;
  instance.color = {0.5f, 0.25f, 0.125f};
  return instance;
}

/// Looks from (0, 0, 1) along −z at a wall in z = −1.
Scene wall_scene() {
  Scene scene;
  scene.meshes.push_back(wall({0, 0, -1}, 5));
  scene.settings.width = 33, scene.settings.height = 17;
  return scene;
}

LightRig rig_of(const Light& light) {
  LightRig rig;
  rig.lights.emplace_back();
  rig.lights[0].light = light;
  return rig;
}

OpaqueLayer trace(const Scene& scene, const LightRig& rig, int samples = 1) {
  const CameraView view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
  const auto positions = sample_positions(samples);
  return trace_opaque(scene, view, {positions.data(), static_cast<std::size_t>(samples)}, MeshTracer(scene.meshes), rig);
}

std::size_t middle(const OpaqueLayer& layer) {
  return (static_cast<std::size_t>(layer.height / 2) * static_cast<std::size_t>(layer.width) +
          static_cast<std::size_t>(layer.width / 2)) *
         static_cast<std::size_t>(layer.samples);
}

Light directional(Vec3 travels) {
  Light light;
  light.direction = normalize(travels), light.intensity = {3, 3, 3};
  return light;
}

TEST(Opaque, WallHasDepthAndLambertWithGloss) {
  const Scene scene = wall_scene();
  for (const Vec3 travels : {Vec3(0, 0, -1), Vec3(0.7f, 0.2f, -1)}) {
    const Light light = directional(travels);
    const OpaqueLayer layer = trace(scene, rig_of(light));
    for (std::size_t i = 0; i < layer.depth.size(); ++i) EXPECT_NEAR(layer.depth[i], 2, 1e-5f);
    const MeshInstance& m = scene.meshes[0];
    const float cosine = -light.direction.z;
    const float gloss = kernel::shade_ggx({0, 0, 1}, {0, 0, 1}, -light.direction, m.specular, m.roughness);
    EXPECT_NEAR(opaque_color(layer, middle(layer)).x, 3 * (0.5f * (1 - m.specular) * cosine / kPi + gloss), 2e-3f);
    EXPECT_NEAR(opaque_color(layer, middle(layer)).z, 3 * (0.125f * (1 - m.specular) * cosine / kPi + gloss), 2e-3f);
  }
}

TEST(Opaque, GgxReflectsNoMoreThanItGets) {
  // Integral over the light's hemisphere, eye at 40°: the share of light that the coat reflects.
  for (const float alpha : {0.1f, 0.5f, 1.f}) {
    const Vec3 to_eye{std::sin(0.7f), 0, std::cos(0.7f)};
    double sum = 0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const float z = (static_cast<float>(i) + 0.5f) / kSteps, phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / kSteps;
        const float r = std::sqrt(1 - z * z);
        sum += static_cast<double>(kernel::shade_ggx({0, 0, 1}, to_eye, {r * std::cos(phi), r * std::sin(phi), z}, 1, alpha));
      }
    const double reflected = sum * 2 * static_cast<double>(kPi) / (kSteps * kSteps);
    EXPECT_LT(reflected, 1.005) << alpha;
    if (alpha == 0.1f) {
      EXPECT_GT(reflected, 0.95);
    }
    // α = 1 has a closed form for a unit f0: D = 1/π and Smith's term is 2 (cos θ_l + cos θ_v).
    const double v = std::cos(0.7);
    if (alpha == 1) {
      EXPECT_NEAR(reflected, 1 - v * std::log((1 + v) / v), 1e-3);
    }
  }
}

TEST(Opaque, MeshesShadeEachOther) {
  Scene scene = wall_scene();
  scene.meshes.push_back(wall({0.5f, 0, -0.5f}, 0.1f));  // keeps the slanting light off the wall's middle
  const Light light = directional({-1, 0, -1});
  OpaqueLayer layer = trace(scene, rig_of(light));
  EXPECT_EQ(opaque_color(layer, middle(layer)).x, 0);
  scene.settings.shadows = false;
  layer = trace(scene, rig_of(light));
  EXPECT_GT(opaque_color(layer, middle(layer)).x, 0.1f);
}

TEST(Opaque, ConstantSkyLightsTheOpenWallWithItsRadianceTimesAlbedo) {
  const Scene scene = wall_scene();
  LightRig rig;
  rig.irradiance[0] = Vec3(1, 1, 1) * (kPi * std::sqrt(4 * kPi));  // radiance 1: c00 = π·∫ Y00 dω
  const OpaqueLayer layer = trace(scene, rig);
  EXPECT_NEAR(opaque_color(layer, middle(layer)).x, 0.5f * (1 - scene.meshes[0].specular), 1e-3f);
}

TEST(Opaque, TextureIsUpright) {
  Scene scene = wall_scene();
  scene.meshes[0] = wall({0, 0, -1}, 0.4f);
  auto texture = std::make_shared<Image>(2, 2, std::vector<std::string>{"R", "G", "B"});
  texture->at(0, 0)[0] = texture->at(1, 0)[0] = 1;  // red above
  texture->at(0, 1)[2] = texture->at(1, 1)[2] = 1;  // blue below
  scene.meshes[0].texture = texture, scene.meshes[0].color = {1, 1, 1}, scene.meshes[0].specular = 0;
  const OpaqueLayer layer = trace(scene, rig_of(directional({0, 0, -1})));
  const std::size_t column = 16, width = 33;
  EXPECT_GT(opaque_color(layer, 5 * width + column).x, opaque_color(layer, 5 * width + column).z);
  EXPECT_GT(opaque_color(layer, 11 * width + column).z, opaque_color(layer, 11 * width + column).x);
}

TEST(Opaque, SamplesThreadsAndMisses) {
  Scene scene = wall_scene();
  scene.meshes[0] = wall({0.1f, 0.05f, -1}, 0.2f);
  const LightRig rig = rig_of(directional({0.2f, -0.4f, -1}));
  set_thread_count(1);
  const OpaqueLayer one = trace(scene, rig, 8);
  set_thread_count(3);
  const OpaqueLayer three = trace(scene, rig, 8);
  set_thread_count(0);
  ASSERT_EQ(one.color.size(), three.color.size());
  EXPECT_EQ(0, std::memcmp(one.color.data(), three.color.data(), one.color.size() * sizeof(Vec3)));
  EXPECT_EQ(0, std::memcmp(one.first.data(), three.first.data(), one.first.size() * sizeof(std::uint32_t)));
  EXPECT_EQ(0, std::memcmp(one.shade.data(), three.shade.data(), one.shade.size()));
  EXPECT_LT(one.color.size(), one.depth.size() / 8) << "a flat wall needs a color per pixel at most";
  EXPECT_EQ(0, std::memcmp(one.depth.data(), three.depth.data(), one.depth.size() * sizeof(float)));
  EXPECT_EQ(one.depth[0], INFINITY);
  EXPECT_EQ(opaque_color(one, 0), Vec3(0, 0, 0));
  EXPECT_LT(one.depth[middle(one)], 3);
  scene.meshes.clear();
  EXPECT_TRUE(trace(scene, rig).color.empty());
}

TEST(Opaque, OrthographicDepthIsTheDistanceFromTheEyePlane) {
  Scene scene = wall_scene();
  scene.camera.projection = Camera::Projection::kOrthographic;
  const OpaqueLayer layer = trace(scene, rig_of(directional({0, 0, -1})));
  for (std::size_t i = 0; i < layer.depth.size(); ++i) EXPECT_NEAR(layer.depth[i], 2, 1e-5f);
}

}  // namespace
}  // namespace pelage
