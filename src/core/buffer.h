// Plain memory for large arrays: aligned for SIMD, not initialised, freed at the end.
#pragma once

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>

namespace pelage {

/// Asks for huge pages where [data, data + bytes) holds whole ones, which saves page faults on first writes.
inline void prefer_huge_pages(void* data, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20;
  const auto begin = reinterpret_cast<std::uintptr_t>(data), first = (begin + kHugePage - 1) / kHugePage * kHugePage,
             last = (begin + bytes) / kHugePage * kHugePage;
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#else
  (void)data, (void)bytes;
#endif
}

namespace detail {
/// Aligned for SIMD; large arrays lie in huge pages where the system has them, which saves page faults on first writes and
/// misses of the address translation ever after. Freed by std::free(); null when there is no memory.
inline void* allocate(std::size_t bytes) {
  constexpr std::size_t kHugePage = std::size_t{2} << 20;
  const std::size_t unit = bytes >= kHugePage ? kHugePage : 64;
  const std::size_t rounded = (bytes + unit - 1) / unit * unit;
  void* const data = std::aligned_alloc(unit, rounded);
  if (data) prefer_huge_pages(data, rounded);
  return data;
}
}  // namespace detail

/// Owning array of trivially copyable T, 64-byte aligned, contents undefined until written (fill() where needed).
/// Unlike std::vector it does not touch its pages on resize: clearing is a stage's own, parallel or lazy, business.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) { resize(size); }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer moved(std::move(other));
    swap(moved);
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { std::free(data_); }

  /// Discards the contents when it grows beyond the capacity; keeps them otherwise.
  void resize(std::size_t size) {
    if (size > capacity_) {
      if (size > (SIZE_MAX / 2) / sizeof(T)) throw std::bad_alloc();
      std::free(std::exchange(data_, nullptr));
      size_ = capacity_ = 0;
      data_ = static_cast<T*>(detail::allocate(size * sizeof(T)));
      if (!data_) throw std::bad_alloc();
      capacity_ = size;
    }
    size_ = size;
  }
  void release() { Buffer().swap(*this); }
  void fill(const T& value) {
    for (std::size_t i = 0; i < size_; ++i) data_[i] = value;
  }
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(capacity_, other.capacity_);
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return capacity_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace pelage
