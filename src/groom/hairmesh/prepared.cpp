#include "groom/hairmesh/prepared.h"

#include <utility>

#include "core/rng.h"

namespace pelage {

PreparedHairMesh::PreparedHairMesh(std::shared_ptr<const HairMesh> hair_mesh) : mesh(std::move(hair_mesh)) {
  constexpr std::uint64_t kStagger = 0x6c6f64;
  for (const HairMesh::Bundle& bundle : mesh->bundles) {
    cages.emplace_back(*mesh, bundle);
    boxes.push_back(bounds(*mesh, bundle));
    stagger.push_back(Rng(kStagger, bundle.seed).uniform());
  }
}

}  // namespace pelage
