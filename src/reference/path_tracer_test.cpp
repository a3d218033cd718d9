#include "reference/path_tracer.h"

#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "frame/dual_scattering_tables.h"
#include "frame/fiber.h"
#include "kernel/scalar.h"
#include "kit/faceted_ball.h"
#include "kit/trace_kit.h"
#include "reference/fiber_bsdf.h"
#include "reference/light_sampler.h"

namespace pelage {
namespace {

using kit::estimate;
using kit::Estimate;
using kit::scene_of;

HairMaterial white() {
  HairMaterial m;
  m.eumelanin = m.pheomelanin = 0;
  return m;
}

Scene one_strand(Vec3 from, Vec3 to, float width = 0.1f) {
  return scene_of(kit::strands({{from, lerp(from, to, 0.3f), lerp(from, to, 0.7f), to}}, width), 0.05f, 16);
}

// Light of the same strength from everywhere, and nothing absorbs: whatever path light takes, 1 comes back. Chiang's lobes are drawn
// exactly, so no path has another weight; the noise of the others stays well below what is asked of them.
TEST(PathTracer, WhiteFurnace) {
  Scene scene = scene_of(kit::ball(10000, 0.1f, 8e-4f), 0.15f, 64);
  scene.environment.radiance = {1, 1, 1};
  const struct {
    HairMaterial::Model model;
    std::uint32_t samples;
    double error;
  } cases[] = {{HairMaterial::Model::kChiang, 8, 1e-4},
               {HairMaterial::Model::kMarschner, 128, 0.005},
               {HairMaterial::Model::kZhu, 128, 0.005}};
  for (const auto& c : cases) {
    scene.grooms[0].material = white();
    scene.grooms[0].material.model = c.model;
    PathSettings settings;
    settings.max_bounces = 1000;
    settings.split = true;
    const PathTracer tracer(scene, settings);
    const Estimate e = estimate(tracer, scene, c.samples);
    std::printf("furnace: %.5f ± %.5f over %llu paths\n", e.mean, std::sqrt(e.variance),
                static_cast<unsigned long long>(e.count));
    EXPECT_NEAR(e.mean, 1, c.error);
    EXPECT_LT(3 * std::sqrt(e.variance), c.error);
    EXPECT_GT(e.count, 20000u);
  }
}

/// The formula's Bessel function is that far off, the tracer's table has the exact one.
const float kTableError = kernel::kI0eMaxRelError + 1e-4f;

// One fiber under one light is the fiber's formula, whatever the shape of the curve; the strand does not shade itself.
TEST(PathTracer, OneFiberUnderALight) {
  for (const CurveShape shape : {CurveShape::kFlat, CurveShape::kRound}) {
    for (int i = 0; i < 40; ++i) {
      Rng rng(3, static_cast<std::uint32_t>(i));
      const auto direction = [&] { return normalize(Vec3(rng.normal(), rng.normal(), rng.normal())); };
      const Vec3 along = normalize(Vec3(rng.normal(), rng.normal(), 0.4f * rng.normal()));
      Scene scene = one_strand(along * -0.5f, along * 0.5f);
      Light light;
      light.direction = direction(), light.intensity = {3, 2, 1};
      scene.lights = {light};
      for (const Integrator integrator : {Integrator::kSingle, Integrator::kPath}) {
        PathSettings settings;
        settings.integrator = integrator, settings.curve_shape = shape;
        const PathSample s = PathTracer(scene, settings).sample(8, 7, 0);
        ASSERT_TRUE(s.hair);
        const FiberBsdf fiber(FiberMaterial(scene.grooms[0].material), {}, s.tangent, {0, 0, 1}, 0);
        const Vec3 expected = fiber.evaluate(-light.direction) * light.intensity;
        EXPECT_NEAR(s.radiance.x, expected.x, kTableError * expected.x + 1e-7f) << i;
        EXPECT_NEAR(s.radiance.z, expected.z, kTableError * expected.z + 1e-7f) << i;
        EXPECT_NEAR(std::fabs(dot(s.tangent, along)), 1, 1e-4f);
      }
    }
  }
}

// One fiber in an environment is the integral of its formula over the sphere.
TEST(PathTracer, OneFiberInAnEnvironment) {
  Scene scene = one_strand({-0.5f, -0.2f, 0.1f}, {0.5f, 0.2f, -0.1f});
  scene.environment.radiance = {1, 1, 1};
  scene.environment.map = std::make_shared<Image>(kit::gradient_map(64, 32));
  scene.environment.rotation = 0.7f;
  const PathTracer tracer(scene, {});
  const Estimate e = estimate(tracer, scene, 64);
  const FiberBsdf fiber(FiberMaterial(scene.grooms[0].material), {}, tracer.sample(8, 8, 0).tangent, {0, 0, 1}, 0);
  const EnvironmentSampler environment(scene.environment);
  double sum = 0;
  constexpr int kRows = 700, kColumns = 1400;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const double polar = (y + 0.5) / kRows * std::numbers::pi, around = (x + 0.5) / kColumns * 2 * std::numbers::pi;
      const Vec3 d(static_cast<float>(std::sin(polar) * std::sin(around)), static_cast<float>(std::cos(polar)),
                   static_cast<float>(std::sin(polar) * std::cos(around)));
      sum += static_cast<double>(kernel::v_luminance(fiber.evaluate(d) * environment.radiance(d))) * std::sin(polar);
    }
  sum *= 2 * std::numbers::pi * std::numbers::pi / kRows / kColumns;
  EXPECT_NEAR(e.mean, sum, 4 * std::sqrt(e.variance) + 1e-3 * sum);
}

/// Some hair on a plate, lights of all kinds and a map around.
Scene mixed_scene() {
  Scene scene = scene_of(kit::ball(400, 0.1f, 3e-3f), 0.2f, 24);
  scene.camera.eye = {0.3f, 0.4f, 1};
  scene.grooms[0].material.eumelanin = 0.3f;
  auto plate = std::make_shared<TriangleMesh>();
  plate->positions = {{-1, -0.06f, -1}, {1, -0.06f, -1}, {1, -0.06f, 1}, {-1, -0.06f, 1}};
  plate->triangles = {{0, 2, 1}, {0, 3, 2}};
  scene.meshes.emplace_back();
  scene.meshes[0].mesh = plate, scene.meshes[0].roughness = 0.3f;
  Light point, spot, sun;
  point.type = Light::Type::kPoint, point.position = {0.3f, 0.3f, 0.2f}, point.intensity = {0.2f, 0.1f, 0.1f};
  spot.type = Light::Type::kSpot, spot.position = {-0.3f, 0.5f, 0.2f}, spot.direction = normalize(Vec3(0.3f, -0.5f, -0.2f));
  spot.intensity = {0.1f, 0.3f, 0.2f};
  sun.direction = normalize(Vec3(-0.2f, -1, 0.3f));
  scene.lights = {point, spot, sun};
  scene.environment.radiance = {0.5f, 0.5f, 0.5f};
  scene.environment.map = std::make_shared<Image>(kit::gradient_map(64, 32));
  return scene;
}

// A ball of coarse facets with smooth normals: where those see the light, its facets do not keep it off.
TEST(PathTracer, FacetsOfASmoothSurfaceDoNotShadeEachOther) {
  Scene scene;
  scene.settings.width = scene.settings.height = 33;
  scene.camera = kit::camera_before_ball();
  scene.meshes.push_back(kit::faceted_ball());
  Light light;
  light.direction = normalize(Vec3(-1, -0.4f, -0.3f)), light.intensity = {3, 3, 3};
  scene.lights = {light};
  PathSettings settings, open;
  settings.integrator = open.integrator = Integrator::kSingle;
  open.shadows = false;
  const PathTracer tracer(scene, settings), without(scene, open);
  int lit = 0;
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 33; ++x) {
      const float expected = without.sample(x, y, 0).radiance.x;
      if (expected < 0.05f) continue;
      ++lit;
      EXPECT_EQ(tracer.sample(x, y, 0).radiance.x, expected) << x << " " << y;
    }
  EXPECT_GT(lit, 100);
}

