// Orders of strands: whole, by strips and nearness, and left alone where they would not pay.
#include "frame/draw_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

constexpr int kSize = 256;
constexpr float kHalf = kSize / 2;

/// `count` strands of two points, 40 pixels high and `width` wide at random places of a picture on which a metre is a pixel.
Scene hanging(std::uint32_t count, float width, bool sorted = false) {
  std::vector<Vec3> places;
  for (std::uint32_t s = 0; s < count; ++s) {
    Rng rng(5, s);
    places.push_back({kHalf * (2 * rng.uniform() - 1), 0, -20 * rng.uniform()});
  }
  if (sorted) std::sort(places.begin(), places.end(), [](Vec3 a, Vec3 b) { return a.x < b.x; });
  StrandSet set;
  set.offsets = {0}, set.widths = {width};
  for (const Vec3 p : places) {
    set.points.push_back(p + Vec3(0, 20, 0)), set.points.push_back(p - Vec3(0, 20, 0));
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  Scene scene = test::scene_of(std::move(set));
  scene.camera = test::pixel_camera(kSize);
  return scene;
}

std::vector<std::uint32_t> order_of(const Scene& scene) {
  return draw_order(scene.grooms[0], make_camera_view(scene.camera, kSize, kSize));
}

TEST(DrawOrder, HoldsEveryStrandOnce) {
  std::vector<std::uint32_t> order = order_of(hanging(3000, 2)), all(3000);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, all);
}

TEST(DrawOrder, GoesFromStripToStripAndFromNearToFar) {
  const Scene scene = hanging(3000, 2);
  const auto& points = scene.grooms[0].strands->points;
  const std::vector<std::uint32_t> order = order_of(scene);
  float farthest_left = -kHalf, deepest = 0;
  int strips = 1, steps_back = 0;
  for (const std::uint32_t strand : order) {
    const Vec3 p = points[2 * strand];
    EXPECT_GT(p.x, farthest_left - 2 * kHalf / 16 - 1) << "no strip is wider";
    farthest_left = std::max(farthest_left, p.x);
    if (-p.z + 10 < deepest) ++strips, deepest = 0;  // back to the front
    steps_back += -p.z + 20.f / 64 + 0.01f < deepest;
    deepest = std::max(deepest, -p.z);
  }
  EXPECT_GE(strips, 15);
  EXPECT_LE(strips, 17);
  EXPECT_LT(steps_back, 40) << "in a strip, a strand may stand before the one that it follows by no more than a depth's part";
}

TEST(DrawOrder, StripsLieAcrossStrandsThatLieDown) {
  Scene scene = hanging(3000, 2);
  StrandSet lying = *scene.grooms[0].strands;
  for (Vec3& p : lying.points) std::swap(p.x, p.y);
  scene.grooms[0].strands = std::make_shared<const StrandSet>(lying);
  const std::vector<std::uint32_t> order = order_of(scene);
  ASSERT_EQ(order.size(), 3000u);
  const auto mean_y = [&](std::size_t begin, std::size_t end) {
    float sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += lying.points[2 * order[i]].y;
    return sum / static_cast<float>(end - begin);
  };
  EXPECT_GT(std::fabs(mean_y(0, 150) - mean_y(2850, 3000)), 1.8f * kHalf);
}

TEST(DrawOrder, LeavesAloneWhatWouldNotPay) {
  EXPECT_TRUE(order_of(hanging(3000, 2, true)).empty()) << "neighbors stand together";
  EXPECT_TRUE(order_of(hanging(3000, 0.1f)).empty()) << "strands cover little";
}

TEST(DrawOrder, TakesEmptyGroomsAndStrandsBehindTheCamera) {
  StrandSet none;
  none.offsets = {0}, none.widths = {1};
  Scene scene = test::scene_of(std::move(none));
  EXPECT_TRUE(order_of(scene).empty());
  scene = hanging(3000, 2);
  scene.camera = Camera{};
  scene.camera.eye = {0, 0, -10};
  const std::vector<std::uint32_t> order = order_of(scene);
  EXPECT_TRUE(order.empty() || order.size() == 3000u);
}

}  // namespace
}  // namespace pelage
