// Smooth random fields: value noise on a lattice of hashes, C¹, a pure function of (seed, place).
#pragma once

#include <pelage/vec.h>

#include <cmath>
#include <cstdint>

#include "core/rng.h"

namespace pelage::groom {

/// In [−1, 1], standard deviation about 0.4, features about one unit apart.
inline float noise3(Vec3 p, std::uint32_t seed) {
  const Vec3 base(std::floor(p.x), std::floor(p.y), std::floor(p.z));
  const auto ease = [](float t) { return t * t * (3 - 2 * t); };
  const float fx = ease(p.x - base.x), fy = ease(p.y - base.y), fz = ease(p.z - base.z);
  const auto corner = [&](int dx, int dy, int dz) {
    const auto cell = [](float f, int d) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(f) + d); };
    return uniform_from_bits(pcg4d(cell(base.x, dx), cell(base.y, dy), cell(base.z, dz), seed).x);
  };
  const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
  const auto row = [&](int dy, int dz) { return mix(corner(0, dy, dz), corner(1, dy, dz), fx); };
  return 2 * mix(mix(row(0, 0), row(1, 0), fy), mix(row(0, 1), row(1, 1), fy), fz) - 1;
}

inline Vec3 noise3_vector(Vec3 p, std::uint32_t seed) {
  return {noise3(p, seed), noise3(p + Vec3(37.2f, 11.7f, 5.1f), seed + 1), noise3(p + Vec3(3.3f, 29.9f, 71.4f), seed + 2)};
}

}  // namespace pelage::groom
