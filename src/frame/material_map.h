// Color, roughness and tilt of hair by its place in the groom.
#pragma once

#include <pelage/scene.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pelage {

/// A place in a groom: (u, v) of the strand and w along it, 0…1 each.
struct GroomPlace {
  float u = 0, v = 0, w = 0;
};

inline bool has_color_maps(const GroomInstance& groom) { return groom.color_map || groom.color_along; }

/// Texel of an image at (x, y) ∈ [0, 1]², row 0 first; the nearest one.
inline const float* map_texel(const Image& map, float x, float y) {
  const auto place = [](float t, int size) { return std::clamp(static_cast<int>(t * static_cast<float>(size)), 0, size - 1); };
  return map.at(place(x, map.width), place(y, map.height));
}

/// Linear reflectance of a dense tuft, 0…1, of hair there; only for grooms with maps of color.
inline Vec3 mapped_color(const GroomInstance& groom, GroomPlace at) {
  Vec3 color(1, 1, 1);
  const auto multiply = [&](const float* p) { color = color * Vec3(p[0], p[1], p[2]); };
  if (groom.color_map) multiply(map_texel(*groom.color_map, at.u, at.v));
  if (groom.color_along) multiply(map_texel(*groom.color_along, at.w, 0));
  return {std::clamp(color.x, 0.f, 1.f), std::clamp(color.y, 0.f, 1.f), std::clamp(color.z, 0.f, 1.f)};
}

/// What multiplies a material's roughness and its tilt.
struct Finish {
  float roughness = 1, tilt = 1;
};
inline constexpr float kMostFinish = 16;  ///< of a texel

/// Whether roughness or tilt differ within the groom: those of hair meshes may.
inline bool has_finish_maps(const GroomInstance& groom) {
  return groom.hair_mesh && (groom.roughness_map || groom.roughness_along || groom.tilt_map || groom.tilt_along);
}

/// Of hair there. What is no number counts as 0.
Finish mapped_finish(const GroomInstance& groom, GroomPlace at);

/// `material` with that finish; it ends where the ranges of scene files end: 0.5° and 60° along the strand, 0.5° and 90° around
/// it, a tilt of 15°. A finish of (1, 1) leaves a material within them as it is, to the bit.
HairMaterial finished(HairMaterial material, Finish finish);

/// The roughnesses that tables of a groom are made for: each that its maps hold where they are few, so that those have tables of
/// their own; else kMost of them, evenly apart.
class RoughnessLevels {
 public:
  static constexpr std::size_t kMost = 8;

  RoughnessLevels() = default;  ///< one: 1
  explicit RoughnessLevels(const GroomInstance& groom);

  const std::vector<float>& values() const { return values_; }  ///< increasing
  std::size_t nearest(float roughness) const;                   ///< its number

 private:
  std::vector<float> values_{1};
};

}  // namespace pelage
