// Bytes to read, from a file or from memory, at any place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace pelage::io {

/// Read-only bytes behind a name. Every access is checked against the size, so that a reader can neither run over the end
/// nor trust a count: an access outside throws Error naming the byte and what was wanted there.
/// Files are read, not mapped: one that shrinks meanwhile is an Error, not a signal, and its pages do not count as ours.
///
/// Not thread safe (small reads go through one window). Untrusted-input safe.
class ByteSource {
 public:
  /// Throws Error when `path` is missing, unreadable, a directory or anything else but a regular file.
  static ByteSource open(const std::string& path);
  /// The bytes must outlive the source.
  ByteSource(std::string name, std::span<const std::byte> bytes);
  ByteSource(ByteSource&&) noexcept;
  ~ByteSource();

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Throws Error unless [offset, offset + bytes) is inside; `what` says what should stand there ("point array").
  void require(std::uint64_t offset, std::uint64_t bytes, const char* what) const;
  /// Copies bytes to `target`. Small pieces come from the window.
  void read(std::uint64_t offset, std::size_t bytes, void* target, const char* what) const;
  /// One little-endian number or packed struct; neighbors are buffered.
  template <class T>
  T get(std::uint64_t offset, const char* what) const {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, window(offset, sizeof(T), what), sizeof(T));
    return value;
  }
  /// Everything, for text formats and small containers.
  std::vector<char> read_all() const;

 private:
  ByteSource(std::string name, int descriptor, std::uint64_t size);
  void read_file(std::uint64_t offset, std::size_t bytes, std::byte* target, const char* what) const;
  const std::byte* window(std::uint64_t offset, std::size_t bytes, const char* what) const;

  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::span<const std::byte> memory_;
  mutable std::vector<std::byte> window_;
  mutable std::uint64_t window_begin_ = 0;
};

}  // namespace pelage::io
