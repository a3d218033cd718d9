// A place where light scatters on its way to the eye.
#pragma once

#include <pelage/vec.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "core/ray.h"
#include "reference/fiber_bsdf.h"
#include "reference/ray_scene.h"
#include "reference/surface_bsdf.h"

namespace pelage {

using Bsdf = std::variant<FiberBsdf, SurfaceBsdf>;

inline Vec3 evaluate(const Bsdf& bsdf, Vec3 to_light) {
  return std::visit([&](const auto& b) { return b.evaluate(to_light); }, bsdf);
}
inline Vec3 evaluate_lobe(const Bsdf& bsdf, Vec3 to_light, int lobe) {
  return std::visit([&](const auto& b) { return b.evaluate_lobe(to_light, lobe); }, bsdf);
}
inline float pdf(const Bsdf& bsdf, Vec3 to_light) {
  return std::visit([&](const auto& b) { return b.pdf(to_light); }, bsdf);
}
inline FiberSample sample(const Bsdf& bsdf, std::array<float, 4> u) {
  return std::visit([&](const auto& b) { return b.sample(u); }, bsdf);
}
inline ScatteredDirection scatter(const Bsdf& bsdf, std::array<float, 4> u) {
  if (const auto* fiber = std::get_if<FiberBsdf>(&bsdf)) return fiber->scatter(u);
  const FiberSample s = std::get<SurfaceBsdf>(bsdf).sample(u);
  return {s.direction, s.pdf > 0 ? s.value / s.pdf : Vec3()};
}
inline Vec3 albedo(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return b.albedo(); }, bsdf);
}

/// Rays from here neither meet the strand nor the surface that they leave.
///
/// A fiber scatters as a whole (its models know no place on its circumference), so light leaves from its axis. The ray begins
/// where it comes out of the straight tube around the tangent, radius / cos θ away: what it would meet before that is the
/// fiber itself. Rays along the fiber begin at the latest kLongestWay radii away.
///
/// A thick hair scatters where the ray met one of its fibers. Rays begin there; RayScene::passage_from() lets them out of the hair.
struct Vertex {
  static constexpr float kBeyond = 1.05f;         ///< times the way out of the tube: strands bend
  static constexpr float kLongestWay = 20;        ///< radii
  static constexpr float kSurfaceOffset = 2e-5f;  ///< share of the scale of the coordinates and the ray

  Vec3 position;          ///< on the strand's axis, in the thick hair, or where rays leave the mesh (Surface::lifted); metres
  Vec3 tangent;           ///< of the strand
  Vec3 geometric_normal;  ///< of the mesh, on the side that light is scattered on
  float radius = 0;       ///< of the strand, metres, 0 of a thick hair; or how far from the mesh rays begin
  Bsdf bsdf;
  SceneHit met;  ///< what stands here: rays pass what is left of a thick hair

  bool hair() const { return std::holds_alternative<FiberBsdf>(bsdf); }

  Ray ray(Vec3 direction, float distance = INFINITY) const {
    if (hair()) {
      const float along = dot(direction, tangent), across = std::sqrt(std::max(1 - along * along, 0.f));
      return {position, direction, radius * std::min(kBeyond / std::max(across, 1e-6f), kLongestWay), distance};
    }
    return {position + geometric_normal * radius, direction, 0, distance};
  }
};

}  // namespace pelage
