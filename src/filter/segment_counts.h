// How many pixels of a segment were hit and how many filled: a hash table that many threads write to.
#pragma once

#include <pelage/vec.h>

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/buffer.h"

namespace pelage {

/// Lock-free, with bounded probes; size by Huang 2025, eq. 14. Insert everything, then count, then read: each from as many
/// threads as you like, but one kind at a time.
class SegmentCounts {
 public:
  static constexpr std::size_t kMaxProbes = 64;

  /// Counts and colors of a segment. Sums are integers, so that their order does not matter.
  struct Slot {
    std::uint32_t key;  ///< kFree, or a segment
    std::uint32_t hit, filled;
    std::uint64_t red, green, blue;  ///< over the hit pixels, units of kColorUnit
  };
  static constexpr std::uint32_t kFree = 0xffffffffu;
  static constexpr float kColorUnit = 0x1p-20f;

  /// With `slots` > 0 slots.
  explicit SegmentCounts(std::size_t slots);

  /// False where there is no free slot within kMaxProbes.
  bool insert(std::uint32_t key);
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// Number of the slot; kNone for a key that was never inserted, or found no place.
  std::uint32_t find(std::uint32_t key) const;
  Slot& operator[](std::uint32_t slot) { return slots_[slot]; }
  const Slot& operator[](std::uint32_t slot) const { return slots_[slot]; }
  /// Takes all keys out.
  void clear();
  /// Keys that are in it.
  std::size_t used() const { return used_; }

  static void add_hit(Slot& slot, Vec3 color);
  static void add_filled(Slot& slot, std::uint32_t pixels) {
    std::atomic_ref(slot.filled).fetch_add(pixels, std::memory_order_relaxed);
  }
  /// Mean color of the hit pixels; `slot.hit` > 0.
  static Vec3 mean_color(const Slot& slot);

 private:
  /// One bit for many keys: clear where none of them was inserted. Fits into a cache, as the slots do not, and most samples
  /// are of segments that linking has not touched.
  static constexpr std::size_t kFilterWords = 1 << 14;
  Buffer<std::uint64_t> filter_{kFilterWords};
  Buffer<Slot> slots_;
  std::atomic<std::size_t> used_{0};
};

}  // namespace pelage
