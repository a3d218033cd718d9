#include <pelage/hair_mesh.h>

#include <algorithm>

#include "groom/hairmesh/cage.h"

namespace pelage {
namespace {

/// Metres by which the style can shift a strand off its base: the bounds of style_wave() and its like.
float reach(const BundleCage& cage) {
  using Kind = StyleOperator::Kind;
  constexpr float kDiagonal = 1.42f;  // both components of a shift at once
  float metres = 0;
  for (const StyleOperator& o : *cage.style) {
    if (o.kind == Kind::kWave || o.kind == Kind::kCurl) metres += o.amount;
    if (o.kind == Kind::kNoise || o.kind == Kind::kFrizz) metres += kDiagonal * o.amount;
  }
  constexpr float kMostChord = 4 / 3.f;  // style_chord_point() of points that far to either side
  return metres * kMostChord;
}

Vec3 coefficient(const BundleCage& cage, std::uint32_t span, std::size_t column, std::size_t power) {
  const float* at = &cage.coefficients[span * BundleCage::kSpan + column * BundleCage::kCoefficients + 3 * power];
  return {at[0], at[1], at[2]};
}

/// Metres by which style_chord_point() can move points of the base: |p″| h² / 12, for points h ≤ a span apart along the cage, or
/// more where strands are longer than it.
float chord_reach(const BundleCage& cage) {
  float bend = 0;
  for (std::uint32_t k = 0; k < cage.spans; ++k)
    for (std::size_t c = 0; c < 4; ++c) {
      const Vec3 from = coefficient(cage, k, c, 2) * 2, to = from + coefficient(cage, k, c, 3) * 6;
      bend = std::max({bend, length(from), length(to)});
    }
  const StyleOperator* longer = cage.find(StyleOperator::Kind::kLength);
  const float h = longer ? std::max(longer->amount, 1.f) : 1.f;
  return bend * h * h / 12;
}

/// Metres by which strands that move across their bundle leave it: a loose braid's locks by a third of it, to two sides at once, and
/// points of bends by a sixth.
float across_reach(const BundleCage& cage) {
  using Kind = StyleOperator::Kind;
  const bool braided = cage.find(Kind::kBraid) != nullptr;
  if (!braided && !cage.find(Kind::kClump)) return 0;
  float diagonal = 0;
  for (std::uint32_t k = 0; k <= cage.spans; ++k) {
    const auto corner = [&](std::size_t c) {
      return cage.mesh->positions[cage.mesh->column_offsets[cage.bundle->columns[c]] + k];
    };
    diagonal = std::max({diagonal, length(corner(2) - corner(0)), length(corner(3) - corner(1))});
  }
  return diagonal * (braided ? 0.5f + 1 / 6.f : 1 / 6.f);
}

/// A cubic lies within the hull of its Bézier points.
void extend_by_column(const BundleCage& cage, std::uint32_t column, Bounds& box) {
  const HairMesh& m = *cage.mesh;
  const std::uint32_t first = m.column_offsets[column];
  for (std::uint32_t k = 0; k <= cage.spans; ++k) {
    const Vec3 p = m.positions[first + k], third = layer_tangent(m, column, k) / 3.f;
    box.extend(p);
    if (k > 0) box.extend(p - third);
    if (k < cage.spans) box.extend(p + third);
  }
  if (const StyleOperator* length = cage.find(StyleOperator::Kind::kLength); length && length->amount > 1)
    box.extend(m.positions[first + cage.spans] +
               layer_tangent(m, column, cage.spans) * ((length->amount - 1) * static_cast<float>(cage.spans)));
}

}  // namespace

std::uint64_t strand_count(const HairMesh& mesh) {
  std::uint64_t total = 0;
  for (const HairMesh::Bundle& b : mesh.bundles) total += b.strands;
  return total;
}

Bounds bounds(const HairMesh& mesh, const HairMesh::Bundle& bundle) {
  const BundleCage cage(mesh, bundle);
  Bounds box;
  for (const std::uint32_t column : bundle.columns) extend_by_column(cage, column, box);
  const float metres = reach(cage) + across_reach(cage) + chord_reach(cage) + 0.5f * mesh.width;
  box.lower = box.lower - Vec3(metres, metres, metres), box.upper = box.upper + Vec3(metres, metres, metres);
  return box;
}

Bounds bounds(const HairMesh& mesh) {
  Bounds all;
  for (const HairMesh::Bundle& b : mesh.bundles) all.extend(bounds(mesh, b));
  return all;
}

std::size_t resident_bytes(const HairMesh& mesh) {
  std::size_t total = mesh.column_offsets.capacity() * sizeof(std::uint32_t) + mesh.positions.capacity() * sizeof(Vec3) +
                      mesh.tangents.capacity() * sizeof(Vec3) + mesh.uvw.capacity() * sizeof(Vec3) +
                      mesh.occlusion.capacity() * sizeof(float) + mesh.bundles.capacity() * sizeof(HairMesh::Bundle) +
                      mesh.comment.capacity();
  for (const auto& style : mesh.styles) total += style.capacity() * sizeof(StyleOperator);
  return total;
}

}  // namespace pelage