TEST(PathTracer, TechniquesAgree) {
  const Scene scene = mixed_scene();
  const auto all = [](const PathSample& s) { return s.alpha > 0; };
  Estimate e[3];
  for (int i = 0; i < 3; ++i) {
    PathSettings settings;
    settings.technique = static_cast<Technique>(i), settings.seed = static_cast<std::uint64_t>(i);
    e[i] = estimate(PathTracer(scene, settings), scene, 96, all);
    std::printf("technique %d: %.5f ± %.5f\n", i, e[i].mean, std::sqrt(e[i].variance));
  }
  for (int i = 1; i < 3; ++i) EXPECT_LT(std::fabs(e[i].mean - e[0].mean), 3.5 * std::sqrt(e[i].variance + e[0].variance)) << i;
  EXPECT_LT(e[0].variance, e[2].variance);
}

// The same for roulette and the bound on bounces: the parts by bounce do not depend on what comes after them.
TEST(PathTracer, BouncesAreIndependentOfTheirLimit) {
  const Scene scene = mixed_scene();
  const auto mean_of_bounce = [&](int limit, std::size_t bounce) {
    PathSettings settings;
    settings.max_bounces = limit, settings.split = true;
    const PathTracer tracer(scene, settings);
    double sum = 0;
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        for (std::uint32_t i = 0; i < 24; ++i) sum += static_cast<double>(tracer.sample(x, y, i).split->bounces[bounce].y);
    return sum;
  };
  EXPECT_EQ(mean_of_bounce(1, 0), mean_of_bounce(70, 0));
  EXPECT_EQ(mean_of_bounce(3, 2), mean_of_bounce(4, 2));
  EXPECT_EQ(mean_of_bounce(2, 2), 0);
}

