// Animations in `.pelage` files, and head motions in JSON: there and back, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/animation.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/simulate.h>

#include <cstring>
#include <functional>

#include "fuzz/readers.h"
#include "io/lod_sections.h"
#include "kit/io_kit.h"
#include "kit/lod_kit.h"

namespace pelage {
namespace {

using testing::HasSubstr;

GuideAnimation swaying(const LodHierarchy& lod) {
  GuideAnimation a;
  a.frame_rate = 30, a.first_frame = -2;
  for (int f = 0; f < 3; ++f) {
    for (const Vec3 p : lod.guides) a.guides.push_back(p + Vec3(0.01f * static_cast<float>(f), 0, 0));
    Affine head;
    head.m[0][3] = 0.01f * static_cast<float>(f);
    a.head.push_back(head);
  }
  return a;
}

LodHierarchy animated() {
  LodHierarchy lod = kit::small_lod(kit::full_groom());
  lod.animation = std::make_shared<GuideAnimation>(swaying(lod));
  return lod;
}

std::string written(const kit::TemporaryFolder& folder) {
  write_lod(folder / "a.pelage", kit::full_groom(), animated());
  return kit::slurp(folder / "a.pelage");
}

LodHierarchy read_bytes(const std::string& bytes) {
  return io::read_lod(io::ByteSource("test", std::as_bytes(std::span(bytes.data(), bytes.size()))));
}

std::string sealed(std::string bytes, bool belongs = true) {
  fuzz::seal(std::as_writable_bytes(std::span(bytes.data(), bytes.size())), belongs);
  return bytes;
}

std::size_t section(const std::string& bytes, const std::string& name) {
  for (std::size_t at = 64;; at += 40)
    if (bytes.compare(at, 8, name) == 0) {
      std::uint64_t offset;
      std::memcpy(&offset, bytes.data() + at + 16, sizeof offset);
      return offset;
    }
}

TEST(AnimationFile, KeepsEverything) {
  const kit::TemporaryFolder folder;
  written(folder);
  const LodHierarchy lod = animated(), back = read_lod(folder / "a.pelage");
  ASSERT_TRUE(back.animation);
  EXPECT_EQ(back.animation->guides, lod.animation->guides);
  EXPECT_EQ(back.animation->frame_rate, 30);
  EXPECT_EQ(back.animation->first_frame, -2);
  ASSERT_EQ(back.animation->frames(), 3u);
  EXPECT_EQ(std::memcmp(back.animation->head.data(), lod.animation->head.data(), 3 * sizeof(Affine)), 0);
  EXPECT_EQ(back.animation->last_frame(), 0);
  EXPECT_EQ(back.centers, lod.centers);
}

TEST(AnimationFile, WhoKnowsNothingOfItSeesTheRestPose) {
  const kit::TemporaryFolder folder;
  written(folder);
  ImportReport report;
  EXPECT_EQ(read_strands(folder / "a.pelage", {}, &report).points, kit::full_groom().points);
  EXPECT_THAT(report.notes, testing::IsEmpty());
  write_lod(folder / "b.pelage", kit::full_groom(), kit::small_lod(kit::full_groom()));
  EXPECT_FALSE(read_lod(folder / "b.pelage").animation);
}

TEST(AnimationFile, WhatDoesNotFitIsNamed) {
  const kit::TemporaryFolder folder;
  const std::string whole = written(folder);
  const auto with = [&](const char* name, std::size_t offset, std::uint32_t value, bool belongs = true) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + section(bytes, name) + offset, &value, sizeof value);
    return kit::error_of([&] { read_bytes(sealed(bytes, belongs)); });
  };
  EXPECT_EQ(kit::error_of([&] { read_bytes(sealed(whole)); }), "");
  EXPECT_THAT(with("animhead", 0, 2), HasSubstr("version 2"));
  EXPECT_THAT(with("animhead", 4, 1000000000), HasSubstr("section animguid"));
  EXPECT_THAT(with("animhead", 4, 0), HasSubstr("section animguid"));
  EXPECT_THAT(with("animhead", 8, 7), HasSubstr("other guides"));
  EXPECT_THAT(with("animhead", 12, 0x7fffffff), HasSubstr("first frame"));
  EXPECT_THAT(with("animhead", 16, 0x7fc00000), HasSubstr("frames a second"));
  EXPECT_THAT(with("animhead", 24, 1, false), HasSubstr("other"));
  EXPECT_THAT(with("animguid", 16, 0x7fc00000), HasSubstr("control point 1"));
  EXPECT_THAT(with("animpose", 0, 0x40000000), HasSubstr("frame 0"));
}

TEST(AnimationFile, TruncationAndFlippedBytesNeverGetThrough) {
  const kit::TemporaryFolder folder;
  const std::string whole = written(folder);
  for (std::size_t n = 8; n < whole.size(); n += n < 2000 ? 3 : 61)
    EXPECT_NE(kit::error_of([&] { read_bytes(whole.substr(0, n)); }), "") << n;
  for (std::size_t at = 64; at < whole.size(); at += 29) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    bytes = sealed(bytes);
    fuzz::read_chain(std::as_bytes(std::span(bytes.data(), bytes.size())));  // aborts where validate() does not hold
  }
}

TEST(HeadMotionFile, ReadsKeys) {
  const kit::TemporaryFolder folder;
  kit::spill(
      folder / "m.json",
      R"({"pivot": [0, -0.1, 0], "keys": [{"time": 0}, {"time": 1, "translation": [0.1, 0, 0], "axis": [0, 2, 0], "angle": 90}]})");
  const HeadMotion motion = read_head_motion(folder / "m.json", {});
  ASSERT_EQ(motion.keys.size(), 2u);
  EXPECT_EQ(motion.pivot, Vec3(0, -0.1f, 0));
  EXPECT_EQ(motion.keys[1].translation, Vec3(0.1f, 0, 0));
  EXPECT_LT(length(transform_vector(head_at(motion, 1), {1, 0, 0}) - Vec3(0, 0, -1)), 1e-6f);
  kit::spill(folder / "m.json", R"({"keys": [{"time": 0}]})");
  EXPECT_EQ(read_head_motion(folder / "m.json", {1, 2, 3}).pivot, Vec3(1, 2, 3));
}

TEST(HeadMotionFile, MistakesAreNamed) {
  const kit::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    kit::spill(folder / "m.json", text);
    return kit::error_of([&] { read_head_motion(folder / "m.json", {}); });
  };
  EXPECT_THAT(refusal("{"), HasSubstr("m.json"));
  EXPECT_THAT(refusal("{}"), HasSubstr("no keys"));
  EXPECT_THAT(refusal(R"({"keys": [{"tme": 0}]})"), HasSubstr("time"));
  EXPECT_THAT(refusal(R"({"keys": [{"time": 1}, {"time": 1}]})"), HasSubstr("order"));
  EXPECT_THAT(refusal(R"({"keys": [{"time": 0, "axis": [0, 0, 0]}]})"), HasSubstr("axis"));
  EXPECT_THROW(read_head_motion(folder / "none.json", {}), Error);
}

}  // namespace
}  // namespace pelage
