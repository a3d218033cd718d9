// Rays and what they meet on meshes.
#pragma once

#include <pelage/vec.h>

#include <cstdint>

namespace pelage {

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< need not be unit length; distances are in its units
  float near = 0;  ///< hits nearer than this are ignored
  float far = INFINITY;
};

struct RayHit {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  float distance = INFINITY;
  std::uint32_t mesh = kNone;  ///< index into Scene::meshes
  std::uint32_t triangle = 0;
  float u = 0, v = 0;  ///< barycentric weights of the triangle's second and third corner
};

}  // namespace pelage
