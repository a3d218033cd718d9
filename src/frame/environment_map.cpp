#include "frame/environment_map.h"

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;

}  // namespace

bool has_map(const Environment& environment) {
  return environment.map && environment.map->width > 0 && environment.map->height > 0;
}

Vec3 map_direction(const Environment& environment, float u, float v) {
  const float azimuth = (u - 0.5f) * 2 * kPi - environment.rotation, polar = v * kPi;
  return {std::sin(azimuth) * std::sin(polar), std::cos(polar), -std::cos(azimuth) * std::sin(polar)};
}

Vec2 map_place(const Environment& environment, Vec3 d) {
  const float u = (std::atan2(d.x, -d.z) + environment.rotation) / (2 * kPi) + 0.5f;
  return {u - std::floor(u), std::acos(std::clamp(d.y, -1.f, 1.f)) / kPi};
}

Vec3 map_value(const Image& map, int x, int y) {
  const float* c = map.at(x, y);
  return map.channel_count() >= 3 ? Vec3(c[0], c[1], c[2]) : Vec3(c[0], c[0], c[0]);
}

Vec3 environment_radiance(const Environment& environment, Vec3 d) {
  if (!has_map(environment)) return environment.radiance;
  const Image& map = *environment.map;
  const Vec2 at = map_place(environment, d);
  const float x = at.x * static_cast<float>(map.width) - 0.5f;
  const float y = std::clamp(at.y * static_cast<float>(map.height) - 0.5f, 0.f, static_cast<float>(map.height - 1));
  const float x0 = std::floor(x), y0 = std::floor(y);
  const auto value = [&](float px, float py) {
    const int ix = (static_cast<int>(px) + map.width) % map.width;
    return map_value(map, ix, std::min(static_cast<int>(py), map.height - 1));
  };
  const Vec3 top = lerp(value(x0, y0), value(x0 + 1, y0), x - x0);
  const Vec3 bottom = lerp(value(x0, y0 + 1), value(x0 + 1, y0 + 1), x - x0);
  return environment.radiance * lerp(top, bottom, y - y0);
}

}  // namespace pelage
