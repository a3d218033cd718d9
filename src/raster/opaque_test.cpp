// Opaque shading against closed forms: a lit wall, its shadows, its ambient light, its depth.
#include "raster/opaque.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "frame/camera_view.h"
#include "frame/sample_positions.h"
#include "kernel/scalar.h"
#include "kit/faceted_ball.h"
#include "raster/coat.h"

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

TEST(Opaque, CoatOfEvenLightIsTheIntegral) {
  constexpr int kSteps = 300;
  float worst = 0;
  for (const float alpha : {0.1f, 0.3f, 0.5f, 1.f})
    for (const float f0 : {0.f, 0.04f, 1.f}) {
      const CoatAlbedo coat(f0, alpha);
      for (const float cosine : {0.05f, 0.11f, 0.3f, 0.52f, 0.8f, 1.f}) {
        const Vec3 to_eye{std::sqrt(1 - cosine * cosine), 0, cosine};
        double sum = 0;
        for (int i = 0; i < kSteps; ++i)
          for (int j = 0; j < kSteps; ++j) {
            const float z = (static_cast<float>(i) + 0.5f) / kSteps, phi = kPi * (static_cast<float>(j) + 0.5f) / kSteps;
            const float r = std::sqrt(1 - z * z);
            const Vec3 to_light{r * std::cos(phi), r * std::sin(phi), z};
            sum += static_cast<double>(kernel::shade_ggx({0, 0, 1}, to_eye, to_light, f0, alpha));
          }
        const double exact = sum * 2 * static_cast<double>(kPi) / (kSteps * kSteps);
        const float error = std::fabs(coat.seen_from(cosine) - static_cast<float>(exact));
        worst = std::max(worst, error - kCoatAlbedoMaxErrorOfMirrors * f0);
      }
    }
  EXPECT_LE(worst, kCoatAlbedoMaxAbsError);
}

