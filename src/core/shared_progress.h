// Progress of one loop that many threads work on.
#pragma once

#include <pelage/error.h>
#include <pelage/progress.h>

#include <atomic>
#include <cstdint>
#include <mutex>

namespace pelage {

/// Tells progress from whichever thread gets there first, and passes a cancellation on.
class SharedProgress {
 public:
  /// `progress` must outlive this; `total` items are 100 %, > 0.
  SharedProgress(const Progress& progress, const char* stage, std::uint64_t total)
      : progress_(progress), stage_(stage), total_(total) {}

  /// `done` further items. Thread-safe; throws Error on the thread that is told to cancel.
  void add(std::uint64_t done) {
    const std::uint64_t now = done_.fetch_add(done, std::memory_order_relaxed) + done;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || now < told_) return;
    told_ = now;
    if (!progress_(stage_, static_cast<double>(now) / static_cast<double>(total_))) throw Error(stage_, "", "cancelled", "");
  }

 private:
  const Progress& progress_;
  const char* stage_;
  std::uint64_t total_, told_ = 0;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;
};

}  // namespace pelage
