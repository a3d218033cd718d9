// Cameras that are found again from what they show.
#include "filter/camera_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/rng.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

constexpr int kWidth = 640, kHeight = 480;

CameraView view_of(Camera::Projection projection) {
  Camera camera;
  camera.projection = projection;
  camera.eye = {0.3f, 0.2f, 0.7f}, camera.target = {0.02f, -0.03f, 0}, camera.fov_y = 0.6f, camera.height = 0.4f;
  return make_camera_view(camera, kWidth, kHeight);
}

Vec2 seen_by(const CameraView& view, Vec3 position) { return project(view, transform_point(view.world_to_camera, position)); }

/// Places of a groom's size, and where a camera sees them, off by up to `noise` pixels.
struct Places {
  std::vector<Vec3> position;
  std::vector<Vec2> screen;

  Places(const CameraView& view, int count, float noise, Vec3 extent = {0.2f, 0.2f, 0.2f}, Vec3 center = {}) {
    Rng rng(3, 4);
    for (int i = 0; i < count; ++i) {
      const Vec3 p((rng.uniform() - 0.5f) * extent.x, (rng.uniform() - 0.5f) * extent.y, (rng.uniform() - 0.5f) * extent.z);
      position.push_back(p + center);
      screen.push_back(seen_by(view, p) + Vec2(2 * rng.uniform() - 1, 2 * rng.uniform() - 1) * noise);
    }
  }
};

float worst(const ProjectiveCamera& camera, const CameraView& view, const std::vector<Vec3>& positions, Vec3 center = {}) {
  float most = 0;
  for (const Vec3& p : positions) {
    ProjectiveCamera::Seen seen;
    if (!camera.see(p, seen)) return INFINITY;
    most = std::max(most, length(seen.screen - seen_by(view, p - center)));
  }
  return most;
}

class FittedCamera : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(, FittedCamera, testing::Values(Camera::Projection::kPerspective, Camera::Projection::kOrthographic));

TEST_P(FittedCamera, ShowsThePlacesWhereTheyWereSeen) {
  const CameraView view = view_of(GetParam());
  const Places places(view, 500, 0);
  EXPECT_LT(worst(fit_camera(places.position, places.screen), view, places.position), 2e-3f);
}

TEST_P(FittedCamera, NoiseIsAveragedAway) {
  const CameraView view = view_of(GetParam());
  const Places places(view, 20'000, 0.5f);
  EXPECT_LT(worst(fit_camera(places.position, places.screen), view, places.position), 0.04f);
}

TEST_P(FittedCamera, MovesDirectionsAsTheCameraDoes) {
  const CameraView view = view_of(GetParam());
  const Places places(view, 500, 0);
  const ProjectiveCamera camera = fit_camera(places.position, places.screen);
  Rng rng(5, 6);
  for (const Vec3& p : places.position) {
    const Vec3 along = normalize({rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f});
    const Vec3 c = transform_point(view.world_to_camera, p);
    const Vec2 expected = project_direction(view, c, transform_vector(view.world_to_camera, along));
    EXPECT_LT(length(camera.move(p, along) - expected), 1e-3f * length(expected) + 0.05f);
    // Off the middle a pixel is seen aslant, and is a little more than the scale along the axis.
    EXPECT_NEAR(camera.pixels_per_unit(p), pixels_per_metre(view, c.z), 0.06f * pixels_per_metre(view, c.z));
  }
}

TEST_P(FittedCamera, WorksFarFromTheOrigin) {
  const CameraView view = view_of(GetParam());
  const Vec3 center(300, -200, 100);  // floats there are 3e-5 apart: a twentieth of a pixel
  const Places places(view, 2000, 0, {0.2f, 0.2f, 0.2f}, center);
  EXPECT_LT(worst(fit_camera(places.position, places.screen), view, places.position, center), 0.1f);
}

// What the places say nothing about stays away: a sheet, a line, a single place.
TEST_P(FittedCamera, FewerDimensionsAreEnough) {
  const CameraView view = view_of(GetParam());
  for (const Vec3 extent : {Vec3(0.2f, 0.2f, 0), Vec3(0.2f, 0, 0), Vec3(0, 0, 0)}) {
    const Places places(view, 300, 0, extent);
    EXPECT_LT(worst(fit_camera(places.position, places.screen), view, places.position), 0.02f) << extent.x << extent.y;
  }
}

TEST(ProjectiveCamera, TakesTheScreenAsItIs) {
  const ProjectiveCamera camera;
  ProjectiveCamera::Seen seen;
  ASSERT_TRUE(camera.see({3.5f, 7.5f, 2}, seen));
  EXPECT_EQ(seen.screen, Vec2(3.5f, 7.5f));
  EXPECT_EQ(camera.move({3.5f, 7.5f, 2}, {0.6f, 0.8f, 5}), Vec2(0.6f, 0.8f));
  EXPECT_EQ(camera.pixels_per_unit({1, 2, 3}), 1.f);
  EXPECT_TRUE(fit_camera({}, {}).see({1, 1, 0}, seen));
}

TEST(FitCamera, SeesNothingBehindItself) {
  const CameraView view = view_of(Camera::Projection::kPerspective);
  const Places places(view, 500, 0);
  ProjectiveCamera::Seen seen;
  EXPECT_FALSE(fit_camera(places.position, places.screen).see({0.6f, 0.4f, 1.5f}, seen));
}

}  // namespace
}  // namespace pelage
