// Where strands stand: evenly spread places on a surface.
#pragma once

#include <pelage/progress.h>
#include <pelage/triangle_mesh.h>

#include <cstdint>
#include <functional>
#include <vector>

namespace pelage::groom {

struct Root {
  Vec3 position;  ///< metres
  Vec3 normal;    ///< unit, outward
  Vec2 uv;        ///< of the mesh; (0, 0) where it has none
};

/// Relative density at a place of the surface, 0 (bald) … 1.
using DensityField = std::function<float(Vec3 position)>;

/// `count` roots on `mesh`, by dart throwing with a shrinking radius (McCool & Fiume 1992; references.bib:
/// McCool1992Poisson): blue noise, weighted by area and `density`, and every prefix of the result is blue noise as well.
///
/// Degenerate triangles carry no roots; the mesh need not be manifold nor closed.
/// Throws Error (`where` names the mesh) on an empty mesh, indices out of range, non-finite positions, or no area at all.
/// Deterministic; sequential; about 1 µs a dart and 2–4 darts a root.
std::vector<Root> scatter_roots(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed,
                                const DensityField& density = {});

/// About the distance between neighbours among the first `count` of `roots`, for sizing a PointGrid; > 0.
float typical_spacing(const std::vector<Root>& roots, std::size_t count);

}  // namespace pelage::groom
