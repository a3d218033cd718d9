#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <cmath>
#include <cstdint>

#include "kit/io_kit.h"

namespace pelage {
namespace {

using kit::TemporaryFolder;

// Values that 8 bits hold exactly, different in every channel; odd size.
Image pattern(std::vector<std::string> channels) {
  Image image(17, 5, std::move(channels));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i * 73 % 256) / 255;
  return image;
}

TEST(Images, ExrKeepsFloatsAndNamedChannels) {
  const TemporaryFolder folder;
  Image image = pattern({"R", "G", "B", "A", "Z"});
  image.pixels[7] = 1234.5678f;
  image.pixels[8] = -3e20f;
  write_image(folder / "a.exr", image, true);
  const Image back = read_image(folder / "a.exr");
  EXPECT_EQ(back.width, 17);
  EXPECT_EQ(back.height, 5);
  EXPECT_EQ(back.channels, image.channels);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Images, ExrIsHalfByDefault) {
  const TemporaryFolder folder;
  Image image(2, 1, {"R"});
  image.pixels = {1.0f / 3, 2049};
  write_image(folder / "a.exr", image);
  const Image back = read_image(folder / "a.exr");
  EXPECT_NEAR(back.pixels[0], 1.0f / 3, 1.0f / 3 / 2048);
  EXPECT_NE(back.pixels[0], 1.0f / 3);
  EXPECT_EQ(back.pixels[1], 2048);
}

// Half-transparent colors must neither be multiplied nor divided by their alpha on the way.
TEST(Images, PngKeepsWhatItIsGiven) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& channels : {std::vector<std::string>{"Y"}, {"R", "G", "B"}, {"R", "G", "B", "A"}}) {
    const Image image = pattern(channels);
    for (const bool sixteen : {false, true}) {
      write_image(folder / "a.png", image, sixteen);
      const Image back = read_image(folder / "a.png", false);
      ASSERT_EQ(back.pixels.size(), image.pixels.size());
      for (std::size_t i = 0; i < image.pixels.size(); ++i)
        ASSERT_NEAR(back.pixels[i], image.pixels[i], 1e-6) << i << " of " << channels.size() << " channels";
    }
  }
}

TEST(Images, PngIsDecodedToLinearWhenAsked) {
  const TemporaryFolder folder;
  Image image(1, 1, {"R", "G", "B", "A"});
  image.pixels = {0, 0.50196078f, 1, 0.50196078f};
  write_image(folder / "a.png", image);
  const Image back = read_image(folder / "a.png");
  EXPECT_EQ(back.pixels[0], 0);
  EXPECT_NEAR(back.pixels[1], 0.2158605, 1e-5);  // sRGB 128
  EXPECT_EQ(back.pixels[2], 1);
  EXPECT_NEAR(back.pixels[3], 0.50196078, 1e-6) << "alpha is linear already";
}

TEST(Images, PngClampsAndHdrHoldsLargeValues) {
  const TemporaryFolder folder;
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {3000, 1500, -1};
  write_image(folder / "a.png", image);
  EXPECT_EQ(read_image(folder / "a.png", false).pixels, (std::vector<float>{1, 1, 0}));
  image.pixels[2] = 0;
  write_image(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr");
  EXPECT_NEAR(back.pixels[0], 3000, 3000 / 128.);
  EXPECT_NEAR(back.pixels[1], 1500, 3000 / 128.);
}

TEST(Images, SameBytesEveryTime) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.png", "a.exr", "a.hdr"}) {
    write_image(folder / name, pattern({"R", "G", "B"}));
    const std::string first = kit::slurp(folder / name);
    write_image(folder / name, pattern({"R", "G", "B"}));
    EXPECT_EQ(kit::slurp(folder / name), first) << name;
  }
}

TEST(Images, Misuse) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_image(folder / "absent.png"), Error);
  EXPECT_THROW(read_image(folder.path()), Error);
  kit::spill(folder / "empty.exr", "");
  kit::spill(folder / "text.png", "no picture at all");
  EXPECT_THROW(read_image(folder / "empty.exr"), Error);
  EXPECT_THROW(read_image(folder / "text.png"), Error);
  EXPECT_THROW(write_image(folder / "a.tiff", pattern({"R"})), Error);
  EXPECT_THROW(write_image(folder / "a.hdr", pattern({"R", "G", "B", "A"})), Error);
  EXPECT_THROW(write_image(folder / "a.png", pattern({"R", "G", "B", "A", "Z"})), Error);
  EXPECT_THROW(write_image(folder / "a.png", Image()), Error);
  EXPECT_THROW(write_image(folder / "absent/a.png", pattern({"R"})), Error);
  Image torn = pattern({"R"});
  torn.pixels.pop_back();
  EXPECT_THROW(write_image(folder / "a.png", torn), Error);
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Images, EveryTruncationIsAnErrorOrAWholePicture) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.png", "a.exr", "a.hdr"}) {
    write_image(folder / name, pattern({"R", "G", "B"}));
    const std::string whole = kit::slurp(folder / name);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      kit::spill(folder / name, whole.substr(0, n));
      try {
        const Image image = read_image(folder / name);  // the checksum after the last pixel may be missing
        EXPECT_EQ(image.pixels.size(), 17u * 5 * 3);
      } catch (const Error& e) {
        EXPECT_EQ(e.where(), folder / name);
      }
    }
  }
}

