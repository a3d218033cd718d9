#include "core/pixel_mask.h"

#include <functional>

#include "core/check.h"

namespace pelage {

PixelMask::PixelMask(int width, int height)
    : width_(width), height_(height), stride_(static_cast<std::size_t>(width + kBits - 1) / kBits),
      words_(stride_ * static_cast<std::size_t>(height)) {
  PELAGE_CHECK(width >= 0 && height >= 0);
}

std::uint64_t PixelMask::bits(int x, int y, int count) const {
  if (y < 0 || y >= height_) return 0;
  const auto at = [&](int w) {
    return w >= 0 && w < static_cast<int>(stride_) ? words_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(w)]
                                                   : 0;
  };
  const int w = x >= 0 ? x / kBits : (x + 1) / kBits - 1, shift = x - w * kBits;
  const std::uint64_t found = at(w) >> shift | (shift ? at(w + 1) << (kBits - shift) : 0);
  return count < kBits ? found & ((std::uint64_t{1} << count) - 1) : found;
}

template <class Combine>
PixelMask PixelMask::combined_around(int reach, const Combine& combine) const {
  PixelMask wide(width_, height_), result(width_, height_);
  if (stride_ == 0) return result;
  const std::uint64_t last_word = width_ % kBits ? bit(width_) - 1 : ~std::uint64_t{0};
  std::vector<std::uint64_t> row(stride_);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    std::uint64_t* const out = &wide.words_[y * stride_];
    std::copy_n(&words_[y * stride_], stride_, out);
    for (int step = 0; step < reach; ++step) {
      std::copy_n(out, stride_, row.begin());
      for (std::size_t w = 0; w < stride_; ++w) {
        const std::uint64_t left = w > 0 ? row[w - 1] >> (kBits - 1) : 0,
                            right = w + 1 < stride_ ? row[w + 1] << (kBits - 1) : 0;
        out[w] = combine(row[w], combine(row[w] << 1 | left, row[w] >> 1 | right));
      }
      out[stride_ - 1] &= last_word;
    }
  }
  for (int y = 0; y < height_; ++y)
    for (std::size_t w = 0; w < stride_; ++w) {
      const auto word_of = [&](int j) {
        return j >= 0 && j < height_ ? wide.words_[static_cast<std::size_t>(j) * stride_ + w] : std::uint64_t{0};
      };
      std::uint64_t all = word_of(y);
      for (int j = 1; j <= reach; ++j) all = combine(all, combine(word_of(y - j), word_of(y + j)));
      result.words_[static_cast<std::size_t>(y) * stride_ + w] = all;
    }
  return result;
}

PixelMask PixelMask::grown(int reach) const { return combined_around(reach, std::bit_or<std::uint64_t>()); }
PixelMask PixelMask::shrunk(int reach) const { return combined_around(reach, std::bit_and<std::uint64_t>()); }

template <class Combine>
PixelMask PixelMask::combined(const PixelMask& other, const Combine& combine) const {
  PELAGE_CHECK(width_ == other.width_ && height_ == other.height_);
  PixelMask result(width_, height_);
  std::transform(words_.begin(), words_.end(), other.words_.begin(), result.words_.begin(), combine);
  return result;
}

PixelMask PixelMask::without(const PixelMask& other) const {
  return combined(other, [](std::uint64_t a, std::uint64_t b) { return a & ~b; });
}

PixelMask PixelMask::intersected(const PixelMask& other) const {
  return combined(other, [](std::uint64_t a, std::uint64_t b) { return a & b; });
}

PixelMask PixelMask::united(const PixelMask& other) const {
  return combined(other, [](std::uint64_t a, std::uint64_t b) { return a | b; });
}

PixelBox PixelMask::box() const {
  PixelBox box{width_, 0, height_, 0};
  for (int y = 0; y < height_; ++y)
    for (int w = 0; w < static_cast<int>(stride_); ++w) {
      const std::uint64_t bits = words_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(w)];
      if (bits == 0) continue;
      box.left = std::min(box.left, w * kBits + std::countr_zero(bits));
      box.right = std::max(box.right, (w + 1) * kBits - std::countl_zero(bits));
      box.top = std::min(box.top, y), box.bottom = y + 1;
    }
  return box.bottom > 0 ? box : PixelBox{};
}

std::size_t PixelMask::count() const {
  std::size_t n = 0;
  for (const std::uint64_t bits : words_) n += static_cast<std::size_t>(std::popcount(bits));
  return n;
}

}  // namespace pelage