// Ending paths by chance and looking for one of several lights change the noise, not the mean.
TEST(PathTracer, ChancesAreMadeGood) {
  Scene scene = mixed_scene();
  scene.environment = {};
  const auto mean_of = [&](std::vector<Light> lights, int first_roulette) {
    scene.lights = std::move(lights);
    PathSettings settings;
    settings.first_roulette = first_roulette;
    return estimate(PathTracer(scene, settings), scene, 64);
  };
  const std::vector<Light> all = scene.lights;
  const Estimate together = mean_of(all, 3), never = mean_of(all, 1000), always = mean_of(all, 0);
  Estimate sum;
  for (const Light& light : all) {
    const Estimate e = mean_of({light}, 3);
    sum.mean += e.mean, sum.variance += e.variance;
  }
  std::printf("lights together %.5f ± %.5f, one by one %.5f ± %.5f; roulette never %.5f, always %.5f ± %.5f\n", together.mean,
              std::sqrt(together.variance), sum.mean, std::sqrt(sum.variance), never.mean, always.mean,
              std::sqrt(always.variance));
  EXPECT_NEAR(together.mean, sum.mean, 3.5 * std::sqrt(together.variance + sum.variance));
  EXPECT_NEAR(always.mean, never.mean, 3.5 * std::sqrt(always.variance + never.variance));
}

// 1 sample under each of 1024 seeds and 1024 samples under one: the same mean, pixel by pixel.
TEST(PathTracer, SeedsAndSamplesHaveTheSameMean) {
  Scene scene = mixed_scene();
  scene.settings.width = scene.settings.height = 8;
  const PathTracer many(scene, {});
  constexpr std::uint32_t kCount = 1024;
  constexpr std::size_t kPixels = 64;
  double sums[2][kPixels] = {}, squares[2][kPixels] = {};
  const auto add = [&](int set, const PathTracer& tracer, std::uint32_t index) {
    for (std::size_t p = 0; p < kPixels; ++p) {
      const double v = static_cast<double>(tracer.sample(static_cast<int>(p % 8), static_cast<int>(p / 8), index).radiance.y);
      sums[set][p] += v, squares[set][p] += v * v;
    }
  };
  for (std::uint32_t i = 0; i < kCount; ++i) {
    add(0, many, i);
    PathSettings settings;
    settings.seed = 1000 + i;
    add(1, PathTracer(scene, settings), 0);
  }
  double worst = 0, chi2 = 0;
  int used = 0;
  for (std::size_t p = 0; p < kPixels; ++p) {
    double mean[2], variance = 0;
    for (int s = 0; s < 2; ++s) {
      mean[s] = sums[s][p] / kCount;
      variance += (squares[s][p] / kCount - mean[s] * mean[s]) / kCount;
    }
    if (!(variance > 0)) continue;
    const double z = (mean[0] - mean[1]) / std::sqrt(variance);
    worst = std::max(worst, std::fabs(z)), chi2 += z * z, ++used;
  }
  std::printf("Z-test: worst |z| %.2f, mean z² %.2f over %d pixels\n", worst, chi2 / used, used);
  EXPECT_GT(used, 30);
  EXPECT_LT(worst, 4.5);
  EXPECT_LT(chi2 / used, 1.6);
}

TEST(PathTracer, SameBitsForAnyNumberOfThreads) {
  const Scene scene = mixed_scene();
  const std::size_t pixels = 24 * 24;
  const auto run = [&](int threads) {
    set_thread_count(threads);
    const PathTracer tracer(scene, {});
    std::vector<PathSample> samples(pixels);
    parallel_for(pixels, 7, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const PathSample s = tracer.sample(static_cast<int>(p % 24), static_cast<int>(p / 24), 5);
        samples[p].radiance = s.radiance, samples[p].depth = s.depth, samples[p].strand = s.strand;
      }
    });
    set_thread_count(0);
    return samples;
  };
  const auto one = run(1), three = run(3);
  for (std::size_t p = 0; p < pixels; ++p) {
    ASSERT_EQ(one[p].radiance, three[p].radiance) << p;
    ASSERT_EQ(one[p].depth, three[p].depth) << p;
    ASSERT_EQ(one[p].strand, three[p].strand) << p;
  }
}

