// Layers of the G-buffer: what they hold, and that threads and instruction sets do not matter.
#include "raster/raster.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include "assemble/assemble.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

GBuffer raster(const Scene& scene, int width, int height, const RasterLayers& layers) {
  const CameraView view = make_camera_view(scene.camera, width, height);
  GBuffer out;
  raster_strands(scene, view, number_segments(scene, view), layers, out);
  return out;
}

std::size_t count_covered(const Buffer<PixelKey>& keys) {
  return static_cast<std::size_t>(std::count_if(keys.begin(), keys.end(), [](PixelKey k) { return k != kEmptyPixel; }));
}

TEST(Raster, DrawsAHorizontalBandOfItsWidth) {
  Scene scene = test::scene_of(test::strand({{-20, 0, 0}, {-3, 0, 0}, {20, 0, 0}}, 4));
  scene.camera = test::pixel_camera(32);
  const GBuffer g = raster(scene, 64, 32, {.samples = 8});
  EXPECT_EQ(count_covered(g.center), 40u * 4u);
  EXPECT_EQ(count_covered(g.sample_keys), 40u * 4u * 8u);
  EXPECT_FLOAT_EQ(key_depth(g.center[16 * 64 + 32]), 10.f);
}

TEST(Raster, SameBitsForAnyThreadCount) {
  const Scene scene = test::scene_of(test::helices(300, 40));
  set_thread_count(1);
  const GBuffer one = raster(scene, 257, 89, {.samples = 4});
  set_thread_count(3);
  const GBuffer three = raster(scene, 257, 89, {.samples = 4});
  set_thread_count(0);
  EXPECT_GT(count_covered(one.center), 200u);
  EXPECT_TRUE(std::equal(one.center.begin(), one.center.end(), three.center.begin()));
  EXPECT_TRUE(std::equal(one.sample_keys.begin(), one.sample_keys.end(), three.sample_keys.begin()));
}

}  // namespace
}  // namespace pelage
