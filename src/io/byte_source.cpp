#include "io/byte_source.h"

#include <pelage/error.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <utility>

namespace pelage::io {

static_assert(std::endian::native == std::endian::little, "the formats are little-endian and are read as they stand");

namespace {
constexpr std::size_t kWindowBytes = 64 * 1024;
}

ByteSource ByteSource::open(const std::string& path) {
  // O_NONBLOCK: a pipe without a writer must not hang the call; it is refused below.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    throw Error(path, "", errno == ENOENT ? "no such file" : fmt::format("cannot be opened: {}", std::strerror(errno)),
                errno == ENOENT ? "check the path" : "check the permissions");
  struct stat status = {};
  const bool known = ::fstat(descriptor, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    if (known && S_ISDIR(status.st_mode)) throw Error(path, "", "a directory, not a file", "name a file inside it");
    throw Error(path, "", "not a regular file", "save it to disk first");
  }
  return ByteSource(path, descriptor, static_cast<std::uint64_t>(status.st_size));
}

ByteSource::ByteSource(std::string name, int descriptor, std::uint64_t size)
    : name_(std::move(name)), descriptor_(descriptor), size_(size) {}

ByteSource::ByteSource(std::string name, std::span<const std::byte> bytes)
    : name_(std::move(name)), size_(bytes.size()), memory_(bytes) {}

ByteSource::ByteSource(ByteSource&& other) noexcept
    : name_(std::move(other.name_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_),
      memory_(other.memory_), window_(std::move(other.window_)), window_begin_(other.window_begin_) {}

ByteSource::~ByteSource() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void ByteSource::require(std::uint64_t offset, std::uint64_t bytes, const char* what) const {
  if (offset <= size_ && bytes <= size_ - offset) return;
  throw Error(name_, fmt::format("byte {}", offset),
              fmt::format("{} of {} bytes expected, the file ends at byte {}", what, bytes, size_),
              "the file is truncated or damaged; export it again");
}

void ByteSource::read(std::uint64_t offset, std::size_t bytes, void* target, const char* what) const {
  require(offset, bytes, what);
  if (bytes == 0) return;
  if (descriptor_ < 0 || bytes <= kWindowBytes / 4) std::memcpy(target, window(offset, bytes, what), bytes);
  else read_file(offset, bytes, static_cast<std::byte*>(target), what);
}

void ByteSource::read_file(std::uint64_t offset, std::size_t bytes, std::byte* target, const char* what) const {
  while (bytes > 0) {
    const ssize_t got = ::pread(descriptor_, target, bytes, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      throw Error(name_, fmt::format("byte {}", offset),
                  got == 0 ? fmt::format("the file ended while its {} was read", what)
                           : fmt::format("reading the {} failed: {}", what, std::strerror(errno)),
                  "does another program write to it?");
    target += got, offset += static_cast<std::uint64_t>(got), bytes -= static_cast<std::size_t>(got);
  }
}

const std::byte* ByteSource::window(std::uint64_t offset, std::size_t bytes, const char* what) const {
  require(offset, bytes, what);
  if (descriptor_ < 0) return memory_.data() + offset;
  if (offset < window_begin_ || offset + bytes > window_begin_ + window_.size()) {
    window_.resize(std::min<std::uint64_t>(std::max(kWindowBytes, bytes), size_ - offset));
    window_begin_ = offset;
    read_file(offset, window_.size(), window_.data(), what);
  }
  return window_.data() + (offset - window_begin_);
}

std::vector<char> ByteSource::read_all() const {
  std::vector<char> all(size_);
  read(0, all.size(), all.data(), "contents");
  return all;
}

}  // namespace pelage::io
