#include "groom/hairmesh/cage.h"

#include <algorithm>

#include "kernel/scalar.h"

namespace pelage {
namespace {

void put(Vec3 v, float* to) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

Vec3 each(float (*f)(float, float, float, float), Vec3 p0, Vec3 m0, Vec3 p1, Vec3 m1) {
  return {f(p0.x, m0.x, p1.x, m1.x), f(p0.y, m0.y, p1.y, m1.y), f(p0.z, m0.z, p1.z, m1.z)};
}

}  // namespace

Vec3 layer_tangent(const HairMesh& mesh, std::uint32_t column, std::uint32_t layer) {
  const std::uint32_t first = mesh.column_offsets[column], last = mesh.column_offsets[column + 1] - 1, i = first + layer;
  if (!mesh.tangents.empty()) return mesh.tangents[i];
  if (i == first) return mesh.positions[i + 1] - mesh.positions[i];
  if (i == last) return mesh.positions[i] - mesh.positions[i - 1];
  return (mesh.positions[i + 1] - mesh.positions[i - 1]) * 0.5f;
}

BundleCage::BundleCage(const HairMesh& m, const HairMesh::Bundle& b)
    : mesh(&m), bundle(&b), style(&m.styles[b.style]), spans(m.layers(b) - 1) {
  coefficients.resize(spans * kSpan), occlusion.resize((spans + 1) * 4), normals.resize((spans + 1) * 3);
  const auto position = [&](std::size_t column, std::uint32_t layer) {
    return m.positions[m.column_offsets[b.columns[column]] + layer];
  };
  for (std::size_t c = 0; c < 4; ++c) {
    const std::uint32_t first = m.column_offsets[b.columns[c]];
    root_uv[c] = {m.uvw[first].x, m.uvw[first].y};
    for (std::uint32_t k = 0; k <= spans; ++k) occlusion[k * 4 + c] = m.occlusion.empty() ? 1.f : m.occlusion[first + k];
    for (std::uint32_t k = 0; k < spans; ++k) {
      const Vec3 p0 = position(c, k), p1 = position(c, k + 1);
      const Vec3 m0 = layer_tangent(m, b.columns[c], k), m1 = layer_tangent(m, b.columns[c], k + 1);
      float* to = &coefficients[k * kSpan + c * kCoefficients];
      put(p0, to), put(m0, to + 3);
      put(each(kernel::curve_hermite_c2, p0, m0, p1, m1), to + 6), put(each(kernel::curve_hermite_c3, p0, m0, p1, m1), to + 9);
    }
  }
  for (std::uint32_t k = 0; k <= spans; ++k)
    put(normalize((position(1, k) - position(0, k)) + (position(2, k) - position(3, k))), &normals[k * 3]);
}

const StyleOperator* BundleCage::find(StyleOperator::Kind kind) const {
  const auto found = std::find_if(style->begin(), style->end(), [&](const StyleOperator& o) { return o.kind == kind; });
  return found == style->end() ? nullptr : &*found;
}

}  // namespace pelage
