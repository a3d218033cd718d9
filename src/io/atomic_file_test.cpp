#include "io/atomic_file.h"

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>

#include "kit/io_kit.h"

namespace pelage::io {
namespace {

using kit::TemporaryFolder;

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder / "a");
    file.write("text");
    EXPECT_FALSE(std::filesystem::exists(folder / "a"));
    file.commit();
  }
  EXPECT_EQ(kit::slurp(folder / "a"), "text");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, LeavesWhatWasThereWhenAbandoned) {
  const TemporaryFolder folder;
  kit::spill(folder / "a", "before");
  {
    AtomicFile file(folder / "a");
    file.write("after");
  }
  EXPECT_EQ(kit::slurp(folder / "a"), "before");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileItReplaces) {
  const TemporaryFolder folder;
  kit::spill(folder / "a", "before");
  ::chmod((folder / "a").c_str(), 0640);
  AtomicFile file(folder / "a");
  file.commit();
  struct stat status = {};
  ASSERT_EQ(::stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(AtomicFile, FollowsALink) {
  const TemporaryFolder folder;
  kit::spill(folder / "target", "before");
  std::filesystem::create_symlink(folder / "target", folder / "link");
  AtomicFile file(folder / "link");
  file.write("after");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(kit::slurp(folder / "target"), "after");
}

TEST(AtomicFile, WritesLargePiecesInOrder) {
  const TemporaryFolder folder;
  std::string expected;
  AtomicFile file(folder / "a");
  for (const std::size_t n : {1u, 1u << 19, 3u << 20, 5u, (1u << 20) - 1, 2u}) {
    const std::string piece(n, static_cast<char>('a' + expected.size() % 26));
    file.write(piece);
    expected += piece;
  }
  file.commit();
  EXPECT_EQ(kit::slurp(folder / "a"), expected);
}

void expect_error(const std::string& path, const std::string& part) {
  try {
    write_strands(path, kit::full_groom(), "pelage");
    ADD_FAILURE() << path << " was written";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    EXPECT_EQ(e.where(), path.empty() ? "output" : path);
  }
}

TEST(AtomicFile, SaysWhyItCannotWrite) {
  const TemporaryFolder folder;
  kit::spill(folder / "file", "");
  expect_error(folder.path(), "a directory");
  expect_error(folder / "absent/a.pelage", "make the folder first");
  expect_error(folder / "file/a.pelage", "Not a directory");
  expect_error("/proc/pelage-groom.pelage", "creating the file failed");  // a folder in which nobody may create
  expect_error("", "an empty file name");
  EXPECT_EQ(folder.entries(), 1u);
}

// /dev/full answers every write with "no space left on device".
TEST(AtomicFile, ReportsAFullDevice) { expect_error("/dev/full", "No space left on device"); }

// A file size limit fails in the middle of the writing, as a full disk does.
TEST(AtomicFile, LeavesNothingWhenTheDiskFillsUpOnTheWay) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.pelage", "before");
  struct rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small = {700, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  expect_error(folder / "a.pelage", "writing failed");
  Image image(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i * i % 1009) / 1009;
  for (const char* name : {"a.exr", "a.png", "a.hdr"}) EXPECT_THROW(write_image(folder / name, image), Error) << name;
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_EQ(kit::slurp(folder / "a.pelage"), "before");
}

}  // namespace
}  // namespace pelage::io
