#include "reference/silhouette.h"

#include <gtest/gtest.h>

#include <array>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "kit/trace_kit.h"
#include "reference/ray_scene.h"

namespace pelage {
namespace {

constexpr int kSize = 96;

/// A few strands that bend and widen, across a corner of the picture too.
Scene strands_of(CurveBasis basis, float width) {
  std::vector<std::vector<Vec3>> all;
  for (std::uint32_t s = 0; s < 12; ++s) {
    Rng rng(9, s);
    std::vector<Vec3> points;
    for (int i = 0; i < 7; ++i)
      points.push_back(Vec3(0.2f * static_cast<float>(i), 0, 0) + Vec3(rng.normal(), rng.normal(), rng.normal()) * 0.1f);
    all.push_back(points);
  }
  return kit::scene_of(kit::strands(all, width, basis), kSize, kSize);
}

Camera camera(Camera::Projection projection) {
  Camera c;
  c.projection = projection;
  c.eye = {0.9f, 0.3f, 0.9f}, c.target = {0.3f, 0.3f, 0};
  c.fov_y = 1.6f, c.height = 1.5f;
  return c;
}

// No ray of a pixel that is left out meets anything, and most pixels that see nothing are left out.
TEST(Silhouette, CoversAllThatRaysMeet) {
  for (const CurveBasis basis : {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier})
    for (const CurveShape shape : {CurveShape::kFlat, CurveShape::kRound})
      for (const auto projection : {Camera::Projection::kPerspective, Camera::Projection::kOrthographic})
        for (const float width : {0.002f, 0.2f}) {
          Scene scene = strands_of(basis, width);
          const RayScene rays(scene, shape);
          const CameraView view = make_camera_view(camera(projection), kSize, kSize);
          Silhouette silhouette(view);
          rays.add_to(silhouette);
          int covered = 0, met = 0;
          for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
              Rng rng(1, static_cast<std::uint32_t>(y * kSize + x));
              covered += silhouette.covers(x, y);
              for (int i = 0; i < 16; ++i) {
                const Ray ray = camera_ray(view, static_cast<float>(x) + rng.uniform(), static_cast<float>(y) + rng.uniform());
                if (rays.intersect(ray).kind == SceneHit::Kind::kNone) continue;
                ++met;
                ASSERT_TRUE(silhouette.covers(x, y)) << x << " " << y;
              }
            }
          EXPECT_GT(met, 500);
          if (width < 0.1f) {
            EXPECT_LT(covered, kSize * kSize / 2);
          }
        }
}

// A triangle that fills a part of the picture; one that reaches behind the eye may be seen anywhere.
TEST(Silhouette, KnowsMeshes) {
  for (const auto projection : {Camera::Projection::kPerspective, Camera::Projection::kOrthographic}) {
    Silhouette silhouette(make_camera_view(camera(projection), kSize, kSize));
    EXPECT_FALSE(silhouette.covers(0, 0) || silhouette.covers(kSize - 1, kSize - 1));
    silhouette.add(std::array{Vec4(0.3f, 0.3f, 0, 0), Vec4(0.4f, 0.3f, 0, 0), Vec4(0.3f, 0.4f, 0, 0)});
    EXPECT_TRUE(silhouette.covers(kSize / 2, kSize / 2));
    EXPECT_FALSE(silhouette.covers(0, 0) || silhouette.covers(kSize - 1, kSize - 1));
  }
  Silhouette silhouette(make_camera_view(camera(Camera::Projection::kPerspective), kSize, kSize));
  silhouette.add(std::array{Vec4(0.3f, 0.3f, 0, 0), Vec4(2, 0.3f, 2, 0), Vec4(0.3f, 0.4f, 0, 0)});
  EXPECT_TRUE(silhouette.covers(0, 0) && silhouette.covers(kSize - 1, kSize - 1));
}

}  // namespace
}  // namespace pelage
