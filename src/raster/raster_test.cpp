// Layers of the G-buffer: what they hold, and that threads, instruction sets and sizes do not matter.
#include "raster/raster.h"

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "../bench/naive_raster.h"
#include "assemble/assemble.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/draw_order.h"
#include "raster/gbuffer.h"
#include "raster/test_scene.h"
#include "raster/tile_locks.h"

namespace pelage {
namespace {

constexpr RasterLayers kAll{.center = true, .conservative = true, .samples = 8, .analytic = true, .overdraw = true};

GBuffer raster(const Scene& scene, int width, int height, const RasterLayers& layers, Buffer<float> opaque = {}) {
  const CameraView view = make_camera_view(scene.camera, width, height);
  GBuffer out;
  out.opaque_depth = std::move(opaque);
  raster_strands(scene, view, number_segments(scene, view), layers, out);
  return out;
}

std::size_t count_covered(const Buffer<PixelKey>& keys) {
  return static_cast<std::size_t>(std::count_if(keys.begin(), keys.end(), [](PixelKey k) { return k != kEmptyPixel; }));
}

template <class T>
bool same(const Buffer<T>& a, const Buffer<T>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

void expect_same(const GBuffer& a, const GBuffer& b) {
  EXPECT_TRUE(same(a.center, b.center));
  EXPECT_TRUE(same(a.conservative, b.conservative));
  EXPECT_TRUE(same(a.sample_keys, b.sample_keys));
  EXPECT_TRUE(same(a.coverage, b.coverage));
  EXPECT_TRUE(same(a.tangent_cos2, b.tangent_cos2));
  EXPECT_TRUE(same(a.tangent_sin2, b.tangent_sin2));
  EXPECT_TRUE(same(a.overdraw, b.overdraw));
}

TEST(Raster, DrawsAHorizontalBandOfItsWidth) {
  Scene scene = test::scene_of(test::strand({{-20, 0, 0}, {-3, 0, 0}, {20, 0, 0}}, 4));
  scene.camera = test::pixel_camera(32);
  const GBuffer g = raster(scene, 64, 32, kAll);
  EXPECT_EQ(count_covered(g.center), 40u * 4u);
  EXPECT_EQ(count_covered(g.sample_keys), 40u * 4u * 8u);
  EXPECT_FLOAT_EQ(key_depth(g.center[16 * 64 + 32]), 10.f);
  EXPECT_EQ(*std::max_element(g.overdraw.begin(), g.overdraw.end()), 1u) << "neighbors cover nothing twice";
  EXPECT_GT(analytic_coverage(g, 16 * 64 + 32), 0.999f);
  EXPECT_EQ(g.coverage[0], 0u);
  EXPECT_GT(g.tangent_cos2[16 * 64 + 32], 0);
}

TEST(Raster, SameBitsForAnyThreadCountAndInstructionSet) {
  for (const float width : {1e-4f, 8e-3f}) {
    const Scene scene = test::scene_of(test::helices(300, 40, 0.004f, width));
    set_thread_count(1);
    const GBuffer one = raster(scene, 257, 89, kAll);
    EXPECT_GT(count_covered(one.center), 200u);
    for (const int threads : {2, 3}) {
      set_thread_count(threads);
      expect_same(one, raster(scene, 257, 89, kAll));
    }
    set_thread_count(0);
    for (const std::string& isa : available_isas()) {
      SCOPED_TRACE(isa);
      set_isa(isa);
      expect_same(one, raster(scene, 257, 89, kAll));
    }
    set_isa("");
  }
}

/// The center layer and one of samples by the plain way, of a scene that nothing clips.
GBuffer plain(const Scene& scene, int width, int height, int samples) {
  const CameraView view = make_camera_view(scene.camera, width, height);
  const AssembleJob job = make_assemble_job(scene, view, number_segments(scene, view), 0);
  GBuffer out;
  clear_gbuffer(view, {.samples = samples}, out);
  bench::naive_center(job, out.center);
  bench::naive_samples(job, samples, out.sample_keys);
  return out;
}

TEST(Raster, SameBitsAsThePlainWay) {
  for (const CurveBasis basis : {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier})
    for (const int parts : {1, 3}) {
      StrandSet set = test::helices(200, 31, 0.004f, 5e-4f);
      set.basis = basis;
      Scene scene = test::scene_of(std::move(set));
      scene.settings.subdivisions = parts;
      const GBuffer fast = raster(scene, 320, 200, {.samples = 8}), wanted = plain(scene, 320, 200, 8);
      EXPECT_GT(count_covered(fast.center), 500u);
      EXPECT_TRUE(same(fast.center, wanted.center)) << static_cast<int>(basis) << " in " << parts;
      EXPECT_TRUE(same(fast.sample_keys, wanted.sample_keys)) << static_cast<int>(basis) << " in " << parts;
    }
}

TEST(Raster, SampleLayersHaveTheBitsOfThePlainWayForAnyThreadCountAndInstructionSet) {
  // Thin and wide, short segments and segments longer than a few tiles, on an image of many tiles.
  for (const int points : {2, 40})
    for (const float width : {1e-4f, 8e-3f}) {
      const Scene scene = test::scene_of(test::helices(points == 2 ? 200 : 60, points, 0.004f, width));
      for (const int samples : {1, 2, 4, 8, 16}) {
        const GBuffer wanted = plain(scene, 700, 611, samples);
        EXPECT_GT(count_covered(wanted.sample_keys), 1000u);
        for (const std::string& isa : available_isas()) {
          SCOPED_TRACE(isa + ", " + std::to_string(samples) + " samples, width " + std::to_string(width));
          set_isa(isa);
          for (const int threads : {1, 2, 5}) {
            if (threads == 5 && samples != 8) continue;
            set_thread_count(threads);
            expect_same(wanted, raster(scene, 700, 611, {.samples = samples}));
          }
        }
        set_isa(""), set_thread_count(0);
      }
    }
}

/// Strands that turn by any angle at every point, a few pixels long and up to a dozen wide, thick and thin in turns.
StrandSet crumpled(int strands, int points) {
  StrandSet set;
  set.offsets.push_back(0);
  for (int s = 0; s < strands; ++s) {
    Rng rng(11, static_cast<std::uint32_t>(s));
    const auto step = [&](float size) { return Vec3(rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f) * size; };
    Vec3 p = step(0.3f);
    for (int i = 0; i < points; ++i) {
      set.points.push_back(p += step(0.02f));
      set.widths.push_back(5e-3f * rng.uniform() * rng.uniform());
    }
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

TEST(Raster, SamplesOfSharpBendsAndConesHaveTheBitsOfThePlainWay) {
  const Scene scene = test::scene_of(crumpled(300, 20));
  for (const int samples : {2, 8}) {
    const GBuffer wanted = plain(scene, 700, 611, samples);
    EXPECT_GT(count_covered(wanted.sample_keys), 10000u);
    for (const std::string& isa : available_isas()) {
      set_isa(isa);
      expect_same(wanted, raster(scene, 700, 611, {.samples = samples}));
    }
    set_isa("");
  }
}

TEST(Raster, DrawsEveryStrandOfAnOrderThatIsNotTheirs) {
  // A field of strands side by side, numbered without regard to their places.
  constexpr std::uint32_t kAcross = 40, kDown = 13, kCount = kAcross * kDown;
  StrandSet set;
  set.offsets = {0}, set.widths = {2};
  for (std::uint32_t s = 0; s < kCount; ++s) {
    const std::uint32_t place = s * 197 % kCount;
    const Vec3 p(6 * static_cast<float>(place % kAcross) - 118, 14 * static_cast<float>(place / kAcross) - 88, 0);
    set.points.push_back(p), set.points.push_back(p + Vec3(0, 11, 0));
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  Scene scene = test::scene_of(std::move(set));
  scene.camera = test::pixel_camera(200);
  ASSERT_EQ(draw_order(scene.grooms[0], make_camera_view(scene.camera, 250, 200)).size(), kCount);
  const GBuffer drawn = raster(scene, 250, 200, {.samples = 2}), wanted = plain(scene, 250, 200, 2);
  std::set<std::uint32_t> seen;
  for (const PixelKey key : drawn.center)
    if (key != kEmptyPixel) seen.insert(key_id(key));
  EXPECT_EQ(seen.size(), kCount);
  EXPECT_TRUE(same(drawn.center, wanted.center));
  EXPECT_TRUE(same(drawn.sample_keys, wanted.sample_keys));
}

TEST(TileLocks, OneThreadOwnsATileAtATime) {
  constexpr int kTiles = 5, kSide = TileLocks::kSide;
  TileLocks locks(kTiles * kSide, kTiles * kSide - 1);
  std::atomic<int> owners[kTiles][kTiles] = {};
  std::atomic<int> shared{0};
  set_thread_count(4);
  parallel_for(500, 1, [&](std::size_t i, std::size_t) {
    Rng rng(3, static_cast<std::uint32_t>(i));
    const auto any_tile = [&](int from) { return from + static_cast<int>(rng.uniform() * static_cast<float>(kTiles - from)); };
    const int x0 = any_tile(0), x1 = any_tile(x0), y0 = any_tile(0), y1 = any_tile(y0);
    const auto for_tiles = [&](const auto& visit) {
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) visit(owners[y][x]);
    };
    locks.own({x0 * kSide, x1 * kSide + kSide / 2, y0 * kSide, y1 * kSide + kSide / 2}, [&] {
      for_tiles([&](std::atomic<int>& owner) { shared += owner.fetch_add(1) != 0; });
      std::this_thread::yield();
      for_tiles([](std::atomic<int>& owner) { --owner; });
    });
  });
  set_thread_count(0);
  EXPECT_EQ(shared, 0);
}

TEST(Raster, TakesAnySizeAndAnyNumberOfStrands) {
  for (const int strands : {0, 1, 2})
    for (const int width : {1, 2, 17}) {
      const Scene scene = test::scene_of(test::helices(strands, 12, 0.004f, 0.1f));
      const GBuffer g = raster(scene, width, 1 + width / 2, kAll);
      EXPECT_EQ(count_covered(g.center) > 0, strands > 0) << strands << " on " << width;
    }
  Scene scene;
  const GBuffer g = raster(scene, 5, 4, kAll);
  EXPECT_EQ(count_covered(g.conservative), 0u);
  EXPECT_THROW(raster(scene, 5, 4, {.samples = 3}), Error);
}

TEST(Raster, OpaqueDepthHidesWhatLiesBehind) {
  Scene scene = test::scene_of(test::strand({{-20, 0, 0}, {20, 0, 0}}, 8));
  scene.camera = test::pixel_camera(32);
  Buffer<float> opaque(64 * 32 * 8);
  for (std::size_t i = 0; i < opaque.size(); ++i) {
    const std::size_t x = i / 8 % 64, sample = i % 8;
    opaque[i] = x < 32 ? 9.f : sample < 4 ? 9.f : INFINITY;
  }
  const GBuffer g = raster(scene, 64, 32, kAll, std::move(opaque));
  EXPECT_EQ(count_covered(g.center), 20u * 8u);
  EXPECT_EQ(count_covered(g.sample_keys), 20u * 8u * 4u);
  EXPECT_EQ(g.center[0], kEmptyPixel);
  EXPECT_EQ(g.coverage[16 * 64 + 20], 0u);
  EXPECT_NEAR(analytic_coverage(g, 16 * 64 + 40), 0.5f, 0.01f);
}

TEST(Raster, CutsStrandsAtTheNearPlaneAndFarOutsideTheImage) {
  Scene scene = test::scene_of(test::strand({{0, -0.01f, 1e4f}, {0, -0.01f, -4}}, 0.02f));
  scene.camera.eye = {0, 0, 1}, scene.camera.near_plane = 0.5f, scene.camera.fov_y = 1;
  const GBuffer behind = raster(scene, 64, 64, kAll);
  EXPECT_GT(count_covered(behind.center), 0u);
  for (const PixelKey key : behind.center) EXPECT_TRUE(key == kEmptyPixel || key_depth(key) >= 0.5f);

  // A line from a million kilometres to the left to as far on the right, through the middle of the image.
  scene = test::scene_of(test::strand({{-1e9f, 2.25f, 0}, {1e9f, 2.25f, 0}}, 1));
  scene.camera = test::pixel_camera(32);
  const GBuffer across = raster(scene, 64, 32, kAll);
  EXPECT_EQ(count_covered(across.center), 64u);
  EXPECT_EQ(key_id(across.center[13 * 64]), 0u);
}

TEST(Raster, EndOnSegmentsAndTurnsOnTheSpotAreFinite) {
  Scene scene = test::scene_of(test::strand({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, 4));
  scene.camera = test::pixel_camera(32);
  EXPECT_EQ(count_covered(raster(scene, 64, 32, kAll).center), 0u);
  scene.grooms[0] = test::instance(test::strand({{-8, 0, 0}, {8, 0, 0}, {8, 0, 1}, {-8, 0, 1}}, 4));
  const GBuffer there_and_back = raster(scene, 64, 32, kAll);
  // Beyond the turn the limited miter reaches 1.5 radii, 3 pixels.
  EXPECT_EQ(count_covered(there_and_back.center), (16u + 3u) * 4u);
}

TEST(Raster, AnalyticCoverageOfAGroomIsThatOfSupersampling) {
  for (const int height : {10, 50, 200}) {
    const Scene scene = test::scene_of(test::helices(3000, 40, 0.004f, 2e-4f));
    const GBuffer g = raster(scene, height, height, {.center = false, .analytic = true});
    const GBuffer fine = raster(scene, 4 * height, 4 * height, {.center = false, .samples = 16});
    double error = 0, analytic = 0, exact = 0;
    int touched = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < height; ++x) {
        int hits = 0;
        for (int i = 0; i < 256; ++i) {
          const int at = (4 * y + i / 64) * 4 * height + 4 * x + i / 16 % 4;
          hits += fine.sample_keys[static_cast<std::size_t>(at) * 16 + static_cast<std::size_t>(i % 16)] != kEmptyPixel;
        }
        const double found = analytic_coverage(g, static_cast<std::size_t>(y * height + x)), wanted = hits / 256.0;
        if (found == 0 && wanted == 0) continue;
        ++touched, error += std::fabs(found - wanted), analytic += found, exact += wanted;
      }
    EXPECT_LE(error / touched, 0.03) << height;
    EXPECT_NEAR(analytic / exact, 1, 0.01) << height;
  }
}

TEST(Raster, ProgressCancels) {
  const Scene scene = test::scene_of(test::helices(300, 40));
  const CameraView view = make_camera_view(scene.camera, 32, 32);
  GBuffer out;
  EXPECT_THROW(raster_strands(scene, view, number_segments(scene, view), {}, out, [](auto, double) { return false; }), Error);
}

}  // namespace
}  // namespace pelage
