// The random numbers of one sample of one pixel, four at a time.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/rng.h"

namespace pelage {
namespace detail {

using SobolRow = std::array<std::uint32_t, 4>;

/// Four dimensions of Sobol's sequence: row k is what bit k of the index adds. Primitive polynomials and first numbers of
/// Joe & Kuo 2008, table "new-joe-kuo-6" (references.bib: Joe2008Sobol); the first dimension is the reversed index.
constexpr std::array<SobolRow, 32> sobol_rows() {
  struct Dimension {
    std::size_t degree;
    std::uint32_t coefficients, first[3];
  };
  constexpr Dimension dimensions[3] = {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}};
  std::array<SobolRow, 32> rows{};
  for (std::size_t k = 0; k < 32; ++k) rows[k][0] = 1u << (31 - k);
  for (std::size_t d = 0; d < 3; ++d) {
    const Dimension& m = dimensions[d];
    for (std::size_t k = 0; k < 32; ++k) {
      if (k < m.degree) {
        rows[k][d + 1] = m.first[k] << (31 - k);
        continue;
      }
      std::uint32_t v = rows[k - m.degree][d + 1] ^ (rows[k - m.degree][d + 1] >> m.degree);
      for (std::size_t i = 1; i < m.degree; ++i)
        if (m.coefficients >> (m.degree - 1 - i) & 1) v ^= rows[k - i][d + 1];
      rows[k][d + 1] = v;
    }
  }
  return rows;
}
constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
  return x >> 16 | x << 16;
}

/// What each value of each four bits of the reversed index adds: the rows, with their bits reversed too. So everything between
/// two scramblings stays reversed, as they need it.
using SobolTable = std::array<std::array<SobolRow, 16>, 8>;
constexpr SobolTable sobol_table() {
  const std::array<SobolRow, 32> rows = sobol_rows();
  SobolTable table{};
  for (std::size_t nibble = 0; nibble < 8; ++nibble)
    for (std::size_t value = 0; value < 16; ++value)
      for (std::size_t bit = 0; bit < 4; ++bit)
        for (std::size_t d = 0; d < 4; ++d)
          if (value >> bit & 1) table[nibble][value][d] ^= reverse_bits(rows[31 - (4 * nibble + bit)][d]);
  return table;
}
inline constexpr SobolTable kSobolTable = sobol_table();

/// A random permutation of [0, 2³²) that keeps the nesting of binary intervals: Owen's scrambling by the hash of Laine &
/// Karras, as in Burley 2020 (references.bib: Burley2020Owen), of numbers whose bits are reversed before and after.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

}  // namespace detail

/// A pure function of (seed, pixel, sample index); each call of next() goes to the next four dimensions.
///
/// Over the samples of a pixel the first kSobolBlocks · 4 dimensions are, four by four, Sobol sequences of random order
/// and scrambling: each sample by itself is uniform, together they are spread evenly. Further dimensions are independent.
class Sequence {
 public:
  static constexpr std::uint32_t kSobolBlocks = 7;  ///< the pixel and three scattering events

  Sequence(std::uint64_t seed, std::uint32_t pixel, std::uint32_t index)
      : key_(pcg4d(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), pixel, 0x9e3779b9u)),
        index_(index) {}

  /// Uniform in [0, 1).
  std::array<float, 4> next() {
    const std::uint32_t block = block_++;
    const RandomBits r = block < kSobolBlocks ? sobol(block) : pcg4d(key_.x, key_.y + index_, key_.z + block, key_.w);
    return {uniform_from_bits(r.x), uniform_from_bits(r.y), uniform_from_bits(r.z), uniform_from_bits(r.w)};
  }

  /// Random bits of ray `n` that starts where the sequence stands now, apart from all that next() gives.
  RandomBits ray_key(std::uint32_t n) const {
    return pcg4d(key_.x ^ 0x68bc21ebu, key_.y + index_, key_.z + block_, key_.w ^ (n + 1) * 0x85ebca6bu);
  }

  /// As next(), for numbers that nobody looks at.
  void skip() { ++block_; }

 private:
  RandomBits sobol(std::uint32_t block) const {
    using namespace detail;
    const RandomBits seeds = pcg4d(key_.x, key_.y, key_.z, key_.w + block);
    const std::uint32_t at = scramble_reversed(reverse_bits(index_), seeds.x ^ seeds.z);
    SobolRow v{};
    for (std::size_t nibble = 0; nibble < 8; ++nibble) {
      const SobolRow& row = kSobolTable[nibble][at >> (4 * nibble) & 15];
      for (std::size_t d = 0; d < 4; ++d) v[d] ^= row[d];
    }
    const auto draw = [](std::uint32_t x, std::uint32_t seed) { return reverse_bits(scramble_reversed(x, seed)); };
    return {draw(v[0], seeds.x), draw(v[1], seeds.y), draw(v[2], seeds.z), draw(v[3], seeds.w)};
  }

  RandomBits key_;
  std::uint32_t index_, block_ = 0;
};

}  // namespace pelage
