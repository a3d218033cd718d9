// Small hair meshes for tests.
#pragma once

#include <pelage/hair_mesh.h>

#include <cstdint>

namespace pelage::kit {

/// Two bundles side by side that share two columns of `layers` vertices, 0.2 m long and slightly bent; every array present,
/// every value different, all eight operators in use.
inline HairMesh two_bundles(std::uint32_t layers = 4) {
  HairMesh mesh;
  mesh.column_offsets = {0};
  for (std::uint32_t c = 0; c < 6; ++c) {
    const float x = 0.01f * static_cast<float>(c % 3), z = 0.012f * static_cast<float>(c / 3);
    for (std::uint32_t k = 0; k < layers; ++k) {
      const float w = static_cast<float>(k) / static_cast<float>(layers - 1);
      mesh.positions.emplace_back(x + 0.02f * w * w, -0.2f * w, z + 0.003f * w * static_cast<float>(c));
      mesh.tangents.emplace_back(0.04f * w, -0.2f / static_cast<float>(layers - 1), 0.001f * static_cast<float>(c));
      mesh.uvw.emplace_back(0.4f + 0.1f * static_cast<float>(c % 3), 0.5f + 0.1f * static_cast<float>(c / 3), w);
      mesh.occlusion.push_back(0.3f + 0.5f * w + 0.02f * static_cast<float>(c));
    }
    mesh.column_offsets.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
  }
  mesh.bundles = {{{0, 1, 4, 3}, 40, 0, 7}, {{1, 2, 5, 4}, 60, 1, 4294967295u}};
  using Kind = StyleOperator::Kind;
  mesh.styles = {
      {{Kind::kLength, 1.1f, 0, 0, 0.2f},
       {Kind::kClump, 0.6f, 3, 0.25f, 0.5f},
       {Kind::kWave, 0.004f, 3.5f, 0.1f, 0.3f},
       {Kind::kNoise, 0.002f, 9, 0, 0.1f},
       {Kind::kTaper, 0.3f, 0, 0.5f, 0.4f}},
      {{Kind::kBraid, 0.5f, 4, 0.3f, 0.1f}, {Kind::kCurl, 0.005f, 6, 0.2f, 0.7f}, {Kind::kFrizz, 0.001f, 20, 0, 0.9f}}};
  mesh.width = 7e-5f;
  mesh.comment = "two bundles, \"quoted\" – é";
  return mesh;
}

}  // namespace pelage::kit
