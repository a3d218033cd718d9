// A small hair mesh for tests: a block of quads that bends over, with every operator within reach.
#pragma once

#include <pelage/hair_mesh.h>

#include <cmath>
#include <vector>

namespace pelage::testing {

/// side × side bundles, side by side over 0.1 m, of `layers` layers that lean over as they rise to 0.2 m; `strands` in each.
inline HairMesh small_hair_mesh(std::vector<StyleOperator> style, std::uint32_t side = 2, std::uint32_t layers = 5,
                                std::uint32_t strands = 40) {
  HairMesh mesh;
  mesh.styles = {std::move(style)};
  mesh.column_offsets = {0};
  const auto corner = [&](std::uint32_t i) { return static_cast<float>(i) / static_cast<float>(side); };
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x) {
      for (std::uint32_t k = 0; k < layers; ++k) {
        const float w = static_cast<float>(k) / static_cast<float>(layers - 1), spread = 1 + 0.5f * w;
        mesh.positions.push_back({0.1f * spread * (corner(x) - 0.5f) + 0.08f * w * w, 0.2f * std::sin(1.3f * w),
                                  0.1f * spread * (corner(y) - 0.5f) + 0.02f * w * corner(x)});
        mesh.uvw.push_back({corner(x), corner(y), w});
        mesh.occlusion.push_back(0.2f + 0.7f * w * (1 - 0.3f * corner(x)));
      }
      mesh.column_offsets.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    }
  const std::uint32_t row = side + 1;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      mesh.bundles.push_back(
          {{y * row + x, y * row + x + 1, (y + 1) * row + x + 1, (y + 1) * row + x}, strands, 0, 7 + y * side + x});
  return mesh;
}

/// One of each kind, mild.
inline std::vector<StyleOperator> every_operator() {
  using Kind = StyleOperator::Kind;
  return {{Kind::kLength, 1.1f, 0, 0, 0.4f},       {Kind::kClump, 0.6f, 3, 0.1f, 0.5f},  {Kind::kBraid, 0.3f, 2.5f, 0.4f, 0.2f},
          {Kind::kWave, 0.004f, 3, 0.1f, 0.3f},    {Kind::kCurl, 0.006f, 5, 0.2f, 0.3f}, {Kind::kNoise, 0.003f, 4, 0, 0.3f},
          {Kind::kFrizz, 0.002f, 20, 0.05f, 0.7f}, {Kind::kTaper, 0.3f, 0, 0.2f, 0.5f}};
}

}  // namespace pelage::testing
