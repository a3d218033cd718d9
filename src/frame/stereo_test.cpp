// Two eyes in place of one: where they stand, how depth shifts what they see, and pictures of every method.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/denoise.h>
#include <pelage/error.h>
#include <pelage/render.h>

#include <cmath>

#include "composite/side_by_side.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

using testing::HasSubstr;

Camera camera_of(Stereo stereo) {
  Camera camera;
  camera.eye = {0.3f, 0.2f, 1.1f}, camera.target = {-0.1f, 0.05f, -0.2f}, camera.fov_y = 0.6f;
  camera.stereo = stereo;
  return camera;
}

/// A place `depth` before the eyes, off the axis by `aside`.
Vec3 place_at(const Camera& camera, float depth, Vec2 aside) {
  Camera one = camera;
  one.stereo.reset();
  return transform_point(make_camera_view(one, 640, 480).camera_to_world, {aside.x, aside.y, depth});
}

/// Where an eye shows a place, pixels.
Vec2 seen_by(const Camera& eye, Vec3 place) {
  const CameraView view = make_camera_view(eye, 640, 480);
  return project(view, transform_point(view.world_to_camera, place));
}

TEST(Stereo, OneEyeIsTheCamera) {
  const Camera camera;
  const std::vector<Camera> one = eyes(camera);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].eye, camera.eye);
  EXPECT_EQ(one[0].shift_x, 0);
}

TEST(Stereo, EyesStandSideBySideAndLookTheSameWay) {
  const Camera camera = camera_of({.separation = 0.08f});
  const std::vector<Camera> both = eyes(camera);
  ASSERT_EQ(both.size(), 2u);
  const Vec3 right = normalize(cross(camera.target - camera.eye, camera.up));
  EXPECT_NEAR(dot(both[1].eye - both[0].eye, right), 0.08f, 1e-6f) << "the left one comes first";
  EXPECT_NEAR(length(both[1].eye - both[0].eye), 0.08f, 1e-6f);
  EXPECT_LT(length(0.5f * (both[0].eye + both[1].eye) - camera.eye), 1e-6f);
  for (const Camera& eye : both) {
    EXPECT_FALSE(eye.stereo);
    EXPECT_LT(length((eye.target - eye.eye) - (camera.target - camera.eye)), 1e-6f);
    EXPECT_EQ(eye.fov_y, camera.fov_y);
  }
}

// x_left − x_right = separation·focal·(1/z − 1/convergence), and rows are the same.
TEST(Stereo, DisparityFollowsItsFormula) {
  for (const float convergence : {0.f, 0.4f, 2.5f}) {
    const Camera camera = camera_of({.separation = 0.063f, .convergence = convergence});
    const std::vector<Camera> both = eyes(camera);
    const double plane = convergence > 0 ? static_cast<double>(convergence) : length(camera.target - camera.eye);
    const double focal = 240 / std::tan(0.3);
    for (const float z : {0.3f, 0.8f, 1.5f, 20.f})
      for (const Vec2 aside : {Vec2(0, 0), Vec2(0.1f, -0.07f)}) {
        const Vec3 place = place_at(camera, z, aside);
        const Vec2 left = seen_by(both[0], place), right = seen_by(both[1], place);
        EXPECT_NEAR(left.x - right.x, 0.063 * focal * (1 / static_cast<double>(z) - 1 / plane), 2e-3) << z << ", " << plane;
        EXPECT_NEAR(left.y, right.y, 1e-3f);
      }
    const Vec3 in_plane = place_at(camera, static_cast<float>(plane), {0.02f, 0.03f});
    EXPECT_NEAR(seen_by(both[0], in_plane).x, seen_by(both[1], in_plane).x, 1e-3f);
  }
}

TEST(Stereo, TheTargetStaysInTheMiddle) {
  const Camera camera = camera_of({});
  for (const Camera& eye : eyes(camera)) {
    EXPECT_NEAR(seen_by(eye, camera.target).x, 320, 1e-3f);
    EXPECT_NEAR(seen_by(eye, camera.target).y, 240, 1e-3f);
  }
}

TEST(LensShift, ShowsWhatLiesToTheRightAndAbove) {
  Camera camera = camera_of({});
  camera.stereo.reset();
  const Vec3 place = place_at(camera, 1, {0.05f, 0.02f});
  const Vec2 before = seen_by(camera, place);
  camera.shift_x = 0.25f, camera.shift_y = 0.125f;
  EXPECT_NEAR(seen_by(camera, place).x, before.x - 120, 1e-3f);
  EXPECT_NEAR(seen_by(camera, place).y, before.y + 60, 1e-3f);
}

