// A fingerprint of bytes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pelage {

/// FNV-1a, 64 bits (Fowler, Noll & Vo): the same on every machine of the same byte order. For comparing results, not for security.
inline std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed = 0xcbf29ce484222325u) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) seed = (seed ^ bytes[i]) * 0x100000001b3u;
  return seed;
}

}  // namespace pelage
