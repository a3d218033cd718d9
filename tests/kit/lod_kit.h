// A chain of thick hairs made by hand, for tests of what carries one.
#pragma once

#include <pelage/lod.h>

#include <algorithm>

namespace pelage::kit {

/// Two levels over the strands of `set` (two or more): all of them in one hair, then the first alone and the rest. Satisfies validate().
inline LodHierarchy small_lod(const StrandSet& set) {
  constexpr std::uint32_t kPoints = LodHierarchy::kPoints, kNone = LodHierarchy::kNone;
  const auto n = static_cast<std::uint32_t>(set.strand_count());
  LodHierarchy lod;
  lod.guide_strands = {0, 1};
  for (const std::uint32_t s : lod.guide_strands)
    for (std::uint32_t k = 0; k < kPoints; ++k)
      lod.guides.push_back(k + 1 < kPoints ? set.points[set.offsets[s]] : set.points[set.offsets[s + 1] - 1]);
  lod.prisms = {{0, 1, 1}};
  for (std::uint32_t s = 0; s < n; ++s) lod.order.push_back(n - 1 - s), lod.strand_weights.emplace_back(0.5f, 0.25f);
  lod.level_offsets = {0, 1, 3};
  lod.hairs = {{0, n, kNone, 1, 2, 0}, {0, 1, 0, kNone, 0, 0}, {1, n - 1, 0, kNone, 0, 0}};
  for (std::uint32_t h = 0; h < 3; ++h) {
    lod.weights.emplace_back(0.5f, 0.25f), lod.length_ratios.push_back(1.25f);
    lod.twists.push_back(300.f - 400.f * static_cast<float>(h));
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const auto x = static_cast<float>(h * kPoints + k);
      lod.centers.emplace_back(0.01f * x, -0.02f * x, 0.001f * x);
      lod.major.emplace_back(0.002f + 1e-5f * x, 0.f, 0.f), lod.minor.emplace_back(0.f, 0.f, 0.001f);
      lod.major_weights.emplace_back(0.1f, -0.1f), lod.minor_weights.emplace_back(1e-3f * x, 0.f);
      lod.radii.push_back(4e-5f);
    }
  }
  if (!set.colors.empty()) lod.colors.assign(3, Vec3(0.2f, 0.1f, 0.05f));
  if (!set.root_uv.empty()) lod.root_uv.assign(3, Vec2(0.25f, 0.5f));
  return lod;
}

}  // namespace pelage::kit
