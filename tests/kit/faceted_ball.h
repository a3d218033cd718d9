// A ball that is smooth by its normals and coarse by its triangles: what shadows at grazing light are tried on.
#pragma once

#include <pelage/scene.h>

#include <cmath>
#include <cstdint>
#include <memory>

namespace pelage::kit {

/// Of radius 1 about the origin, 12 facets around and 6 from pole to pole.
inline MeshInstance faceted_ball() {
  constexpr std::uint32_t kAround = 12, kDown = 6;
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t j = 0; j <= kDown; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const float polar = static_cast<float>(j) / kDown * 3.14159265f, around = static_cast<float>(i) / kAround * 6.28318531f;
      const Vec3 p(std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around));
      mesh->positions.push_back(p), mesh->normals.push_back(normalize(p));
    }
  for (std::uint32_t j = 0; j < kDown; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      if (j > 0) mesh->triangles.push_back({a, b, a + kAround});
      if (j + 1 < kDown) mesh->triangles.push_back({b, b + kAround, a + kAround});
    }
  MeshInstance instance;
  instance.mesh = mesh;
  return instance;
}

/// Sees all of it.
inline Camera camera_before_ball() {
  Camera camera;
  camera.projection = Camera::Projection::kOrthographic;
  camera.height = 2.2f, camera.eye = {0, 0, 3};
  return camera;
}

}  // namespace pelage::kit