// A ball of coarse facets with smooth normals: where those see the light, its facets do not keep it off.
TEST(Opaque, FacetsOfASmoothSurfaceDoNotShadeEachOther) {
  Scene scene;
  scene.settings.width = scene.settings.height = 65;
  scene.camera = kit::camera_before_ball();
  scene.meshes.push_back(kit::faceted_ball());
  for (const Vec3 travels : {Vec3(-1, 0, 0), Vec3(-1, -0.4f, -0.3f), Vec3(0.3f, -1, 0.2f)}) {
    const LightRig rig = rig_of(directional(travels));
    scene.settings.shadows = true;
    const OpaqueLayer layer = trace(scene, rig);
    scene.settings.shadows = false;
    const OpaqueLayer open = trace(scene, rig);
    int lit = 0;
    for (std::size_t i = 0; i < layer.depth.size(); ++i) {
      if (layer.shade[i] == OpaqueLayer::kNone) continue;
      const float expected = opaque_color(open, i).x;
      if (expected < 0.05f) continue;
      ++lit;
      EXPECT_EQ(opaque_color(layer, i).x, expected) << i;
    }
    EXPECT_GT(lit, 500);
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

TEST(Opaque, ConstantSkyLightsTheOpenWallWithItsRadianceTimesAlbedoAndCoat) {
  const Scene scene = wall_scene();
  LightRig rig;
  rig.irradiance[0] = Vec3(1, 1, 1) * (kPi * std::sqrt(4 * kPi));  // radiance 1: c00 = π·∫ Y00 dω
  const OpaqueLayer layer = trace(scene, rig);
  const MeshInstance& m = scene.meshes[0];
  const float coat = CoatAlbedo(m.specular, m.roughness).seen_from(1);
  EXPECT_GT(coat, 0.02f);
  EXPECT_NEAR(opaque_color(layer, middle(layer)).x, 0.5f * (1 - m.specular) + coat, 1e-3f);
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

/// Samples of a pixel may share a shade, but each must look as if it had been traced alone.
void expect_each_sample_as_if_alone(const Scene& scene, const LightRig& rig, float tolerance) {
  constexpr std::size_t kSamples = 8;
  const CameraView view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
  const auto positions = sample_positions(static_cast<int>(kSamples));
  const MeshTracer meshes(scene.meshes);
  const OpaqueLayer shared = trace_opaque(scene, view, {positions.data(), kSamples}, meshes, rig);
  std::size_t mixed = 0;  // pixels whose samples differ
  for (std::size_t i = 0; i < kSamples; ++i) {
    const OpaqueLayer alone = trace_opaque(scene, view, {positions.data() + i, 1}, meshes, rig);
    for (std::size_t p = 0; p < alone.depth.size(); ++p) {
      const std::size_t s = p * kSamples + i;
      ASSERT_EQ(shared.depth[s], alone.depth[p]);
      ASSERT_LE(length(opaque_color(shared, s) - opaque_color(alone, p)), tolerance) << "sample " << i << " of pixel " << p;
      mixed += length(opaque_color(shared, s) - opaque_color(shared, p * kSamples)) > 10 * tolerance;
    }
  }
  EXPECT_GT(mixed, 10u);
}

TEST(Opaque, NeighboringMaterialsShareNoShade) {
  Scene scene = wall_scene();
  scene.meshes[0] = wall({-4.98f, 0, -1}, 5), scene.meshes.push_back(wall({5.02f, 0, -1}, 5));
  scene.meshes[1].color = {0.1f, 0.6f, 0.9f};
  expect_each_sample_as_if_alone(scene, rig_of(directional({0.2f, -0.4f, -1})), 5e-3f);
}

TEST(Opaque, ACornerSharesNoShade) {
  Scene scene = wall_scene();
  auto mesh = std::make_shared<TriangleMesh>();  // two planes that meet in an edge toward the eye
  mesh->positions = {{0, -9, 0}, {9, -9, -9}, {9, 9, -9}, {0, 9, 0}, {0, -9, 0}, {-9, -9, -9}, {-9, 9, -9}, {0, 9, 0}};
  mesh->uv.assign(8, {0, 0});
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  scene.meshes[0].mesh = mesh, scene.meshes[0].transform.m[0][3] = 0.02f;
  scene.camera.eye = {0, 0, 2};
  expect_each_sample_as_if_alone(scene, rig_of(directional({1, 0, -1})), 1e-2f);
}

TEST(Opaque, TheEdgeOfANearWallSharesNoShadeWithTheFarOne) {
  Scene scene = wall_scene();
  scene.meshes[0].color = {0.5f, 0.5f, 0.5f};
  auto mesh = std::make_shared<TriangleMesh>(*scene.meshes[0].mesh);  // of one mesh, so of one material
  const TriangleMesh near = *wall({-0.27f, 0.02f, -0.2f}, 0.25f).mesh;
  for (const auto& t : near.triangles) mesh->triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  mesh->positions.insert(mesh->positions.end(), near.positions.begin(), near.positions.end());
  mesh->uv.insert(mesh->uv.end(), near.uv.begin(), near.uv.end());
  scene.meshes[0].mesh = mesh;
  Light light;
  light.type = Light::Type::kPoint, light.position = {0, 0, 1}, light.intensity = {3, 3, 3};
  scene.settings.shadows = false;
  expect_each_sample_as_if_alone(scene, rig_of(light), 1e-2f);
}

TEST(Opaque, OrthographicDepthIsTheDistanceFromTheEyePlane) {
  Scene scene = wall_scene();
  scene.camera.projection = Camera::Projection::kOrthographic;
  const OpaqueLayer layer = trace(scene, rig_of(directional({0, 0, -1})));
  for (std::size_t i = 0; i < layer.depth.size(); ++i) EXPECT_NEAR(layer.depth[i], 2, 1e-5f);
}

}  // namespace
}  // namespace pelage
