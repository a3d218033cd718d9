#include "io/xxh64.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pelage::io {
namespace {

// Published test vectors of the reference implementation (seed 0).
TEST(Xxh64, KnownValues) {
  const auto hash = [](const std::string& text) { return xxh64(text.data(), text.size()); };
  EXPECT_EQ(hash(""), 0xEF46DB3751D8E999ull);
  EXPECT_EQ(hash("a"), 0xD24EC4F1A98C6E5Bull);
  EXPECT_EQ(hash("abc"), 0x44BC2CF5AD770999ull);
  EXPECT_EQ(hash("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1ull);
}

TEST(Xxh64, DoesNotDependOnHowTheBytesCome) {
  std::vector<unsigned char> bytes(200);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(i * 37);
  for (std::size_t n = 0; n <= bytes.size(); ++n) {
    const std::uint64_t whole = xxh64(bytes.data(), n);
    for (const std::size_t step : {1u, 7u, 31u, 32u, 33u}) {
      Xxh64 hash;
      for (std::size_t i = 0; i < n; i += step) hash.add(bytes.data() + i, std::min(step, n - i));
      ASSERT_EQ(hash.value(), whole) << n << " bytes by " << step;
    }
  }
}

}  // namespace
}  // namespace pelage::io
