#include "io/text_words.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace pelage::io {
namespace {

TEST(TextWords, NumbersAreWholeWordsThatAFloatHolds) {
  EXPECT_EQ(float_from("1.5"), 1.5f);
  EXPECT_EQ(float_from("-2e-3"), -2e-3f);
  EXPECT_EQ(float_from("+3"), 3.f) << "some exporters sign everything";
  EXPECT_EQ(float_from("3.40282346e38"), 3.40282346e38f);
  for (const char* bad : {"", "+", "-", "1.5x", " 1", "1 ", "x", "1,5", "nan", "inf", "3.5e38", "-1e39", "1e999"})
    EXPECT_FALSE(float_from(bad)) << "'" << bad << "'";
}

TEST(TextWords, WhatIsTooSmallForAFloatIsZero) {
  EXPECT_EQ(float_from("1e-60"), 0.f);
  EXPECT_EQ(float_from("-1e-60"), 0.f);
  EXPECT_EQ(float_from("1e-40"), 1e-40f) << "subnormal";
}

TEST(TextWords, WholeNumbersFitTheirType) {
  EXPECT_EQ(integer_from<std::uint32_t>("4294967295"), 4294967295u);
  EXPECT_EQ(integer_from<std::int32_t>("-7"), -7);
  for (const char* bad : {"", "-1", "4294967296", "1.0", "7x"}) EXPECT_FALSE(integer_from<std::uint32_t>(bad)) << bad;
}

TEST(TextWords, LinesAndWords) {
  std::string_view rest = "a\tb  c\r\n\nlast";
  Words words(take_line(rest));
  EXPECT_EQ(words.next(), "a");
  EXPECT_EQ(words.next(), "b");
  EXPECT_EQ(words.next(), "c") << "without the carriage return";
  EXPECT_EQ(words.next(), "");
  EXPECT_EQ(words.next(), "") << "and again";
  EXPECT_EQ(take_line(rest), "");
  EXPECT_EQ(take_line(rest), "last");
  EXPECT_TRUE(rest.empty());
}

}  // namespace
}  // namespace pelage::io
