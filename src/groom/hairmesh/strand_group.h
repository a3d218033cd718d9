// Strands of a bundle, made sixteen at a time: the assembly on the fly of Lipp 2026, §3.1.1 (references.bib:
// Lipp2026Deferred), with a strand per lane instead of a control point per thread. Each control point is computed once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/buffer.h"
#include "groom/hairmesh/cage.h"

namespace pelage {

/// Up to kLanes strands of one bundle as polylines of equally many points, which lie as near to the strand as so few points allow:
/// on both sides of its bends. Point i of strand l stands at i·kLanes + l; lanes
/// from `strands` on repeat the first one.
struct StrandGroup {
  static constexpr std::size_t kLanes = 16;
  using Lanes = std::array<float, kLanes>;
  std::size_t strands = 0, points = 0;
  Buffer<float> x, y, z;       ///< metres, in the space of the mesh
  Buffer<float> tx, ty, tz;    ///< tangent of the polyline: to the next point from the previous one; unit length, or 0
  Buffer<float> width;         ///< metres, diameter
  Buffer<float> occlusion;     ///< 0…1
  alignas(64) Lanes u{}, v{};  ///< the strand's place in the groom
};

/// Fills `group` with strands first … first + count − 1 of the bundle, 1 ≤ count ≤ kLanes, with `points` control points each
/// (2…kHairMeshPoints), uniform in w. Strands are in a fixed order of which every prefix is spread evenly over the bundle.
/// Reuse the group: it allocates once. Both give the same bits; the second is the reference of tests and benchmarks.
void make_strands(const BundleCage& cage, std::uint32_t first, std::size_t count, std::uint32_t points, StrandGroup& group);
void make_strands_scalar(const BundleCage& cage, std::uint32_t first, std::size_t count, std::uint32_t points,
                         StrandGroup& group);

}  // namespace pelage
