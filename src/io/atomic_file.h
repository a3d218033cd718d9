// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pelage::io {

/// Writes to a temporary name beside `path`; commit() makes it durable and renames it. Without commit (an exception on
/// the way) the temporary file is removed and whatever was at `path` is untouched. A device or pipe at `path` cannot be
/// replaced and is written directly. Every failure (no folder, no permission, disk full) throws Error naming `path`.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    write(&value, sizeof(T));
  }
  const std::string& path() const { return path_; }
  void commit();

 private:
  void flush();
  void write_through(const char* data, std::size_t bytes);
  [[noreturn]] void fail(const char* doing, int error) const;

  std::string path_, temporary_;
  std::vector<char> buffer_;
  int descriptor_ = -1;
};

}  // namespace pelage::io
