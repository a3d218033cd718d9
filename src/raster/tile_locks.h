// Tiles of an image, each owned by one thread at a time.
#pragma once

#include <hwy/cache_control.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <thread>

namespace pelage {

/// Pixels x0 … x1, y0 … y1, ends included.
struct PixelBounds {
  int x0, x1, y0, y1;
};

/// A lock for each tile of kSide × kSide pixels. Owning the tiles around a few dozen fragments costs as much as two or
/// three atomic minimums, and inside a cache line of keys is read, compared and written as a whole.
class TileLocks {
 public:
  static constexpr int kSide = 64;

  TileLocks(int width, int height)
      : across_(tile(width - 1) + 1), locks_(std::make_unique<Lock[]>(across_ * (tile(height - 1) + 1))) {}

  /// Waits for all tiles that `r`, inside the image, meets; work() must not lock any.
  template <class Work>
  void own(const PixelBounds& r, const Work& work) {
    for_tiles(r, [](Lock& lock) { lock.acquire(); });
    work();
    for_tiles(r, [](Lock& lock) { lock.release(); });
  }

  static std::size_t tile(int pixel) { return static_cast<std::size_t>(pixel) / kSide; }
  static std::size_t count(const PixelBounds& r) { return (tile(r.x1) - tile(r.x0) + 1) * (tile(r.y1) - tile(r.y0) + 1); }

 private:
  struct alignas(64) Lock {
    std::atomic<bool> taken{false};
    // Owners need a tile for microseconds. To yield sooner would give other processes whole time slices of this thread.
    void acquire() {
      constexpr int kPauses = 256;
      for (int tries = 0; taken.exchange(true, std::memory_order_acquire);)
        while (taken.load(std::memory_order_relaxed)) {
          hwy::Pause();
          if (++tries % kPauses == 0) std::this_thread::yield();
        }
    }
    void release() { taken.store(false, std::memory_order_release); }
  };

  // Always in the same order: two threads that want the same tiles cannot wait for each other.
  template <class Visit>
  void for_tiles(const PixelBounds& r, const Visit& visit) {
    for (std::size_t y = tile(r.y0); y <= tile(r.y1); ++y)
      for (std::size_t x = tile(r.x0); x <= tile(r.x1); ++x) visit(locks_[y * across_ + x]);
  }

  std::size_t across_;
  std::unique_ptr<Lock[]> locks_;
};

}  // namespace pelage
