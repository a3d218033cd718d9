// 64-bit pixels of the nearest-wins layers (see PixelKey in frame/frame.h).
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

#include "frame/frame.h"

namespace pelage {

inline PixelKey pixel_key(float depth, std::uint32_t id) {
  return static_cast<PixelKey>(std::bit_cast<std::uint32_t>(depth)) << 32 | id;
}
/// Metres; for non-empty keys.
inline float key_depth(PixelKey key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }
inline std::uint32_t key_id(PixelKey key) { return static_cast<std::uint32_t>(key); }

/// Nearest wins, from any thread.
inline void atomic_min(PixelKey& pixel, PixelKey key) {
  const std::atomic_ref<PixelKey> shared(pixel);
  PixelKey now = shared.load(std::memory_order_relaxed);
  while (key < now && !shared.compare_exchange_weak(now, key, std::memory_order_relaxed)) {
  }
}

}  // namespace pelage