TEST(PathTracer, PartsSumToTheWhole) {
  const Scene scene = mixed_scene();
  PathSettings settings;
  settings.split = true;
  const PathTracer tracer(scene, settings);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const PathSample s = tracer.sample(x, y, 1);
      Vec3 bounces, lobes;
      for (const Vec3 b : s.split->bounces) bounces += b;
      for (const Vec3 l : s.split->lobes) lobes += l;
      EXPECT_NEAR(bounces.y, s.radiance.y, 1e-4f * s.radiance.y);
      EXPECT_NEAR(lobes.y, s.radiance.y, 1e-3f * s.radiance.y);
      EXPECT_EQ(s.split->lobes[4].y > 0, s.alpha > 0 && !s.hair && s.radiance.y > 0);
    }
}

// Strands of no length, inside a mesh, lights inside of strands: every sample is finite.
TEST(PathTracer, FiniteWhereGeometryIsNot) {
  Scene scene = mixed_scene();
  auto set = std::make_shared<StrandSet>(*kit::strands({{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                                                        {{0, -0.1f, 0}, {0, -0.08f, 0}, {0, -0.07f, 0}, {0, -0.05f, 0}},
                                                        {{-0.1f, 0, 0}, {-0.03f, 0, 0}, {0.03f, 0, 0}, {0.1f, 0, 0}},
                                                        {{-0.1f, 0, 0}, {0.1f, 0, 0}, {-0.1f, 0, 0}, {0.1f, 0, 0}}},
                                                       0.02f));
  scene.grooms[0].strands = set;
  scene.lights[0].position = {0, 0, 0};
  scene.lights[1].position = {0.05f, 0.005f, 0};
  for (const CurveShape shape : {CurveShape::kFlat, CurveShape::kRound})
    for (const CurveBasis basis : {CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier, CurveBasis::kLinear})
      for (const Integrator integrator : {Integrator::kPath, Integrator::kDual, Integrator::kSingle}) {
        set->basis = basis;
        PathSettings settings;
        settings.integrator = integrator, settings.curve_shape = shape, settings.split = true;
        const PathTracer tracer(scene, settings);
        for (int y = 0; y < 24; ++y)
          for (int x = 0; x < 24; ++x) {
            const PathSample s = tracer.sample(x, y, 0);
            ASSERT_TRUE(is_finite(s.radiance) && is_finite(s.position) && is_finite(s.tangent) && is_finite(s.normal) &&
                        is_finite(s.albedo));
            ASSERT_TRUE(std::isfinite(s.u) && std::isfinite(s.width) && std::isfinite(s.motion.x));
          }
      }
}

TEST(PathTracer, EmptySceneIsEmpty) {
  Scene scene;
  scene.settings.width = scene.settings.height = 4;
  const PathSample nothing = PathTracer(scene, {}).sample(1, 2, 3);
  EXPECT_EQ(nothing.alpha, 0);
  EXPECT_TRUE(std::isinf(nothing.depth));
  scene.environment.visible = true, scene.environment.radiance = {1, 2, 3};
  const PathSample sky = PathTracer(scene, {}).sample(1, 2, 3);
  EXPECT_EQ(sky.alpha, 1);
  EXPECT_EQ(sky.radiance, Vec3(1, 2, 3));
}

// Dual scattering behind n strands: Zinke 2008, eq. 5, with the attenuation from quadrature.
TEST(PathTracer, DualScatteringBehindCountedStrands) {
  for (int n = 0; n < 4; ++n) {
    std::vector<std::vector<Vec3>> all;
    for (int i = 0; i <= n; ++i) {  // the first is seen, the others stand between it and the light
      const Vec3 at = Vec3(1, 0, 0) * (0.2f * static_cast<float>(i));
      all.push_back({at - Vec3(0, 0.5f, 0), at - Vec3(0, 0.2f, 0), at + Vec3(0, 0.2f, 0), at + Vec3(0, 0.5f, 0)});
    }
    Scene scene = scene_of(kit::strands(all, 0.02f), 0.01f, 4);
    Light light;
    light.direction = normalize(Vec3(-1, -0.3f, 0)), light.intensity = {2, 2, 2};
    scene.lights = {light};
    PathSettings settings;
    settings.integrator = Integrator::kDual;
    const PathSample s = PathTracer(scene, settings).sample(2, 2, 0);
    ASSERT_TRUE(s.hair);

    using namespace kernel;
    const HairMaterial& material = scene.grooms[0].material;
    const ScatterFiber fiber = make_fiber(material, {});
    const ScatterLobes lobes = scatter_prepare_marschner(fiber, 0, 1);
    const ScatterAverages averages = scatter_averages(lobes);
    const ScatterBack back = scatter_back(averages, lobes.sin_o, lobes.cos_o);
    const float sin_i = -light.direction.y, cos_i = std::sqrt(1 - sin_i * sin_i), cos_phi = 0;
    const float variance = static_cast<float>(n) * averages.v_f;
    Vec3 expected = scatter_dual_local(back, variance, sin_i, cos_i, cos_phi);
    if (n == 0) {
      expected += scatter_marschner(lobes, sin_i, cos_i, cos_phi);
    } else {
      expected += scatter_dual_forward_marschner(lobes, variance, sin_i, cos_i, cos_phi);
      const auto through = [&](float sigma_a) {
        return 0.7f * static_cast<float>(
                          std::pow(forward_attenuation(material, static_cast<double>(cos_i), static_cast<double>(sigma_a)), n));
      };
      expected = expected * Vec3(through(fiber.sigma_a.x), through(fiber.sigma_a.y), through(fiber.sigma_a.z));
    }
    for (const auto channel : {&Vec3::x, &Vec3::y, &Vec3::z})
      EXPECT_NEAR(s.radiance.*channel, 2 * expected.*channel, 0.02f * expected.*channel) << n;
  }
}

// An environment is many lights: sampled directions and a sum over a grid of directional lights agree.
TEST(PathTracer, DualScatteringInAnEnvironment) {
  Scene scene = scene_of(kit::ball(300, 0.1f, 3e-3f), 0.15f, 8);
  PathSettings settings;
  settings.integrator = Integrator::kDual;
  settings.positions = {{0.5f, 0.5f}};
  Scene lit = scene;
  scene.environment.radiance = {1, 1, 1};
  const Estimate sampled = estimate(PathTracer(scene, settings), scene, 4096);
  constexpr int kRows = 60, kColumns = 120;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const float polar = (static_cast<float>(y) + 0.5f) / kRows * 3.14159265f,
                  around = (static_cast<float>(x) + 0.5f) / kColumns * 6.28318531f;
      Light light;
      light.direction = {std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)};
      const float power = std::sin(polar) * 3.14159265f / kRows * 6.28318531f / kColumns;
      light.intensity = {power, power, power};
      lit.lights.push_back(light);
    }
  const Estimate summed = estimate(PathTracer(lit, settings), lit, 1);
  std::printf("dual in an environment: sampled %.5f ± %.5f, summed %.5f\n", sampled.mean, std::sqrt(sampled.variance),
              summed.mean);
  EXPECT_NEAR(sampled.mean, summed.mean, 0.02 * summed.mean);
}

