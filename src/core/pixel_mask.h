// Sets of pixels, a bit each: where hair is and what lies next to it. Work on hair costs what its pixels cost, not what the
// picture does, because it runs over such sets.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace pelage {

/// Pixels left ≤ x < right, top ≤ y < bottom; empty by default.
struct PixelBox {
  int left = 0, right = 0, top = 0, bottom = 0;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

/// A set of pixels of a width × height picture. Rows begin at words of their own, so that threads may write different rows.
class PixelMask {
 public:
  static constexpr std::size_t kRowsPerTask = 8;

  PixelMask() = default;
  /// The empty set. Sizes ≥ 0.
  PixelMask(int width, int height);
  /// The pixels p = y·width + x for which is_in(p) holds.
  template <class IsIn>
  PixelMask(int width, int height, const IsIn& is_in);

  int width() const { return width_; }
  int height() const { return height_; }
  /// False outside the picture.
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_ && word(x, y) >> (x % kBits) & 1; }
  void add(int x, int y) { words_[index(x, y)] |= bit(x); }
  void remove(int x, int y) { words_[index(x, y)] &= ~bit(x); }
  /// Pixel p = y·width + x.
  void add(std::size_t p) { add(column(p), row(p)); }
  void remove(std::size_t p) { remove(column(p), row(p)); }
  /// The same while other threads add pixels, too.
  void add_shared(std::size_t p) {
    const int x = column(p);
    std::atomic_ref(words_[index(x, row(p))]).fetch_or(bit(x), std::memory_order_relaxed);
  }

  /// Bit i of the result: whether (x + i, y) is in the set, for i < count ≤ 64; those outside the picture are not.
  std::uint64_t bits(int x, int y, int count) const;

  /// The pixels within `reach` ≥ 0 pixels in x and in y of one that is in the set.
  PixelMask grown(int reach) const;
  /// The pixels around which all within `reach` ≥ 0 pixels in x and in y are in the set and in the picture.
  PixelMask shrunk(int reach) const;
  /// Those of this set that are not in `other`, that are, and those of both; all of the same size.
  PixelMask without(const PixelMask& other) const;
  PixelMask intersected(const PixelMask& other) const;
  PixelMask united(const PixelMask& other) const;
  PixelBox box() const;
  std::size_t count() const;

  /// f(x, y) for the set's pixels in rows first ≤ y < last, 64 columns at a time, in these by y, then x: what lies around them
  /// stays in the cache.
  template <class F>
  void for_each(std::size_t first, std::size_t last, const F& f) const;
  /// The same over all rows, kRowsPerTask rows a task.
  template <class F>
  void parallel_for_each(const F& f) const {
    parallel_for(static_cast<std::size_t>(height_), kRowsPerTask,
                 [&](std::size_t first, std::size_t last) { for_each(first, last, f); });
  }

 private:
  static constexpr int kBits = 64;
  static std::uint64_t bit(int x) { return std::uint64_t{1} << (x % kBits); }
  int column(std::size_t p) const { return static_cast<int>(p % static_cast<std::size_t>(width_)); }
  int row(std::size_t p) const { return static_cast<int>(p / static_cast<std::size_t>(width_)); }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x / kBits); }
  std::uint64_t word(int x, int y) const { return words_[index(x, y)]; }
  /// Every pixel with all within `reach` in x and y, of which those outside the picture are not in the set.
  template <class Combine>
  PixelMask combined_around(int reach, const Combine& combine) const;
  template <class Combine>
  PixelMask combined(const PixelMask& other, const Combine& combine) const;

  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0;            // words a row
  std::vector<std::uint64_t> words_;  // bit x % 64 of word x / 64; 0 beyond the width
};

template <class IsIn>
PixelMask::PixelMask(int width, int height, const IsIn& is_in) : PixelMask(width, height) {
  parallel_for(static_cast<std::size_t>(height_), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y) {
      const std::size_t row = y * static_cast<std::size_t>(width_);
      for (int x = 0; x < width_; x += kBits) {
        std::uint64_t bits = 0;
        for (int i = 0, n = std::min(kBits, width_ - x); i < n; ++i)
          bits |= std::uint64_t{is_in(row + static_cast<std::size_t>(x + i))} << i;
        words_[index(x, static_cast<int>(y))] = bits;
      }
    }
  });
}

template <class F>
void PixelMask::for_each(std::size_t first, std::size_t last, const F& f) const {
  for (std::size_t w = 0; w < stride_; ++w)
    for (std::size_t y = first; y < last; ++y)
      for (std::uint64_t bits = words_[y * stride_ + w]; bits != 0; bits &= bits - 1)
        f(static_cast<int>(w) * kBits + std::countr_zero(bits), static_cast<int>(y));
}

}  // namespace pelage
