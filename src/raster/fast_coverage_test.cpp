// The fast coverage layer against the analytic one.
#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "assemble/assemble.h"
#include "frame/camera_view.h"
#include "raster/coverage.h"
#include "raster/raster.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

struct Both {
  GBuffer fast, exact;
};

Both raster_both(const Scene& scene, int width, int height) {
  const CameraView view = make_camera_view(scene.camera, width, height);
  const SegmentNumbering numbering = number_segments(scene, view);
  Both both;
  raster_strands(scene, view, numbering, {.center = false, .coverage = true}, both.fast);
  raster_strands(scene, view, numbering, {.center = false, .analytic = true}, both.exact);
  return both;
}

// Isolated and crossing strands of 0.1 to 3 pixels: cut across their axis, not along the miter, they cover the same area.
TEST(FastCoverage, IsTheAnalyticCoverage) {
  for (const float curl : {0.f, 0.004f})
    for (const float pixels : {0.1f, 0.4f, 1.f, 3.f}) {
      Scene scene = test::scene_of(test::helices(40, 24, curl, 1e-4f));
      const CameraView view = make_camera_view(scene.camera, 400, 400);
      scene.grooms[0].width_scale = pixels / (1e-4f * pixels_per_metre(view, 0.6f));
      const Both both = raster_both(scene, 400, 400);
      double error = 0, fast = 0, exact = 0;
      int touched = 0;
      for (std::size_t p = 0; p < both.fast.coverage.size(); ++p) {
        const double f = static_cast<double>(analytic_coverage(both.fast, p)),
                     e = static_cast<double>(analytic_coverage(both.exact, p));
        if (f == 0 && e == 0) continue;
        ++touched, error += std::abs(f - e), fast += f, exact += e;
      }
      EXPECT_GT(touched, 2000);
      // Bends of strands wider than a pixel have no miter here.
      const double bound = pixels > 1 ? 0.02 : 0.01;
      EXPECT_LT(error / touched, bound) << pixels << " pixels, curl " << curl;
      EXPECT_NEAR(fast / exact, 1, bound) << pixels << " pixels, curl " << curl;
    }
}

TEST(FastCoverage, SameBitsForAnyThreadsAndInstructionSet) {
  Scene scene = test::scene_of(test::helices(4000, 16, 0.002f, 8e-4f));  // so dense that tiles fill
  const CameraView view = make_camera_view(scene.camera, 150, 130);
  const SegmentNumbering numbering = number_segments(scene, view);
  const auto layer = [&] {
    GBuffer g;
    raster_strands(scene, view, numbering, {.center = false, .coverage = true}, g);
    return g;
  };
  set_thread_count(1);
  const GBuffer one = layer();
  EXPECT_GT(std::count(one.coverage.begin(), one.coverage.end(), *std::max_element(one.coverage.begin(), one.coverage.end())),
            2000);
  const auto same = [&](const GBuffer& g) {
    return std::memcmp(one.coverage.data(), g.coverage.data(), one.coverage.size() * sizeof(std::uint32_t)) == 0;
  };
  for (const int threads : {2, 3, 5}) {
    set_thread_count(threads);
    EXPECT_TRUE(same(layer())) << threads;
  }
  set_thread_count(0);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_TRUE(same(layer())) << isa;
  }
  set_isa("");
}

TEST(FastCoverage, EndsBehindTheOpaqueScene) {
  const Scene scene = test::scene_of(test::helices(200, 16));
  const CameraView view = make_camera_view(scene.camera, 64, 64);
  GBuffer g;
  g.opaque_depth.resize(64 * 64);
  for (std::size_t p = 0; p < g.opaque_depth.size(); ++p) g.opaque_depth[p] = p % 64 < 32 ? 0.1f : INFINITY;
  raster_strands(scene, view, number_segments(scene, view), {.center = false, .coverage = true}, g);
  double left = 0, right = 0;
  for (std::size_t p = 0; p < g.coverage.size(); ++p) (p % 64 < 32 ? left : right) += g.coverage[p];
  EXPECT_EQ(left, 0);
  EXPECT_GT(right, 0);
}

// Pixels that are said to be full read so; all others are as they are without.
TEST(FastCoverage, DrawsNothingWhereItIsSaidToBeFull) {
  const Scene scene = test::scene_of(test::helices(400, 16, 0.002f, 4e-4f));
  const CameraView view = make_camera_view(scene.camera, 150, 130);
  const SegmentNumbering numbering = number_segments(scene, view);
  const PixelMask full(150, 130, [](std::size_t p) { return p % 150 > 40 && p % 150 < 110 && p / 150 > 20 && p % 7 > 0; });
  GBuffer whole, rest;
  raster_strands(scene, view, numbering, {.center = false, .coverage = true}, whole);
  raster_strands(scene, view, numbering, {.center = false, .coverage = true, .full = &full}, rest);
  int drawn = 0;
  for (int y = 0; y < 130; ++y)
    for (int x = 0; x < 150; ++x) {
      const auto p = static_cast<std::size_t>(y * 150 + x);
      EXPECT_TRUE(full.contains(x, y) ? rest.coverage[p] > kFullDepth : rest.coverage[p] == whole.coverage[p]) << x << " " << y;
      drawn += !full.contains(x, y) && whole.coverage[p] > 0;
    }
  EXPECT_GT(drawn, 1500);
}

TEST(FullTiles, AreDeepWhenTheirNeighborsAreFull) {
  FullTiles tiles(20, 16);  // 3 × 2 tiles, the last column 4 pixels wide
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 20; ++x) {
      if (x == 19 && y == 15) continue;
      tiles.fill_pixel(x, y);
    }
  EXPECT_EQ(tiles.deep()[0], 1);
  EXPECT_EQ(tiles.deep()[1], 0);
  EXPECT_EQ(tiles.deep()[2], 0);
  tiles.fill_pixel(19, 15);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(tiles.deep()[i], 1) << i;
}

TEST(FullTiles, AreDeepFromTheBeginningWhereTheyAreSaidToBeFull) {
  const PixelMask full(40, 24, [](std::size_t p) { return p != 39; });  // all but a corner
  FullTiles tiles(40, 24, &full);
  for (int i = 0; i < 15; ++i) EXPECT_EQ(tiles.deep()[i], i == 3 || i == 4 || i == 8 || i == 9 ? 0 : 1) << i;
  tiles.fill_pixel(39, 0);
  EXPECT_EQ(tiles.deep()[4], 1);
}

}  // namespace
}  // namespace pelage
