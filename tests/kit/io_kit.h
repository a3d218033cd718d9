// What the tests of files share: a folder that goes away, whole-file access, the real data, a groom with everything.
#pragma once

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/strand_set.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace pelage::kit {

/// A new empty folder, removed with its contents at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pelage-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

/// What read() throws; "" where it does not.
template <class Read>
std::string error_of(const Read& read) {
  try {
    read();
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

inline std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}
inline void spill(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// A file of the folder of real data, or "" where it is absent: then PELAGE_NEEDS skips the test.
inline std::string real_file(const std::string& name) {
  const char* folder = std::getenv("PELAGE_DATA");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : PELAGE_SOURCE_DIR "/../shared/data") / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

/// Three strands of 4 points (whole Bézier spans too), every attribute present and every value different.
inline StrandSet full_groom(bool point_colors = true) {
  StrandSet set;
  set.offsets = {0, 4, 8, 12};
  for (std::uint32_t i = 0; i < 12; ++i) {
    const auto f = static_cast<float>(i);
    set.points.emplace_back(0.1f * f, 0.2f - 0.013f * f * f, 0.05f * f + 0.001f);
    set.widths.push_back(5e-5f + 1e-6f * f);
    set.transparency.push_back(f / 20);
    if (point_colors) set.colors.emplace_back(f / 12, 1 - f / 12, 0.25f);
  }
  if (!point_colors) set.colors = {{0.1f, 0.2f, 0.3f}, {0.4f, 0.5f, 0.6f}, {0.7f, 0.8f, 0.9f}};
  set.root_uv = {{0.25f, 0.5f}, {0.75f, 0.125f}, {1.5f, -0.5f}};
  set.strand_id = {7, 4294967295u, 0};
  set.guide_id = {-1, 7, 0};
  set.group = {0, 65535, 3};
  set.comment = "three strands";
  return set;
}

}  // namespace pelage::kit

#define PELAGE_NEEDS(variable, name)                           \
  const std::string variable = ::pelage::kit::real_file(name); \
  if (variable.empty()) GTEST_SKIP() << "PELAGE_DATA has no " << (name)
