// What a scene looks like when nobody said: the box of it, a camera that frames it, lights that flatter it.
#include <pelage/scene.h>

#include <algorithm>
#include <cmath>

#include "core/bounds.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float radians(float degrees) { return degrees * kPi / 180; }

Bounds transformed(const Bounds& box, const Affine& transform) {
  Bounds result;
  if (box.empty()) return result;
  for (const Vec3 corner : corners(box)) result.extend(transform_point(transform, corner));
  return result;
}

/// The strands of a groom; of a hair mesh some of them, whether or not all have been made. Null for neither.
std::shared_ptr<const StrandSet> some_strands(const GroomInstance& groom) {
  if (!groom.hair_mesh) return groom.strands;
  constexpr float kStrands = 2000;
  const float share = std::min(1.f, kStrands / static_cast<float>(strand_count(*groom.hair_mesh)));
  return std::make_shared<const StrandSet>(expand(*groom.hair_mesh, {.points = 17, .share = share}));
}

Bounds groom_bounds(const Scene& scene) {
  Bounds box;
  for (const GroomInstance& groom : scene.grooms)
    if (const auto strands = some_strands(groom)) box.extend(transformed(bounds(*strands), groom.transform));
  return box;
}

Bounds mesh_bounds(const Scene& scene) {
  Bounds box;
  for (const MeshInstance& mesh : scene.meshes)
    if (mesh.mesh) box.extend(transformed(bounds(*mesh.mesh), mesh.transform));
  return box;
}

float largest_side(const Bounds& box) {
  const Vec3 e = box.extent();
  return std::max({e.x, e.y, e.z});
}

/// At most about `limit` of the points, evenly strided, in world space, appended to `out`.
void append_points(const std::vector<Vec3>& points, const Affine& transform, std::size_t limit, std::vector<Vec3>& out) {
  const std::size_t stride = points.size() / limit + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) out.push_back(transform_point(transform, points[i]));
}

// The hair, and as much of the meshes as stands close to it: a whole body would leave no pixels for the head.
std::vector<Vec3> subject_points(const Scene& scene) {
  constexpr std::size_t kLimit = 20000;
  constexpr float kSurroundings = 0.1f;  // of the groom's largest side
  std::vector<Vec3> points, mesh_points;
  for (const GroomInstance& groom : scene.grooms)
    if (const auto strands = some_strands(groom)) append_points(strands->points, groom.transform, kLimit, points);
  for (const MeshInstance& mesh : scene.meshes)
    if (mesh.mesh) append_points(mesh.mesh->positions, mesh.transform, kLimit, mesh_points);
  if (points.empty()) return mesh_points;
  Bounds near;
  for (const Vec3 p : points) near.extend(p);
  const float margin = kSurroundings * largest_side(near);
  near.lower -= Vec3(margin, margin, margin);
  near.upper += Vec3(margin, margin, margin);
  for (const Vec3 p : mesh_points)
    if (max(near.lower, p) == p && min(near.upper, p) == p) points.push_back(p);
  return points;
}

struct Basis {
  Vec3 right, up, back;  // back points from the target to the eye
};

Basis basis_looking_from(Vec3 direction) {
  const Vec3 right = normalize(cross({0, 1, 0}, direction));
  return {right, cross(direction, right), direction};
}

}  // namespace

EnvironmentLighting environment_lighting(const RenderSettings& settings) {
  return settings.environment_lighting.value_or(EnvironmentLighting::kPieces);
}

Bounds bounds(const Scene& scene) {
  Bounds box = groom_bounds(scene);
  box.extend(mesh_bounds(scene));
  return box;
}

void add_default_camera(Scene& scene) {
  const float azimuth = radians(-28), elevation = radians(6), margin = 1.06f;
  Camera camera;
  camera.fov_y = radians(26);  // about a portrait lens
  const Basis b = basis_looking_from(
      {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)});
  std::vector<Vec3> points = subject_points(scene);
  if (points.empty()) points = {{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}};
  Bounds box;
  for (const Vec3 p : points) box.extend(p);
  camera.target = box.center();

  // A point at (x, y, z) of the camera's basis, z toward the eye, is inside at distance d where |y| ≤ (d − z)·tan_y and
  // |x| ≤ (d − z)·tan_x. The four frustum planes through their extreme points fix d and the middle: per axis,
  // max(x + z·t) and max(−x + z·t) are the planes' offsets; their mean is the distance, half their difference the middle.
  const float tan_y = std::tan(camera.fov_y / 2) / margin;
  const float tan_x = tan_y * static_cast<float>(scene.settings.width) / static_cast<float>(scene.settings.height);
  float plus_x = -INFINITY, minus_x = -INFINITY, plus_y = -INFINITY, minus_y = -INFINITY, front = -INFINITY;
  for (const Vec3 p : points) {
    const Vec3 q = p - camera.target;
    const float x = dot(q, b.right), y = dot(q, b.up), z = dot(q, b.back);
    plus_x = std::max(plus_x, x + z * tan_x), minus_x = std::max(minus_x, z * tan_x - x);
    plus_y = std::max(plus_y, y + z * tan_y), minus_y = std::max(minus_y, z * tan_y - y);
    front = std::max(front, z);
  }
  const float least = 1e-4f + 1e-3f * largest_side(box);  // keeps a flat or single-point subject in front of the eye
  const float distance = std::max({(plus_x + minus_x) / (2 * tan_x), (plus_y + minus_y) / (2 * tan_y), front + least});
  camera.target += b.right * ((plus_x - minus_x) / 2) + b.up * ((plus_y - minus_y) / 2);
  camera.eye = camera.target + b.back * distance;
  camera.near_plane = std::max(1e-5f, 0.01f * distance);
  camera.height = 2 * distance * tan_y * margin;
  scene.camera = camera;
}

void add_default_lights(Scene& scene) {
  const Vec3 to_eye = normalize(scene.camera.eye - scene.camera.target);
  const bool steep = std::fabs(to_eye.y) > 0.95f;
  const Vec3 flat = steep ? Vec3(0, 0, 1) : normalize(Vec3(to_eye.x, 0, to_eye.z));
  const Basis b = basis_looking_from(flat);
  // Where each light stands, seen from the camera: right, up, toward the camera.
  const auto add = [&](const char* name, Vec3 from, Vec3 irradiance) {
    Light light;
    light.type = Light::Type::kDirectional;
    light.name = name;
    light.direction = -normalize(b.right * from.x + b.up * from.y + b.back * from.z);
    light.intensity = irradiance;
    scene.lights.push_back(light);
  };
  // The default camera stands in the subject's front left: the key lights the side that it sees, the rim the far edge.
  add("key", {-0.75f, 0.75f, 0.9f}, {5.4f, 5.1f, 4.75f});
  add("fill", {1.0f, 0.25f, 0.8f}, {1.3f, 1.4f, 1.55f});
  add("rim", {0.6f, 0.75f, -1.0f}, {3.2f, 3.3f, 3.5f});
  scene.environment.radiance = {0.42f, 0.45f, 0.5f};
}

}  // namespace pelage
