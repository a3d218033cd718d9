// Thick hairs against the fibers that they stand for, both path traced.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/runtime.h>
#include <pelage/trace.h>

#include <cmath>
#include <cstdio>

#include "kit/thick_kit.h"
#include "reference/fiber_cluster.h"
#include "reference/path_tracer.h"

namespace pelage {
namespace {

constexpr float kWide = 0.01f, kFiber = 2.5e-4f;
constexpr int kFibers = 60;

HairMaterial colored(float eumelanin) {
  HairMaterial m;
  m.eumelanin = eumelanin, m.pheomelanin = 0;
  return m;
}

/// Fibers along y as FiberCluster lays them out.
Scene fibers_scene(std::uint64_t seed) {
  const FiberCluster cluster({kFibers, kFiber, kWide, kWide}, seed);
  std::vector<std::vector<Vec3>> all;
  for (std::uint32_t i = 0; i < kFibers; ++i) {
    const Vec2 p = cluster.center(i);
    all.push_back({{p.x, -1, p.y}, {p.x, 1, p.y}});
  }
  return kit::scene_of(kit::strands(all, 2 * kFiber), 2 * kWide, 16);
}

Scene bundle_scene() {
  Scene scene = kit::scene_of(nullptr, 2 * kWide, 16);
  scene.grooms[0] = kit::thick_hair({{0, -1, 0}, {0, 1, 0}}, {{kWide, 0, 0}, {0, 0, kWide}, kFibers, kFiber});
  return scene;
}

struct Seen {
  double light = 0, coverage = 0;
};

Seen look(Scene scene, const HairMaterial& material, const Light& light, std::uint32_t samples) {
  scene.grooms[0].material = material, scene.lights = {light};
  const PathTracer tracer(scene, {});
  const kit::Estimate all = kit::estimate(tracer, scene, samples, [](const PathSample&) { return true; });
  const kit::Estimate met = kit::estimate(tracer, scene, 4);
  return {all.mean, static_cast<double>(met.count) / (4 * 16 * 16)};
}

// The same light comes back from fibers and from the thick hair that stands for them. Over the lit side of light hair the model is up to 0.34
// off traced bundles (docs/derivations/aggregated_scattering.md), which bounds single angles; over all of them it has the right energy.
TEST(ThickTrace, OneThickHairIsItsFibers) {
  constexpr int kClusters = 12;
  double sum_fibers = 0, sum_bundle = 0;
  for (const float eumelanin : {0.f, 8.f}) {
    for (const float azimuth : {0.5f, 1.2f, 2.f, 2.8f}) {
      for (const float inclination : {0.f, 0.6f}) {
        Light light;
        light.direction = {-std::sin(azimuth) * std::cos(inclination), -std::sin(inclination),
                           -std::cos(azimuth) * std::cos(inclination)};
        light.intensity = {1, 1, 1};
        Seen fibers;
        for (std::uint64_t seed = 0; seed < kClusters; ++seed) {
          const Seen s = look(fibers_scene(seed), colored(eumelanin), light, 24);
          fibers.light += s.light / kClusters, fibers.coverage += s.coverage / kClusters;
        }
        const Seen bundle = look(bundle_scene(), colored(eumelanin), light, 192);
        std::printf("eumelanin %.1f azimuth %.1f inclination %.1f: fibers %.4f, thick hair %.4f (%.3f); coverage %.3f, %.3f\n",
                    static_cast<double>(eumelanin), static_cast<double>(azimuth), static_cast<double>(inclination),
                    fibers.light, bundle.light, bundle.light / fibers.light, fibers.coverage, bundle.coverage);
        EXPECT_NEAR(bundle.light, fibers.light, 0.34 * fibers.light);
        EXPECT_NEAR(bundle.coverage, fibers.coverage, 0.02);
        sum_fibers += fibers.light, sum_bundle += bundle.light;
      }
    }
  }
  std::printf("all angles: %.3f\n", sum_bundle / sum_fibers);
  EXPECT_NEAR(sum_bundle, sum_fibers, 0.03 * sum_fibers);
}

constexpr float kTwist = 36;  ///< radians a metre: fibers at the hull lean by 20°

/// The same fibers, turning about the y axis.
Scene twisted_fibers_scene(std::uint64_t seed) {
  const FiberCluster cluster({kFibers, kFiber, kWide, kWide}, seed);
  std::vector<std::vector<Vec3>> all(kFibers);
  for (std::uint32_t i = 0; i < kFibers; ++i)
    for (float y = -0.06f; y < 0.0601f; y += 0.004f) {
      const Vec2 p = cluster.center(i);
      const float c = std::cos(kTwist * y), s = std::sin(kTwist * y);  // right-handed about +y: z turns to x
      all[i].emplace_back(c * p.x + s * p.y, y, c * p.y - s * p.x);
    }
  return kit::scene_of(kit::strands(all, 2 * kFiber), 2 * kWide, 16);
}

Scene twisted_bundle_scene(float twist) {
  Scene scene = kit::scene_of(nullptr, 2 * kWide, 16);
  scene.grooms[0] =
      kit::thick_hair({{0, -0.06f, 0}, {0, 0.06f, 0}},
                      {{kWide, 0, 0}, {0, 0, kWide}, kFibers, kFiber, 0.25f * kTwist * kTwist * kWide * kWide, twist});
  return scene;
}

/// What of the scene stands on the side of +x.
Scene right_half(Scene scene) {
  scene.camera.eye.x += kWide, scene.camera.target.x += kWide;
  return scene;
}

// Of fibers that wind about the middle of their ply, those on one side lean toward the eye and shine under a light from above, those on the
// other away from it, under one from below. A thick hair that knows its twist does alike.
TEST(ThickTrace, ATwistedThickHairIsItsFibers) {
  constexpr int kClusters = 12;
  HairMaterial material = colored(8);
  material.cuticle_tilt = 0;  // what the light's inclination tells apart is the twist
  std::vector<double> fibers, with, without;
  for (const float inclination : {-0.6f, 0.6f}) {
    Light light;
    light.direction = {0, -std::sin(inclination), -std::cos(inclination)}, light.intensity = {1, 1, 1};
    const auto seen = [&](const Scene& scene, std::uint32_t samples) {
      return look(right_half(scene), material, light, samples).light;
    };
    fibers.push_back(0);
    for (std::uint64_t seed = 0; seed < kClusters; ++seed) fibers.back() += seen(twisted_fibers_scene(seed), 24) / kClusters;
    with.push_back(seen(twisted_bundle_scene(kTwist), 192)), without.push_back(seen(twisted_bundle_scene(0), 192));
  }
  std::printf("light from above over light from below: fibers %.3f, twisted %.3f, untwisted %.3f\n", fibers[1] / fibers[0],
              with[1] / with[0], without[1] / without[0]);
  EXPECT_NEAR(without[1] / without[0], 1, 0.05);
  EXPECT_GT(std::fabs(std::log(fibers[1] / fibers[0])), 0.3);
  EXPECT_NEAR(std::log(with[1] / with[0]), std::log(fibers[1] / fibers[0]), 0.25 * std::fabs(std::log(fibers[1] / fibers[0])));
}

/// A ball of bent thick hairs, one across the other.
Scene ball_of_bundles() {
  const std::shared_ptr<StrandSet> curves = kit::ball(300, 0.1f, 1e-3f);
  Scene scene = kit::scene_of(curves, 0.25f, 48);
  auto sections = std::make_shared<ThickSections>();
  for (std::size_t i = 0; i < curves->point_count(); ++i) {
    sections->major.push_back({0.004f, 0, 0}), sections->minor.push_back({0, 0.0005f, 0.003f});
    sections->fibers.push_back(30), sections->diameters.push_back(4e-4f);
    sections->spreads.push_back(0.01f);
  }
  scene.grooms[0].sections = sections;
  return scene;
}

// White hair in a white furnace is never brighter than the sky, and darker by no more than what the model keeps back.
TEST(ThickTrace, WhiteFurnace) {
  Scene scene = ball_of_bundles();
  scene.environment.radiance = {1, 1, 1};
  PathSettings settings;
  settings.max_bounces = 1000;
  for (const HairMaterial::Model model : {HairMaterial::Model::kMarschner, HairMaterial::Model::kZhu}) {
    scene.grooms[0].material = colored(0);
    scene.grooms[0].material.model = model;
    const kit::Estimate e = kit::estimate(PathTracer(scene, settings), scene, 64);
    std::printf("furnace: %.4f ± %.4f\n", e.mean, std::sqrt(e.variance));
    EXPECT_LE(e.mean, 1 + 3 * std::sqrt(e.variance));
    EXPECT_GE(e.mean, 0.96);
  }
}

TEST(ThickTrace, SameBitsForAnyNumberOfThreads) {
  Scene scene = ball_of_bundles();
  scene.lights.emplace_back();
  TraceSettings settings;
  settings.samples = 4;
  settings.layers = {TraceLayer::kCoverage, TraceLayer::kDepth, TraceLayer::kStrand, TraceLayer::kU};
  set_thread_count(1);
  const TraceResult one = trace(scene, settings);
  set_thread_count(4);
  const TraceResult four = trace(scene, settings);
  set_thread_count(0);
  EXPECT_EQ(one.linear.pixels, four.linear.pixels);
}

// Thick hairs of which parts are drawn: two parts that touch are the hair, its places along it too, and one of them is half of it.
TEST(ThickTrace, PartsOfThickHairsAreWhereTheyWere) {
  Scene whole = kit::scene_of(nullptr, 1.2f, 32);
  whole.grooms[0] = kit::thick_hairs({{{-0.3f, -0.5f, 0}, {-0.3f, -0.2f, 0}, {-0.3f, 0.3f, 0}, {-0.3f, 0.5f, 0}},
                                      {{0.3f, -0.5f, 0}, {0.3f, 0, 0}, {0.3f, 0.5f, 0}}},
                                     {{0.2f, 0, 0}, {0, 0, 0.2f}, 4000, 1e-4f});
  const auto traced = [&](std::vector<StrandPart> parts) {
    Scene scene = whole;
    if (!parts.empty()) scene.grooms[0].only = std::make_shared<const std::vector<StrandPart>>(std::move(parts));
    TraceSettings settings;
    settings.samples = 8, settings.layers = {TraceLayer::kCoverage, TraceLayer::kStrand, TraceLayer::kU};
    return trace(scene, settings).linear.pixels;
  };
  const std::vector<float> all = traced({});
  EXPECT_EQ(traced({{0, 0, 3}, {1, 0, 2}}), all);
  EXPECT_EQ(traced({{0, 0, 1}, {0, 1, 2}, {1, 0, 2}}), all);
  EXPECT_NE(traced({{0, 1, 2}, {1, 0, 2}}), all);
  const std::vector<float> second = traced({{1, 0, 2}});
  double both = 0, one = 0;
  for (const float v : all) both += static_cast<double>(v);
  for (const float v : second) one += static_cast<double>(v);
  EXPECT_LT(one, both);
}

// Where thick hairs cross, light passes each by chance, as it passes both: shares multiply.
TEST(ThickTrace, CrossedHairsAreMetAsOften) {
  const kit::Bundle bundle{{kWide, 0, 0}, {0, 0, kWide}, 20, kFiber};
  const auto met = [&](std::vector<std::vector<Vec3>> curves) {
    Scene scene = kit::scene_of(nullptr, 0.5f * kWide, 16);
    scene.grooms[0] = kit::thick_hairs(curves, bundle);
    const kit::Estimate e = kit::estimate(PathTracer(scene, {}), scene, 256);
    return static_cast<double>(e.count) / (256 * 16 * 16);
  };
  const double one = met({{{0, -1, 0}, {0, 1, 0}}}), behind = met({{{0, -1, 0}, {0, 1, 0}}, {{0, -1, -0.1f}, {0, 1, -0.1f}}}),
               within = met({{{0, -1, 0}, {0, 1, 0}}, {{0, -1, -0.005f}, {0, 1, -0.005f}}});
  const double sigma = std::sqrt(0.25 / (256 * 16 * 16));
  EXPECT_NEAR(behind, 1 - (1 - one) * (1 - one), 5 * sigma);
  EXPECT_NEAR(within, behind, 5 * sigma);
}

TEST(ThickTrace, SectionsThatDoNotFitAreTold) {
  Scene scene = ball_of_bundles();
  auto broken = std::make_shared<ThickSections>(*scene.grooms[0].sections);
  broken->fibers.pop_back();
  scene.grooms[0].sections = broken;
  EXPECT_THROW(trace(scene, {}), Error);
  scene = ball_of_bundles();
  broken = std::make_shared<ThickSections>(*scene.grooms[0].sections);
  broken->fibers[3] = 0;
  scene.grooms[0].sections = broken;
  EXPECT_THROW(trace(scene, {}), Error);
  scene = ball_of_bundles();
  TraceSettings dual;
  dual.integrator = Integrator::kDual;
  EXPECT_THROW(trace(scene, dual), Error);
}

}  // namespace
}  // namespace pelage
