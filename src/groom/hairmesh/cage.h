// A bundle of a hair mesh made ready for its strands: cubic polynomials along, corners across.
#pragma once

#include <pelage/hair_mesh.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pelage {

/// The base spline of every strand of a bundle. Coefficients are linear in the vertices, so those of a strand are the bilinear
/// mean of its columns'.
struct BundleCage {
  static constexpr std::size_t kCoefficients = 12;         ///< x, y, z of c0 … c3 (kernel/curve/cubic.h)
  static constexpr std::size_t kSpan = 4 * kCoefficients;  ///< floats a span: column by column
  const HairMesh* mesh = nullptr;
  const HairMesh::Bundle* bundle = nullptr;
  const std::vector<StyleOperator>* style = nullptr;
  std::uint32_t spans = 0;          ///< layers − 1
  std::vector<float> coefficients;  ///< [spans][column][c0.xyz c1.xyz c2.xyz c3.xyz]
  std::vector<float> occlusion;     ///< [layers][column]
  std::vector<float> normals;       ///< [layers][xyz] mean direction from v-side u = 0 to u = 1, unit
  std::array<Vec2, 4> root_uv;      ///< of the groom, per column

  /// O(layers). `mesh` must be valid, and outlive the cage.
  BundleCage(const HairMesh& mesh, const HairMesh::Bundle& bundle);

  /// The style's operator of a kind; null where it has none.
  const StyleOperator* find(StyleOperator::Kind kind) const;
};

/// Place in the groom, 0…1, of strand number `strand` of the bundle.
Vec2 groom_place(const BundleCage& cage, std::uint32_t strand);

/// Derivative of the positions by layer at vertex `i` of column `c`: as stored, or central differences.
Vec3 layer_tangent(const HairMesh& mesh, std::uint32_t column, std::uint32_t layer);

}  // namespace pelage
