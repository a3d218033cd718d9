// Counter-based random numbers: a pure function of (seed, stream, index), so results never depend on thread order.
// The mixer is pcg4d (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering"; references.bib: Jarzynski2020Hash).
#pragma once

#include <cstdint>

#include <pelage/vec.h>

namespace pelage {

struct RandomBits {
  std::uint32_t x, y, z, w;
};

inline RandomBits pcg4d(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  RandomBits v{a * 1664525u + 1013904223u, b * 1664525u + 1013904223u, c * 1664525u + 1013904223u, d * 1664525u + 1013904223u};
  const auto mix = [&] { v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z; };
  mix();
  v.x ^= v.x >> 16, v.y ^= v.y >> 16, v.z ^= v.z >> 16, v.w ^= v.w >> 16;
  mix();
  return v;
}

/// [0, 1) with 24 bits.
inline float uniform_from_bits(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

/// Random numbers of one item: `key` names the item (strand, pixel), `dimension` counts the draws.
class Rng {
 public:
  Rng(std::uint64_t seed, std::uint32_t key, std::uint32_t dimension = 0) : seed_(seed), key_(key), dimension_(dimension) {}
  float uniform() {
    return uniform_from_bits(
        pcg4d(static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32), key_, dimension_++).x);
  }
  Vec2 uniform2() {
    const float a = uniform();
    return {a, uniform()};
  }
  /// Standard normal (Box–Muller).
  float normal() {
    const float u = uniform(), v = uniform();
    return std::sqrt(-2 * std::log(1 - u)) * std::cos(6.28318531f * v);
  }

 private:
  std::uint64_t seed_;
  std::uint32_t key_, dimension_;
};

}  // namespace pelage
