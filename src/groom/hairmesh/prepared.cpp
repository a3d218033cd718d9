#include "groom/hairmesh/prepared.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rng.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

/// Of the quads of all layers: the side of a square of their area; of a braid, of one of its locks.
float width_across(const HairMesh& mesh, const HairMesh::Bundle& bundle, const StyleOperator* braid) {
  const std::uint32_t layers = mesh.layers(bundle);
  float sum = 0;
  for (std::uint32_t i = 0; i < layers; ++i) {
    const auto corner = [&](std::size_t c) { return mesh.positions[mesh.column_offsets[bundle.columns[c]] + i]; };
    sum += std::sqrt(0.5f * length(cross(corner(2) - corner(0), corner(3) - corner(1))));
  }
  return sum / static_cast<float>(layers) * (braid ? braid->amount : 1.f);
}

/// Waves that a turn of an operator's frequency is made of, along the strand; 0 where it makes none.
float waves_of(StyleOperator::Kind kind) {
  switch (kind) {
    case StyleOperator::Kind::kWave:
    case StyleOperator::Kind::kCurl:
    case StyleOperator::Kind::kFrizz: return 1;
    case StyleOperator::Kind::kNoise: return kernel::kStyleNoiseTurns;
    case StyleOperator::Kind::kBraid: return 2;  // a figure of eight
    default: return 0;
  }
}

float fastest_turns(const std::vector<StyleOperator>& style) {
  float turns = 0;
  for (const StyleOperator& o : style)
    if (o.amount > 0) turns = std::max(turns, o.frequency * waves_of(o.kind));
  return turns;
}

}  // namespace

PreparedHairMesh::PreparedHairMesh(std::shared_ptr<const HairMesh> hair_mesh) : mesh(std::move(hair_mesh)) {
  constexpr std::uint64_t kStagger = 0x6c6f64;
  for (const HairMesh::Bundle& bundle : mesh->bundles) {
    cages.emplace_back(*mesh, bundle);
    boxes.push_back(bounds(*mesh, bundle));
    stagger.push_back(Rng(kStagger, bundle.seed).uniform());
    across.push_back(width_across(*mesh, bundle, cages.back().find(StyleOperator::Kind::kBraid)));
    turns.push_back(fastest_turns(mesh->styles[bundle.style]));
  }
}

}  // namespace pelage
