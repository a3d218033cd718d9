#include "frame/light_lookup.h"

#include <algorithm>
#include <cmath>

#include "kernel/scalar.h"

namespace pelage {
namespace {

float texel_crossings(const OpacityMap& map, int x, int y, float z) {
  if (x < 0 || y < 0 || x >= map.view.width || y >= map.view.height) return 0;
  const std::size_t block = static_cast<std::size_t>(y / OpacityMap::kOriginBlock) * origin_columns(map.view) +
                            static_cast<std::size_t>(x / OpacityMap::kOriginBlock);
  const float d = std::max(z - map.first_depth[block], 0.f);
  const std::size_t layer = static_cast<std::size_t>(layer_of(map, d));
  const std::size_t texel =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(x);
  const std::uint32_t* layers = map.crossings.data() + texel * OpacityMap::kLayers;
  const float before = layer > 0 ? static_cast<float>(layers[layer - 1]) : 0.f;
  const float begin = layer > 0 ? map.layer_end[layer - 1] : 0.f;
  return kernel::light_crossings(d, begin, map.layer_end[layer], before, static_cast<float>(layers[layer])) *
         OpacityMap::kCrossingUnit;
}

/// Texels (x, y), (x + 1, y), … around a place and the weights of the right and lower ones.
struct Footprint {
  int x, y;
  float right, lower;
};

/// False where the place is not on the map, not even on the rim where only some of the texels are.
bool footprint(const CameraView& view, const MapPlace& at, Footprint& f) {
  const float x = std::floor(at.x - 0.5f), y = std::floor(at.y - 0.5f);
  const auto on = [](float v, int size) { return v >= -1 && v < static_cast<float>(size); };
  if (!at.in_front || !on(x, view.width) || !on(y, view.height)) return false;
  f = {static_cast<int>(x), static_cast<int>(y), at.x - 0.5f - x, at.y - 0.5f - y};
  return true;
}

}  // namespace

MapPlace place_on_map(const CameraView& view, Vec3 world) {
  const Vec3 p = transform_point(view.world_to_camera, world);
  const bool in_front = p.z >= view.near_plane;
  const float scale = view.perspective ? view.focal / (in_front ? p.z : view.near_plane) : view.focal;
  return {view.center_x + scale * p.x, view.center_y + scale * p.y, p.z, in_front};
}

float crossings_at(const OpacityMap& map, Vec3 p) {
  if (map.crossings.empty()) return 0;
  const MapPlace at = place_on_map(map.view, p);
  Footprint f;
  if (!footprint(map.view, at, f)) return 0;
  const auto row = [&](int y) {
    return texel_crossings(map, f.x, y, at.z) * (1 - f.right) + texel_crossings(map, f.x + 1, y, at.z) * f.right;
  };
  return row(f.y) * (1 - f.lower) + row(f.y + 1) * f.lower;
}

float mesh_visibility(const ShadowMap& map, Vec3 p, ShadowBias bias) {
  if (map.depth.empty()) return 1;
  const CameraView& view = map.view;
  const MapPlace at = place_on_map(view, p);
  Footprint f;
  if (!footprint(view, at, f)) return 1;
  const float texel = (view.perspective ? at.z : 1.f) / view.focal, margin = bias.metres + bias.texels * texel;
  const auto lit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= view.width || y >= view.height) return 1.f;
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
    return kernel::light_depth_test(at.z, map.depth[i], margin);
  };
  // A box of 3×3 bilinear look-ups: per axis the weights 1 − f, 1, 1, f over four texels.
  const auto row = [&](int y) {
    return lit(f.x - 1, y) * (1 - f.right) + lit(f.x, y) + lit(f.x + 1, y) + lit(f.x + 2, y) * f.right;
  };
  return (row(f.y - 1) * (1 - f.lower) + row(f.y) + row(f.y + 1) + row(f.y + 2) * f.lower) * (1.f / 9);
}

Illumination illuminate(const Light& light, Vec3 p) {
  if (light.type == Light::Type::kDirectional) return {-light.direction, INFINITY, light.intensity};
  const Vec3 to_light = light.position - p;
  const float d2 = std::max(dot(to_light, to_light), 1e-12f), distance = std::sqrt(d2);
  Illumination result{to_light / distance, distance, light.intensity / d2};
  if (light.type == Light::Type::kSpot)
    result.irradiance *= kernel::light_spot_share(-dot(result.to_light, light.direction), std::cos(light.inner_angle),
                                                  std::cos(light.outer_angle));
  return result;
}

Illumination illuminate(const PreparedLight& prepared, Vec3 p) {
  Illumination result = illuminate(prepared.light, p);
  if (prepared.only_in_view) {
    const Vec3 c = transform_point(prepared.opacity.view.world_to_camera, p);
    if (std::max(std::fabs(c.x), std::fabs(c.y)) > c.z) result.irradiance = {0, 0, 0};
  }
  return result;
}

Vec3 environment_irradiance(const std::array<Vec3, 9>& c, Vec3 normal) {
  const kernel::LightHarmonics h = kernel::light_harmonics(normal);
  const Vec3 e = c[0] * h.c00 + c[1] * h.c1n + c[2] * h.c10 + c[3] * h.c1p + c[4] * h.c2nn + c[5] * h.c2n + c[6] * h.c20 +
                 c[7] * h.c2p + c[8] * h.c2pp;
  return max(e, {0, 0, 0});
}

}  // namespace pelage