std::string error_of(const Camera& camera) {
  try {
    for (const Camera& eye : eyes(camera)) make_camera_view(eye, 64, 48);
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Stereo, BadDistancesAreErrors) {
  EXPECT_EQ(error_of(camera_of({})), "none");
  for (const float separation : {0.f, -0.1f, INFINITY, NAN})
    EXPECT_THAT(error_of(camera_of({.separation = separation})), HasSubstr("separation"));
  for (const float convergence : {-1.f, INFINITY, NAN})
    EXPECT_THAT(error_of(camera_of({.convergence = convergence})), HasSubstr("convergence"));
  EXPECT_THAT(error_of(camera_of({.separation = 1, .convergence = 0.01f})), HasSubstr("larger beside the separation"));
  Camera flat = camera_of({});
  flat.projection = Camera::Projection::kOrthographic;
  EXPECT_THAT(error_of(flat), HasSubstr("orthographic"));
  Camera shifted;
  shifted.shift_y = 11;
  EXPECT_THAT(error_of(shifted), HasSubstr("shift_y"));
  shifted.shift_y = NAN;
  EXPECT_THAT(error_of(shifted), HasSubstr("shift_y"));
}

TEST(Stereo, WhatMakesOnePictureRefusesTwoEyes) {
  Scene scene = test::hairy_scene();
  scene.camera.stereo = Stereo();
  EXPECT_THROW(make_camera_view(scene.camera, 64, 48), Error);
  EXPECT_THROW(render_gbuffer(scene), Error);
}

// Pictures of all methods are those of each eye alone, and so are other views.
TEST(Stereo, EveryPictureIsThatOfEachEye) {
  Scene scene = test::hairy_scene();
  test::add_tile(scene);
  scene.camera.stereo = Stereo{.separation = 0.03f};
  scene.settings.samples = 1, scene.settings.frames = 3;
  const auto expect_eyes = [&](const std::string& what) {
    const RenderResult both = render(scene);
    ASSERT_EQ(both.linear.width, 2 * scene.settings.width);
    const std::vector<Camera> cameras = eyes(scene.camera);
    Scene one = scene;
    std::vector<RenderResult> alone;
    for (int e = 0; e < 2; ++e) {
      one.camera = cameras[static_cast<std::size_t>(e)];
      alone.push_back(render(one));
      EXPECT_EQ(part_of(both.linear, e, 2).pixels, alone.back().linear.pixels) << what << ", eye " << e;
      EXPECT_EQ(part_of(both.display, e, 2).pixels, alone.back().display.pixels) << what << ", eye " << e;
    }
    EXPECT_NE(alone[0].linear.pixels, alone[1].linear.pixels) << what;
  };
  for (const Method method : {Method::kMsaa, Method::kSsaa, Method::kTaa, Method::kFxaa, Method::kSmaa, Method::kLink})
    scene.settings.method = method, expect_eyes("method " + std::to_string(static_cast<int>(method)));
  scene.settings.method = Method::kMsaa;
  for (const View view : {View::kDepth, View::kTangent}) scene.settings.view = view, expect_eyes("view");
}

// Motion of each eye is that since the same eye a frame ago.
TEST(Stereo, MotionIsThatOfTheEye) {
  Scene scene = test::hairy_scene();
  test::add_tile(scene);
  scene.settings.view = View::kMotion;
  scene.camera.stereo = Stereo{.separation = 0.03f};
  scene.previous_camera = scene.camera;
  scene.previous_camera->eye.x -= 0.01f;
  const RenderResult both = render(scene);
  const std::vector<Camera> now = eyes(scene.camera), before = eyes(*scene.previous_camera);
  for (std::size_t e = 0; e < 2; ++e) {
    Scene one = scene;
    one.camera = now[e], one.previous_camera = before[e];
    EXPECT_EQ(part_of(both.linear, static_cast<int>(e), 2).pixels, render(one).linear.pixels);
  }
}

TEST(SideBySide, PartsComeBack) {
  Image a(3, 2, {"Z", "u"}), b(3, 2, {"Z", "u"});
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    a.pixels[i] = static_cast<float>(i), b.pixels[i] = 100 + static_cast<float>(i);
  const Image both = side_by_side({a, b});
  EXPECT_EQ(both.width, 6);
  EXPECT_EQ(both.at(3, 1)[1], b.at(0, 1)[1]);
  EXPECT_EQ(part_of(both, 0, 2).pixels, a.pixels);
  EXPECT_EQ(part_of(both, 1, 2).pixels, b.pixels);
  EXPECT_EQ(part_of(both, 1, 2).channels, b.channels);
}

}  // namespace
}  // namespace pelage
