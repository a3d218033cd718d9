// The random numbers of one sample of one pixel, four at a time.
#pragma once

#include <array>
#include <cstdint>

#include "core/rng.h"

namespace pelage {

/// A pure function of (seed, pixel, sample index); each call of next() goes to the next four dimensions.
class Sequence {
 public:
  Sequence(std::uint64_t seed, std::uint32_t pixel, std::uint32_t index)
      : key_(pcg4d(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), pixel, 0x9e3779b9u)),
        index_(index) {}

  /// Uniform in [0, 1).
  std::array<float, 4> next() {
    const RandomBits r = pcg4d(key_.x, key_.y + index_, key_.z + block_, key_.w);
    ++block_;
    return {uniform_from_bits(r.x), uniform_from_bits(r.y), uniform_from_bits(r.z), uniform_from_bits(r.w)};
  }

 private:
  RandomBits key_;
  std::uint32_t index_, block_ = 0;
};

}  // namespace pelage
