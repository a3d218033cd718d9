// Replays every input that once broke a reader (found by tools/fuzz.sh, or by hand), and a few made of them here.
#include <gtest/gtest.h>

#include <filesystem>
#include <span>

#include "fuzz/readers.h"
#include "kit/io_kit.h"

namespace pelage {
namespace {

void replay(const std::string& name, const std::string& bytes) {
  SCOPED_TRACE(name);
  EXPECT_NO_THROW(fuzz::replay(name, std::as_bytes(std::span(bytes))));
}

TEST(Regress, EveryInputEndsInAResultOrAnError) {
  const std::filesystem::path folder = PELAGE_SOURCE_DIR "/tests/regress/inputs";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string bytes = kit::slurp(entry.path().string());
    replay(entry.path().filename().string(), bytes);
    for (std::size_t n = 0; n < bytes.size(); n += 1 + bytes.size() / 64)
      replay(entry.path().filename().string() + " cut", bytes.substr(0, n));
  }
}

}  // namespace
}  // namespace pelage
