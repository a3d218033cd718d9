#include "filter/segment_counts.h"

#include <algorithm>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

std::uint64_t fixed(float radiance) {
  constexpr float kMost = 0x1p20f;  // a sum of 2^24 pixels of it fits
  return static_cast<std::uint64_t>(std::clamp(radiance, 0.f, kMost) * (1 / SegmentCounts::kColorUnit));
}

/// Spreads neighboring keys over the table (Knuth's multiplicative hash), then scales to its size.
std::size_t first_slot(std::uint32_t key, std::size_t size) {
  return static_cast<std::size_t>(static_cast<std::uint64_t>(key * 2654435769u) * size >> 32);
}

/// Word and bit of a key in the filter.
std::size_t filter_word(std::uint32_t key, std::size_t words) { return first_slot(key * 0x9e3779b1u, words); }
std::uint64_t filter_bit(std::uint32_t key) { return std::uint64_t{1} << (key & 63); }

}  // namespace

SegmentCounts::SegmentCounts(std::size_t slots) : slots_(slots) {
  PELAGE_CHECK(slots > 0 && slots <= 0xffffffffu);
  clear();
}

void SegmentCounts::clear() {
  filter_.fill(0);
  used_ = 0;
  parallel_for(slots_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    std::fill(slots_.begin() + begin, slots_.begin() + end,
              Slot{.key = kFree, .hit = 0, .filled = 0, .red = 0, .green = 0, .blue = 0});
  });
}

bool SegmentCounts::insert(std::uint32_t key) {
  std::size_t i = first_slot(key, slots_.size());
  for (std::size_t probe = 0; probe < std::min(kMaxProbes, slots_.size()); ++probe) {
    const std::atomic_ref<std::uint32_t> slot(slots_[i].key);
    std::uint32_t found = slot.load(std::memory_order_relaxed);
    const bool taken = found == kFree && slot.compare_exchange_strong(found, key, std::memory_order_relaxed);
    if (taken) used_.fetch_add(1, std::memory_order_relaxed);
    if (taken || found == key) {
      std::atomic_ref(filter_[filter_word(key, kFilterWords)]).fetch_or(filter_bit(key), std::memory_order_relaxed);
      return true;
    }
    i = i + 1 < slots_.size() ? i + 1 : 0;
  }
  return false;
}

std::uint32_t SegmentCounts::find(std::uint32_t key) const {
  if (!(filter_[filter_word(key, kFilterWords)] & filter_bit(key))) return kNone;
  std::size_t i = first_slot(key, slots_.size());
  for (std::size_t probe = 0; probe < std::min(kMaxProbes, slots_.size()); ++probe) {
    if (slots_[i].key == key) return static_cast<std::uint32_t>(i);
    if (slots_[i].key == kFree) return kNone;
    i = i + 1 < slots_.size() ? i + 1 : 0;
  }
  return kNone;
}

void SegmentCounts::add_hit(Slot& slot, Vec3 color) {
  const auto add = [](auto& sum, auto value) { std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed); };
  add(slot.hit, 1u);
  add(slot.red, fixed(color.x)), add(slot.green, fixed(color.y)), add(slot.blue, fixed(color.z));
}

Vec3 SegmentCounts::mean_color(const Slot& slot) {
  const float unit = kColorUnit / static_cast<float>(slot.hit);
  return Vec3(static_cast<float>(slot.red), static_cast<float>(slot.green), static_cast<float>(slot.blue)) * unit;
}

}  // namespace pelage
