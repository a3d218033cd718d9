// The default camera frames what stands in the scene: everything inside the picture, and touching its margin.
#include <gtest/gtest.h>
#include <pelage/scene.h>

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

Scene scene_of(std::vector<Vec3> points, int width, int height) {
  auto strands = std::make_shared<StrandSet>();
  strands->offsets = {0, static_cast<std::uint32_t>(points.size())};
  strands->points = std::move(points);
  strands->widths = {1e-4f};
  Scene scene;
  scene.settings.width = width;
  scene.settings.height = height;
  scene.grooms.emplace_back().strands = strands;
  return scene;
}

// Half-picture coordinates, −1…1 inside.
Vec2 project(const Camera& camera, float aspect, Vec3 p) {
  const Vec3 forward = normalize(camera.target - camera.eye);
  const Vec3 right = normalize(cross(forward, camera.up)), up = cross(right, forward);
  const Vec3 q = p - camera.eye;
  const float t = std::tan(camera.fov_y / 2) * dot(q, forward);
  return {dot(q, right) / (t * aspect), dot(q, up) / t};
}

class Framing : public testing::TestWithParam<std::tuple<Vec2, float, Vec3>> {};

TEST_P(Framing, FillsThePicture) {
  const auto [size, scale, offset] = GetParam();
  const std::vector<Vec3> shape{{-1, 0, 0}, {0.5f, 2, 0.3f}, {0.2f, -1, -0.6f}, {0.9f, 0.1f, 0.9f}};
  std::vector<Vec3> points;
  for (const Vec3 p : shape) points.push_back(p * scale + offset);
  Scene scene = scene_of(points, static_cast<int>(size.x), static_cast<int>(size.y));
  add_default_camera(scene);
  float most = 0, left = 1, right = -1, low = 1, high = -1;
  for (const Vec3 p : points) {
    const Vec2 s = project(scene.camera, size.x / size.y, p);
    most = std::max({most, std::fabs(s.x), std::fabs(s.y)});
    left = std::min(left, s.x), right = std::max(right, s.x), low = std::min(low, s.y), high = std::max(high, s.y);
    EXPECT_GT(dot(p - scene.camera.eye, normalize(scene.camera.target - scene.camera.eye)), scene.camera.near_plane);
  }
  EXPECT_LE(most, 0.96f);
  EXPECT_GE(most, 0.85f);
  EXPECT_NEAR(left + right, 0, 0.15f) << "in the middle";
  EXPECT_NEAR(low + high, 0, 0.15f);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Framing,
                         testing::Combine(testing::Values(Vec2(100, 100), Vec2(1920, 1080), Vec2(300, 900)),
                                          testing::Values(0.01f, 1.f, 500.f), testing::Values(Vec3(0, 0, 0), Vec3(3, -2, 1))));

TEST(DefaultView, BoundsAreInWorldSpace) {
  Scene scene = scene_of({{0, 0, 0}, {1, 2, 3}}, 64, 64);
  scene.grooms[0].transform.m[0][3] = 10;
  const Bounds box = bounds(scene);
  EXPECT_EQ(box.lower, Vec3(10, 0, 0));
  EXPECT_EQ(box.upper, Vec3(11, 2, 3));
  EXPECT_TRUE(bounds(Scene{}).empty());
}

TEST(DefaultView, EmptyAndDegenerateScenesGiveFiniteCameras) {
  for (const auto& points : {std::vector<Vec3>{}, std::vector<Vec3>{{1, 1, 1}, {1, 1, 1}}}) {
    Scene scene = points.empty() ? Scene{} : scene_of(points, 64, 64);
    add_default_camera(scene);
    add_default_lights(scene);
    EXPECT_TRUE(is_finite(scene.camera.eye));
    EXPECT_GT(length(scene.camera.eye - scene.camera.target), 0);
    ASSERT_EQ(scene.lights.size(), 3u);
    for (const Light& light : scene.lights) EXPECT_NEAR(length(light.direction), 1, 1e-5f);
  }
}

TEST(DefaultView, AWholeBodyDoesNotShrinkTheHead) {
  Scene head = scene_of({{-0.1f, 0, -0.1f}, {0.1f, 0.2f, 0.1f}}, 64, 64);
  Scene body = head;
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = {{-0.5f, -1.7f, 0}, {0.5f, -1.7f, 0}, {0, 0.1f, 0}};
  mesh->triangles = {{0, 1, 2}};
  body.meshes.emplace_back().mesh = mesh;
  add_default_camera(head);
  add_default_camera(body);
  EXPECT_LT(length(body.camera.eye - body.camera.target), 1.2f * length(head.camera.eye - head.camera.target));
}

}  // namespace
}  // namespace pelage
