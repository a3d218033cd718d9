// Small grooms and cameras for the tests of assemble and raster.
#pragma once

#include <pelage/scene.h>

#include <cmath>
#include <memory>

#include "core/rng.h"

namespace pelage::test {

/// `strands` helices of `points` points that hang from a ball of hair about the origin, 0.2 m tall.
inline StrandSet helices(int strands, int points, float curl_radius = 0.004f, float width = 1e-4f) {
  StrandSet set;
  set.offsets.push_back(0);
  set.widths = {width};
  for (int s = 0; s < strands; ++s) {
    Rng rng(7, static_cast<std::uint32_t>(s));
    const float longitude = 6.2832f * rng.uniform(), latitude = 1.5f * rng.uniform(), phase = 6.2832f * rng.uniform();
    const Vec3 out(std::cos(longitude) * std::sin(latitude), std::cos(latitude), std::sin(longitude) * std::sin(latitude));
    for (int i = 0; i < points; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(points - 1), turn = phase + 25 * t;
      const Vec3 drop = out * (0.05f + 0.08f * t) + Vec3(0, -0.15f * t * t, 0);
      set.points.push_back(drop + Vec3(std::cos(turn), 0, std::sin(turn)) * (curl_radius * std::fmin(1.f, 4 * t)));
    }
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

/// A strand through these points.
inline StrandSet strand(std::initializer_list<Vec3> points, float width, CurveBasis basis = CurveBasis::kLinear) {
  StrandSet set;
  set.points = points;
  set.offsets = {0, static_cast<std::uint32_t>(points.size())};
  set.widths = {width};
  set.basis = basis;
  return set;
}

inline GroomInstance instance(StrandSet set) {
  GroomInstance groom;
  groom.strands = std::make_shared<const StrandSet>(std::move(set));
  return groom;
}

/// `set` before a camera at 0.6 m; one segment per span.
inline Scene scene_of(StrandSet set) {
  Scene scene;
  scene.camera.eye = {0.1f, 0.05f, 0.6f};
  scene.grooms.push_back(instance(std::move(set)));
  scene.settings.subdivisions = 1;
  return scene;
}

/// Orthographic camera on which 1 m is 1 pixel, x to the right, y up, the image's center at the origin.
inline Camera pixel_camera(int height) {
  Camera camera;
  camera.projection = Camera::Projection::kOrthographic;
  camera.eye = {0, 0, 10};
  camera.height = static_cast<float>(height);
  return camera;
}

/// 300 curls in the default camera and light.
inline Scene hairy_scene(int width = 96, int height = 64) {
  Scene scene;
  scene.settings.width = width;
  scene.settings.height = height;
  scene.settings.opacity_map_size = 128;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(helices(300, 16));
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

/// A tile of 4 cm behind the middle of the hair.
inline void add_tile(Scene& scene) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = {{-0.04f, -0.04f, 0}, {0.04f, -0.04f, 0}, {0.04f, 0.04f, 0}, {-0.04f, 0.04f, 0}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.emplace_back().mesh = mesh;
}

}  // namespace pelage::test
