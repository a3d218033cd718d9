#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <cmath>

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

}  // namespace
}  // namespace pelage
