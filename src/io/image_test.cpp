#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

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

TEST(Images, SixteenBitsAreKeptInTheirOrder) {
  const TemporaryFolder folder;
  Image image(2, 1, {"Y"});
  image.pixels = {0x1234 / 65535.f, 0xfe01 / 65535.f};
  write_image(folder / "a.png", image, true);
  EXPECT_EQ(read_image(folder / "a.png", false).pixels, image.pixels);
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

TEST(Images, ExrChannelsComeInTheirUsualOrderLayerByLayer) {
  const TemporaryFolder folder;
  Image image = pattern({"tangent.y", "id", "A", "B", "tangent.x", "R", "Z", "G", "below.A", "below.R"});
  write_image(folder / "a.exr", image, true);
  const Image back = read_image(folder / "a.exr");
  EXPECT_EQ(back.channels,
            (std::vector<std::string>{"R", "G", "B", "A", "Z", "id", "below.R", "below.A", "tangent.x", "tangent.y"}));
  const std::vector<std::size_t> from = {5, 7, 3, 2, 6, 1, 9, 8, 4, 0};
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    ASSERT_EQ(back.pixels[i], image.pixels[i / 10 * 10 + from[i % 10]]) << i;
}

TEST(Images, AnExrHeaderIsNotBelieved) {
  const TemporaryFolder folder;
  write_image(folder / "a.exr", pattern({"R", "G"}));
  const std::string whole = kit::slurp(folder / "a.exr");
  const auto expect = [&](const std::string& attribute, std::size_t byte, const std::string& value, const char* problem) {
    std::string bytes = whole;
    const std::size_t at = bytes.find(attribute);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at + attribute.size() + byte, value.size(), value);
    kit::spill(folder / "a.exr", bytes);
    try {
      read_image(folder / "a.exr");
      ADD_FAILURE() << attribute;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(problem));
    }
  };
  const std::string window("dataWindow\0box2i\0\x10\0\0\0", 21), size("screenWindowWidth\0float\0", 24);
  expect(size, 0, "\xff\xff\xff\x7f", "the header ends early");
  expect(window, 8, "\xff\xff\xff\x7f", "65536 × 65536 are read");
  expect(window, 8, std::string("\xff\xff\0\0\xff\xff\0\0", 8), "cannot be in");
  expect(window, 8, "\xff\xff\xff\xff", "0 × 5");
  // A channel of every other pixel: name, type, linearity, sampling.
  expect(std::string("G\0\1\0\0\0\0\0\0\0", 10), 0, "\2", "lower resolution");
}

TEST(Images, HdrKeepsEightBitsOfTheLargestColor) {
  const TemporaryFolder folder;
  for (const int width : {1, 7, 8, 300}) {  // in runs from 8 on
    Image image(width, 3, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] = i % 5 < 3 ? 0.3f : std::ldexp(static_cast<float>(i * 37 % 101), static_cast<int>(i % 30) - 15);
    write_image(folder / "a.hdr", image);
    const Image back = read_image(folder / "a.hdr");
    ASSERT_EQ(back.pixels.size(), image.pixels.size());
    for (std::size_t p = 0; p < image.pixels.size(); p += 3) {
      const float largest = std::max({image.pixels[p], image.pixels[p + 1], image.pixels[p + 2]});
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(back.pixels[p + c], image.pixels[p + c], largest / 128) << width << " " << p;
    }
  }
}

TEST(Images, HdrTakesWhatItCannotHold) {
  const TemporaryFolder folder;
  Image image(2, 2, {"R", "G", "B"});
  image.pixels = {NAN, -1, 1, INFINITY, 0, 1, 1e-38f, 1e-38f, 0, 3e38f, 3e38f, 1};
  write_image(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr");
  EXPECT_EQ(back.pixels[0], 0);
  EXPECT_EQ(back.pixels[1], 0);
  EXPECT_EQ(back.pixels[2], 1);
  for (const std::size_t bright : {3u, 9u, 10u}) EXPECT_NEAR(back.pixels[bright], 0x1p127f, 0x1p120f);
  for (const std::size_t dark : {4u, 5u, 6u, 7u, 8u, 11u}) EXPECT_EQ(back.pixels[dark], 0) << dark;
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
  EXPECT_THROW(read_bytes(png(65537, 1, 1, 0, "", std::string(1, '\0'))), Error);
}

// Radiance pictures made by hand: what no writer of ours makes.

Image read_hdr_text(const std::string& header, const std::string& pixels) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.hdr", "#?RADIANCE\n" + header + "\n" + pixels);
  return read_image(folder / "a.hdr");
}

