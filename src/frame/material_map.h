// Color of hair by its place in the groom.
#pragma once

#include <pelage/scene.h>

#include <algorithm>
#include <cmath>

namespace pelage {

inline bool has_color_maps(const GroomInstance& groom) { return groom.color_map || groom.color_along; }

/// Texel of an RGB image at (x, y) ∈ [0, 1]², row 0 first; the nearest one.
inline Vec3 map_texel(const Image& map, float x, float y) {
  const auto place = [](float t, int size) { return std::clamp(static_cast<int>(t * static_cast<float>(size)), 0, size - 1); };
  const float* p = map.at(place(x, map.width), place(y, map.height));
  return {p[0], p[1], p[2]};
}

/// Linear reflectance of a dense tuft, 0…1, of hair at (u, v) of the groom and w along the strand; only for grooms with maps.
inline Vec3 mapped_color(const GroomInstance& groom, float u, float v, float w) {
  Vec3 color(1, 1, 1);
  if (groom.color_map) color = color * map_texel(*groom.color_map, u, v);
  if (groom.color_along) color = color * map_texel(*groom.color_along, w, 0);
  return {std::clamp(color.x, 0.f, 1.f), std::clamp(color.y, 0.f, 1.f), std::clamp(color.z, 0.f, 1.f)};
}

}  // namespace pelage
