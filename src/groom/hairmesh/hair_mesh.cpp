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
  return metres;
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

/// A loose braid leaves its bundle by as much as a third of it.
void grow(Bounds& box, float metres, bool braided) {
  if (braided) metres += length(box.extent()) / 3;
  const Vec3 by(metres, metres, metres);
  box.lower = box.lower - by, box.upper = box.upper + by;
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
  grow(box, reach(cage) + 0.5f * mesh.width, cage.find(StyleOperator::Kind::kBraid) != nullptr);
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
