// XXH64, the checksum of `.pelage` files: fast enough to vanish beside reading, good enough to see any damage.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pelage::io {

/// Hashes bytes as they come; the value does not depend on how they were split. Seed 0.
/// (Collet, "xxHash fast digest algorithm", specification 0.1.1; references.bib: Collet2012XxHash)
class Xxh64 {
 public:
  void add(const void* data, std::size_t bytes);
  std::uint64_t value() const;

 private:
  static constexpr std::size_t kStripe = 32;
  void stripe(const unsigned char* data);
  std::uint64_t lanes_[4] = {0x60EA27EEADC0B5D6ull, 0xC2B2AE3D27D4EB4Full, 0, 0x61C8864E7A143579ull};
  unsigned char pending_[kStripe] = {};
  std::size_t pending_bytes_ = 0;
  std::uint64_t total_ = 0;
};

inline std::uint64_t xxh64(const void* data, std::size_t bytes) {
  Xxh64 hash;
  hash.add(data, bytes);
  return hash.value();
}

}  // namespace pelage::io
