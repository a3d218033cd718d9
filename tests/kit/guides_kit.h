// Guides made by hand, for tests of what moves them.
#pragma once

#include <pelage/lod.h>

#include <cmath>
#include <vector>

namespace pelage::kit {

/// Control points of a guide that hangs from `root`, `length` metres, winding with this radius.
inline std::vector<Vec3> guide(Vec3 root, float radius, float length) {
  std::vector<Vec3> points;
  for (std::uint32_t k = 0; k < LodHierarchy::kPoints; ++k) {
    const float t = static_cast<float>(k) / (LodHierarchy::kPoints - 1), turn = 9 * t;
    points.push_back(root + Vec3(radius * std::sin(turn), -length * t, radius * (1 - std::cos(turn))));
  }
  return points;
}

/// A chain of one thick hair that moves with these guides. Satisfies validate().
inline LodHierarchy guides_only(const std::vector<std::vector<Vec3>>& guides) {
  LodHierarchy lod;
  const auto n = static_cast<std::uint32_t>(guides.size());
  for (std::uint32_t g = 0; g < n; ++g) {
    lod.guide_strands.push_back(g), lod.order.push_back(g), lod.strand_weights.emplace_back(1.f, 0.f);
    lod.guides.insert(lod.guides.end(), guides[g].begin(), guides[g].end());
  }
  lod.prisms = {{0, n > 1 ? 1u : 0u, n > 2 ? 2u : n - 1}};
  lod.level_offsets = {0, 1};
  lod.hairs = {{0, n, LodHierarchy::kNone, LodHierarchy::kNone, 0, 0}};
  lod.weights = {{1, 0}}, lod.length_ratios = {1};
  for (std::uint32_t k = 0; k < LodHierarchy::kPoints; ++k) {
    lod.centers.push_back(guides[0][k]), lod.major.emplace_back(1e-3f, 0.f, 0.f), lod.minor.emplace_back(0.f, 0.f, 1e-3f);
    lod.major_weights.emplace_back(), lod.minor_weights.emplace_back(), lod.radii.push_back(4e-5f);
  }
  return lod;
}

}  // namespace pelage::kit
