#include "frame/window.h"

#include <gtest/gtest.h>
#include <pelage/render.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "kernel/scalar.h"
#include "kit/grown_chain.h"
#include "light/strand_lines.h"
#include "frame/segment_lookup.h"

namespace pelage {
namespace {

const MeshTracer kNoMeshes({});

bool same(const Window& a, const Window& b) { return a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height; }

TEST(Window, HoldsAllThatIsSeenOfABox) {
  Rng rng(4, 1);
  const auto random = [&](float size) { return Vec3(rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f) * size; };
  std::size_t seen = 0, smaller = 0;
  for (int i = 0; i < 300; ++i) {
    const CameraView view = kit::view_from(random(8) + Vec3(0, 0, 6));
    Bounds box;
    const Vec3 middle = random(2);
    for (int corner = 0; corner < 2; ++corner) box.extend(middle + random(1));
    const Window window = window_of(view, box, kNoMeshes);
    smaller += window.width * window.height < view.width * view.height;
    for (int j = 0; j < 50; ++j) {
      const Vec3 share(rng.uniform(), rng.uniform(), rng.uniform());
      const Vec3 c = transform_point(view.world_to_camera, box.lower + box.extent() * share);
      if (c.z < view.near_plane) continue;
      const Vec2 p = project(view, c);
      if (p.x < 0 || p.y < 0 || p.x >= static_cast<float>(view.width) || p.y >= static_cast<float>(view.height)) continue;
      ++seen;
      const auto x = static_cast<int>(p.x) - window.x, y = static_cast<int>(p.y) - window.y;
      ASSERT_TRUE(x >= 0 && y >= 0 && x < window.width && y < window.height) << i;
    }
  }
  EXPECT_GT(seen, 2000u);
  EXPECT_GT(smaller, 200u);
}

TEST(Window, IsThePictureWhereNothingBetterIsKnown) {
  const CameraView view = kit::view_from({0, 0, 3});
  const Window whole{0, 0, view.width, view.height};
  EXPECT_TRUE(same(window_of(view, {}, kNoMeshes), whole)) << "of unknown strands";
  EXPECT_TRUE(same(window_of(view, {{-1, -1, -1}, {1, 1, 4}}, kNoMeshes), whole)) << "around the eye";
  const Window beside = window_of(view, {{50, 0, 0}, {51, 1, 1}}, kNoMeshes);
  EXPECT_EQ(beside.width * beside.height, 0);
}

// Overshooting curves and their widths are inside what lights say that strands reach.
TEST(Window, StrandsStayWithinTheirReach) {
  for (const CurveBasis basis : {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier}) {
    auto set = std::make_shared<StrandSet>();
    set->basis = basis, set->offsets = {0};
    Rng rng(5, static_cast<std::uint32_t>(basis));
    for (int s = 0; s < 300; ++s) {
      for (int i = 0; i < 7; ++i)  // the ends of a box, so that curves overshoot it
        set->points.push_back(Vec3(rng.uniform() < 0.5f, rng.uniform() < 0.5f, rng.uniform())),
            set->widths.push_back(0.2f * rng.uniform());
      set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
    }
    GroomInstance groom;
    groom.strands = set;
    const Bounds reach = StrandLines(groom).reach();
    bool beyond = false;
    for (std::uint32_t s = 0; s < set->strand_count(); ++s)
      for (std::uint32_t span = 0; span < span_count(basis, 7); ++span)
        for (const float t : {0.f, 0.2f, 0.5f, 0.8f, 1.f}) {
          Vec3 p[4];
          span_points(*set, s, span, p);
          const Vec3 at = kernel::curve_combine(basis_weights(basis, t), p[0], p[1], p[2], p[3]);
          const float half = 0.1f;  // of the widest
          ASSERT_TRUE(at.x - half >= reach.lower.x - 2e-3f && at.x + half <= reach.upper.x + 2e-3f) << at.x;
          ASSERT_TRUE(at.y - half >= reach.lower.y - 2e-3f && at.y + half <= reach.upper.y + 2e-3f) << at.y;
          beyond = beyond || at.x > 1.05f;
        }
    EXPECT_EQ(beyond, basis == CurveBasis::kCatmullRom) << "control points alone would not do";
  }
}

// A picture that is mostly empty: what its window leaves out is backdrop, and what it makes is what a window over all of it makes. A strand far
// aside, which is not seen, makes it that.
TEST(Window, LeavesNothingOut) {
  Scene scene;
  scene.grooms.push_back(kit::groom_with_chain(HairStyle::kCurly, 300, 1));
  scene.grooms[0].width_scale = 10;
  scene.settings.thick_hairs.on = false, scene.settings.shadows = false;
  scene.settings.width = 160, scene.settings.height = 120;
  scene.camera.eye = {0.4f, 0.2f, 6}, scene.camera.target = {0.5f, -0.3f, 0}, scene.camera.fov_y = 0.6f;
  scene.lights.push_back({});
  const RenderResult small = render(scene);
  auto aside = std::make_shared<StrandSet>();
  aside->points = {{-40, -40, -1}, {-40, -40, -1.1f}, {40, 40, -1}, {40, 40, -1.1f}};
  aside->offsets = {0, 2, 4}, aside->widths = {1e-4f};
  scene.grooms.push_back({});
  scene.grooms.back().strands = aside;
  const RenderResult whole = render(scene);
  double most = 0, light = 0;
  for (std::size_t i = 0; i < small.linear.pixels.size(); ++i) {
    most = std::max(most, static_cast<double>(std::fabs(small.linear.pixels[i] - whole.linear.pixels[i])));
    light += static_cast<double>(std::fabs(small.linear.pixels[i] - small.linear.pixels[i % 4]));
  }
  EXPECT_GT(light, 10) << "hair is seen";
  EXPECT_LT(most, 2e-3) << "roundings of places on strands";
}

}  // namespace
}  // namespace pelage
