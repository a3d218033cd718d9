// The environment's latitude-longitude map: which direction a place of it stands for, and what comes from there.
#pragma once

#include <pelage/scene.h>

namespace pelage {

bool has_map(const Environment& environment);

/// Direction of a place of the map, u to the right, v down, both 0…1: the middle column looks along −Z.
Vec3 map_direction(const Environment& environment, float u, float v);

/// The place of a direction (unit length): the inverse of map_direction(), u in [0, 1).
Vec2 map_place(const Environment& environment, Vec3 d);

/// RGB of a texel; maps of fewer channels are gray.
Vec3 map_value(const Image& map, int x, int y);

/// Radiance from direction `d` (unit length, world space, pointing away from the scene), W/(m²·sr); bilinear.
Vec3 environment_radiance(const Environment& environment, Vec3 d);

}  // namespace pelage
