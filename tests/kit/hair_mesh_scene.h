// A scene of a small hair mesh, ready for the stages of method swr.
#pragma once

#include <pelage/scene.h>

#include <memory>
#include <vector>

#include "frame/deferred.h"
#include "groom/hairmesh/prepared.h"
#include "kit/test_hair_mesh.h"

namespace pelage::testing {

/// `mesh` before a camera that sees all of it, from 0.6 m.
inline Scene hair_mesh_scene(HairMesh mesh) {
  Scene scene;
  scene.camera.eye = {0.15f, 0.2f, 0.6f}, scene.camera.target = {0.03f, 0.09f, 0};
  GroomInstance groom;
  groom.name = "block";
  groom.hair_mesh = std::make_shared<const HairMesh>(std::move(mesh));
  scene.grooms.push_back(std::move(groom));
  scene.settings.method = Method::kSwr;
  scene.settings.samples = 1;
  return scene;
}

inline std::vector<DeferredGroom> deferred_grooms(const Scene& scene) {
  std::vector<DeferredGroom> grooms;
  for (std::uint32_t g = 0; g < scene.grooms.size(); ++g)
    grooms.push_back({g, std::make_shared<const PreparedHairMesh>(scene.grooms[g].hair_mesh)});
  return grooms;
}

}  // namespace pelage::testing
