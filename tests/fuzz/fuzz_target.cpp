// libFuzzer target of one reader. PELAGE_FUZZ_MAGIC, where given, is put over the beginning, so that every input reaches
// the reader that the target is named after; PELAGE_FUZZ_READ is a function of fuzz/readers.h.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr unsigned char kMagic[] = {PELAGE_FUZZ_MAGIC 0};
  std::vector<std::byte> bytes(size);  // an exact-size copy: the sanitizer sees the first byte too many
  const std::size_t covered = std::min(size, sizeof kMagic - 1);
  std::copy(kMagic, kMagic + covered, reinterpret_cast<unsigned char*>(bytes.data()));
  std::copy(data + covered, data + size, reinterpret_cast<unsigned char*>(bytes.data()) + covered);
  pelage::fuzz::PELAGE_FUZZ_READ(bytes);
  return 0;
}