TEST(Images, ACutPngIsAnErrorAndNothingIsPrinted) {
  const TemporaryFolder folder;
  write_image(folder / "a.png", pattern({"R", "G", "B"}));
  const std::string whole = kit::slurp(folder / "a.png");
  testing::internal::CaptureStderr();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    kit::spill(folder / "a.png", whole.substr(0, n));
    EXPECT_THROW(read_image(folder / "a.png"), Error) << n << " bytes";
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  kit::spill(folder / "a.png", whole + "after the end");
  EXPECT_EQ(read_image(folder / "a.png").width, 17);
}

TEST(Images, DamageAnywhereIsAnErrorOrAPictureAndNothingIsPrinted) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.png", "a.exr", "a.hdr"}) {
    write_image(folder / name, pattern({"R", "G", "B"}));
    const std::string whole = kit::slurp(folder / name);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
      kit::spill(folder / name, damaged);
      try {
        const Image image = read_image(folder / name);
        EXPECT_EQ(image.pixels.size(),
                  static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * image.channel_count());
      } catch (const Error& e) {
        EXPECT_EQ(e.where(), folder / name) << "byte " << at;
      }
    }
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << name;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
  }
}

// PNG files made by hand: what no writer of ours makes.

std::string big_endian(std::uint32_t x) {
  return {static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8), static_cast<char>(x)};
}

std::string png_chunk(const std::string& name, const std::string& data) {
  std::uint32_t crc = ~0u;  // RFC 2083, appendix 15
  for (const char c : name + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + name + data + big_endian(~crc);
}

// A deflate stream of one stored block.
std::string zlib_stored(const std::string& data) {
  std::uint32_t a = 1, b = 0;
  for (const char c : data) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  const auto size = static_cast<std::uint16_t>(data.size());
  const auto pair = [](unsigned v) { return std::string{static_cast<char>(v), static_cast<char>(v >> 8)}; };
  return "\x78\x01\x01" + pair(size) + pair(~unsigned{size}) + data + big_endian(b << 16 | a);
}

std::string png(std::uint32_t width, std::uint32_t height, char depth, char color, const std::string& between,
                const std::string& rows) {
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", big_endian(width) + big_endian(height) + std::string{depth, color, 0, 0, 0}) +
         between + png_chunk("IDAT", zlib_stored(rows)) + png_chunk("IEND", "");
}

Image read_bytes(const std::string& bytes) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.png", bytes);
  return read_image(folder / "a.png", false);
}

TEST(Images, PngOfAFewBitsAndOfAPaletteIsExpanded) {
  const Image bits = read_bytes(png(3, 2, 1, 0, "", std::string("\0\xA0\0\x40", 4)));
  EXPECT_EQ(bits.channels, std::vector<std::string>{"Y"});
  EXPECT_EQ(bits.pixels, (std::vector<float>{1, 0, 1, 0, 1, 0}));

  const std::string palette = png_chunk("PLTE", std::string("\xFF\0\0\0\xFF\0", 6));
  const Image colors = read_bytes(png(2, 1, 8, 3, palette, std::string("\0\1\0", 3)));
  EXPECT_EQ(colors.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(colors.pixels, (std::vector<float>{0, 1, 0, 1, 0, 0}));

  const Image see_through =
      read_bytes(png(2, 1, 8, 3, palette + png_chunk("tRNS", std::string("\x33", 1)), std::string("\0\1\0", 3)));
  EXPECT_EQ(see_through.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(see_through.pixels, (std::vector<float>{0, 1, 0, 1, 1, 0, 0, 0.2f}));
}

TEST(Images, PngOfSixteenBitsAndAlpha) {
  const Image image = read_bytes(png(1, 1, 16, 4, "", std::string("\0\x33\x33\xFF\xFF", 5)));
  EXPECT_EQ(image.channels, (std::vector<std::string>{"Y", "A"}));
  EXPECT_EQ(image.pixels, (std::vector<float>{0.2f, 1}));
}

TEST(Images, ADamagedChunkBesideThePixelsIsNoNews) {
  const std::string rows("\0\x33", 2);
  std::string gamma = png_chunk("gAMA", big_endian(45455)), text = png_chunk("tEXt", std::string("a\0b", 3));
  gamma.back() ^= 1, text.back() ^= 1;
  testing::internal::CaptureStderr();
  EXPECT_EQ(read_bytes(png(1, 1, 8, 0, gamma + text + png_chunk("iCCP", "no profile"), rows)).pixels, std::vector<float>{0.2f});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Images, APngThatCannotHoldItsPixelsIsRefusedBeforeMemoryIsAskedFor) {
  try {
    read_bytes(png(65536, 65536, 16, 6, "", std::string(9, '\0')));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("65536 × 65536 pixels cannot be in"));
  }
  EXPECT_THROW(read_bytes(png(65537, 1, 1, 0, "", "\0")), Error);
}

TEST(Images, OnlyPicturesAreOffered) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.png", "P6 1 1 255 abc");  // a format that OpenImageIO reads too
  try {
    read_image(folder / "a.png");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("EXR, PNG and Radiance HDR are read"));
  }
}

}  // namespace
}  // namespace pelage