TEST(Images, HdrOfWholePixelsAndTheirRepetitions) {
  const std::string pixel("\x80\x40\x20\x81", 4);  // 1, ½, ¼
  const Image flat = read_hdr_text("FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2", pixel + std::string("\0\0\x80\x82", 4));
  EXPECT_EQ(flat.pixels, (std::vector<float>{1, 0.5f, 0.25f, 0, 0, 2}));
  const Image wide = read_hdr_text("\n-Y 1 +X 700", pixel + std::string("\1\1\1\xbb\1\1\1\2", 8));  // 1 + 187 + 2·256
  for (std::size_t i = 0; i < wide.pixels.size(); ++i) ASSERT_EQ(wide.pixels[i], flat.pixels[i % 3]) << i;
}

TEST(Images, HdrExposuresAreTakenBack) {
  const std::string pixel("\x80\x40\x20\x81", 4);
  EXPECT_EQ(read_hdr_text("EXPOSURE=2\nEXPOSURE= 4\n\n-Y 1 +X 1", pixel).pixels,
            (std::vector<float>{1 / 8.f, 1 / 16.f, 1 / 32.f}));
}

TEST(Images, HdrThatLies) {
  const std::string pixel("\x80\x40\x20\x81", 4);
  const auto expect = [&](const std::string& header, const std::string& pixels, const char* problem) {
    try {
      read_hdr_text(header, pixels);
      ADD_FAILURE() << problem;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(problem));
    }
  };
  expect("\n-Y 65536 +X 65536", pixel, "cannot be in");
  expect("\n-Y 0 +X 1", pixel, "0 pixels");
  expect("\n+Y 1 +X 1", pixel, "top to bottom");
  expect("\n-Y 1 -X 1", pixel, "left to right");
  expect("FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1", pixel, "xyze");
  expect("EXPOSURE=0\n\n-Y 1 +X 1", pixel, "not positive");
  expect("\n-Y 1 +X 2", pixel + std::string("\1\1\1\2", 4), "over the end of its row");
  expect("\n-Y 1 +X 2", std::string("\1\1\1\1", 4) + pixel, "over the end of its row");
  expect("\n-Y 1 +X 9", std::string("\2\2\0\x09\x8a\5", 6), "over the end of its row");
  expect("\n-Y 1 +X 2", pixel, "ends early");
}

// A JPEG file of the library itself.
std::string jpeg(const std::vector<unsigned char>& pixels, unsigned width, int channels) {
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = width;
  jpeg.image_height = static_cast<unsigned>(pixels.size()) / width / static_cast<unsigned>(channels);
  jpeg.input_components = channels;
  jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW row =
        const_cast<JSAMPROW>(pixels.data() + std::size_t{jpeg.next_scanline} * width * static_cast<std::size_t>(channels));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  std::free(data);
  return bytes;
}

TEST(Images, JpegOfGrayAndOfColors) {
  const TemporaryFolder folder;
  for (const int channels : {1, 3}) {
    std::vector<unsigned char> pixels(static_cast<std::size_t>(24 * 10 * channels));
    for (std::size_t i = 0; i < pixels.size(); ++i)  // smooth, because colors are stored coarsely
      pixels[i] = static_cast<unsigned char>(20 * (i % static_cast<std::size_t>(channels)) +
                                             i / static_cast<std::size_t>(channels) / 2);
    kit::spill(folder / "a.jpg", jpeg(pixels, 24, channels));
    const Image image = read_image(folder / "a.jpg", false);
    EXPECT_EQ(image.width, 24);
    EXPECT_EQ(image.channels, channels == 1 ? (std::vector<std::string>{"Y"}) : (std::vector<std::string>{"R", "G", "B"}));
    ASSERT_EQ(image.pixels.size(), pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) ASSERT_NEAR(image.pixels[i] * 255, static_cast<float>(pixels[i]), 6) << i;
    EXPECT_NEAR(read_image(folder / "a.jpg").pixels[0], std::pow((image.pixels[0] + 0.055f) / 1.055f, 2.4f), 0.005f);
  }
}

TEST(Images, ACutJpegIsAnErrorAndNothingIsPrinted) {
  const TemporaryFolder folder;
  const std::string whole = jpeg(std::vector<unsigned char>(16 * 16 * 3, 77), 16, 3);
  testing::internal::CaptureStderr();
  for (std::size_t n = 0; n + 2 < whole.size(); ++n) {  // the marker of the end may be missing
    kit::spill(folder / "a.jpg", whole.substr(0, n));
    EXPECT_THROW(read_image(folder / "a.jpg"), Error) << n << " of " << whole.size() << " bytes";
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    kit::spill(folder / "a.jpg", damaged);
    try {
      read_image(folder / "a.jpg");
    } catch (const Error& e) {
      EXPECT_EQ(e.where(), folder / "a.jpg") << "byte " << at;
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  kit::spill(folder / "ink.jpg", jpeg(std::vector<unsigned char>(8 * 8 * 4, 77), 8, 4));
  EXPECT_THROW(read_image(folder / "ink.jpg"), Error);
}

TEST(Images, OnlyPicturesAreOffered) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.png", "P6 1 1 255 abc");
  try {
    read_image(folder / "a.png");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("EXR, PNG, JPEG and Radiance HDR are read"));
  }
}

}  // namespace
}  // namespace pelage
