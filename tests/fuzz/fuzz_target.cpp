// libFuzzer target of one reader. PELAGE_FUZZ_MAGIC, where given, is put over the beginning, so that every input reaches
// the reader that the target is named after; PELAGE_FUZZ_READ is read_groom or read_mesh.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr unsigned char kMagic[] = {PELAGE_FUZZ_MAGIC 0};
  std::vector<std::byte> bytes(size);  // an exact-size copy: the sanitizer sees the first byte too many
  if (size > 0) std::memcpy(bytes.data(), data, size);
  std::memcpy(bytes.data(), kMagic, std::min(size, sizeof kMagic - 1));
  pelage::fuzz::PELAGE_FUZZ_READ(bytes);
  return 0;
}