// The place and the width of the first hit, and where it was a frame before.
TEST(PathTracer, FirstHit) {
  Scene scene = one_strand({-0.5f, 0, 0}, {0.5f, 0, 0}, 0.01f);
  PathSettings settings;
  settings.positions = {{0.5f, 0.5f}, {0.25f, 0.75f}};
  settings.previous_camera = scene.camera;
  settings.previous_camera->eye.x -= 0.005f, settings.previous_camera->target.x -= 0.005f;
  const PathTracer tracer(scene, settings);
  const PathSample s = tracer.sample(10, 8, 3);
  ASSERT_TRUE(s.hair);
  const float metre = 0.05f / 16;
  EXPECT_NEAR(s.position.x, (10.25f - 8) * metre, 1e-4f);  // Embree's u runs straight between its cuts
  EXPECT_NEAR(s.depth, 1, 0.006f);
  EXPECT_NEAR(s.width, 0.01f, 1e-6f);
  EXPECT_NEAR(s.u, 0.5f + s.position.x, 1e-2f);
  EXPECT_NEAR(s.motion.x, 0.005f / metre, 1e-3f);
  EXPECT_NEAR(s.motion.y, 0, 1e-3f);
  EXPECT_EQ(s.strand, 0u);
  EXPECT_EQ(tracer.sample(10, 8, 3).radiance, tracer.sample(10, 8, 3).radiance);
}

}  // namespace
}  // namespace pelage
