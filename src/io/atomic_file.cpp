#include "io/atomic_file.h"

#include <pelage/error.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace pelage::io {
namespace {

constexpr std::size_t kBufferBytes = 1 << 20;

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

std::string remedy_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT: return "free some space or write elsewhere";
    case EACCES:
    case EPERM:
    case EROFS: return "choose a folder that you may write to";
    case ENOENT:
    case ENOTDIR: return "make the folder first";
    default: return "";
  }
}

}  // namespace

void AtomicFile::fail(const char* doing, int error) const {
  throw Error(path_, "", fmt::format("{} failed: {}", doing, std::strerror(error)), remedy_for(error));
}

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  if (path.empty()) throw Error("output", "", "an empty file name", "name a file");
  struct stat status = {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  std::error_code ignored;  // a link is followed: it stays, and what it points to is replaced
  if (std::filesystem::is_symlink(path, ignored)) path_ = std::filesystem::weakly_canonical(path, ignored).string();
  if (exists && S_ISDIR(status.st_mode)) throw Error(path, "", "a directory, not a file", "name a file inside it");
  if (exists && !S_ISREG(status.st_mode)) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("opening", errno);
    return;
  }
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; descriptor_ < 0 && attempt < 100; ++attempt) {
    temporary_ = fmt::format("{}.{}-{}.tmp", path_, ::getpid(), counter++);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) {
    const int error = errno;
    temporary_.clear();
    fail("creating the file", error);
  }
  if (exists) static_cast<void>(::fchmod(descriptor_, status.st_mode & 07777));
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  const auto* from = static_cast<const char*>(data);
  if (buffer_.size() + bytes > kBufferBytes) flush();
  if (bytes > kBufferBytes) return write_through(from, bytes);
  buffer_.insert(buffer_.end(), from, from + bytes);
}

void AtomicFile::flush() {
  write_through(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void AtomicFile::write_through(const char* from, std::size_t left) {
  while (left > 0) {
    const ssize_t written = ::write(descriptor_, from, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("writing", errno);
    from += written, left -= static_cast<std::size_t>(written);
  }
}

void AtomicFile::commit() {
  flush();
  // Devices and pipes have nothing to synchronize and say EINVAL.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("writing", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("closing", errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("renaming the finished file", errno);
  temporary_.clear();
  // The rename itself becomes durable with its folder; a file system that cannot do that has done what it can.
  const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    static_cast<void>(::fsync(folder));
    ::close(folder);
  }
}

}  // namespace pelage::io
