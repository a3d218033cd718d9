// Chains of thick hairs in `.pelage` files: there and back, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/lod.h>

#include <filesystem>
#include <fstream>

#include "fuzz/readers.h"
#include "io/lod_sections.h"
#include "kit/io_kit.h"
#include "kit/lod_kit.h"

namespace pelage {
namespace {

using testing::HasSubstr;

std::string temporary(const std::string& name) { return testing::TempDir() + "lod_" + name; }

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string written() {
  const StrandSet set = kit::full_groom();
  const std::string path = temporary("whole.pelage");
  write_lod(path, set, kit::small_lod(set));
  return slurp(path);
}

LodHierarchy read_bytes(const std::string& bytes) {
  return io::read_lod(io::ByteSource("test", std::as_bytes(std::span(bytes.data(), bytes.size()))));
}

std::string refusal(const std::string& bytes) {
  try {
    read_bytes(bytes);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// The file with its checksums set right again.
std::string sealed(std::string bytes, bool belongs = true) {
  fuzz::seal(std::as_writable_bytes(std::span(bytes.data(), bytes.size())), belongs);
  return bytes;
}

/// Where a section's bytes begin.
std::size_t section(const std::string& bytes, const std::string& name) {
  for (std::size_t at = 64;; at += 40)
    if (bytes.compare(at, name.size(), name) == 0 && (name.size() == 8 || bytes[at + name.size()] == '\0')) {
      std::uint64_t offset;
      std::memcpy(&offset, bytes.data() + at + 16, sizeof offset);
      return offset;
    }
}

TEST(LodFile, KeepsEverything) {
  const StrandSet set = kit::full_groom();
  const LodHierarchy lod = kit::small_lod(set);
  const std::string path = temporary("all.pelage");
  write_lod(path, set, lod);
  const LodHierarchy back = read_lod(path);
  EXPECT_EQ(back.guide_strands, lod.guide_strands);
  EXPECT_EQ(back.guides, lod.guides);
  EXPECT_EQ(back.prisms, lod.prisms);
  EXPECT_EQ(back.order, lod.order);
  EXPECT_EQ(back.strand_weights, lod.strand_weights);
  EXPECT_EQ(back.level_offsets, lod.level_offsets);
  ASSERT_EQ(back.hair_count(), lod.hair_count());
  EXPECT_EQ(std::memcmp(back.hairs.data(), lod.hairs.data(), lod.hairs.size() * sizeof(ThickHair)), 0);
  EXPECT_EQ(back.weights, lod.weights);
  EXPECT_EQ(back.centers, lod.centers);
  EXPECT_EQ(back.major, lod.major);
  EXPECT_EQ(back.minor, lod.minor);
  EXPECT_EQ(back.major_weights, lod.major_weights);
  EXPECT_EQ(back.minor_weights, lod.minor_weights);
  EXPECT_EQ(back.radii, lod.radii);
  EXPECT_EQ(back.length_ratios, lod.length_ratios);
  EXPECT_EQ(back.twists, lod.twists);
  EXPECT_EQ(back.colors, lod.colors);
  EXPECT_EQ(back.root_uv, lod.root_uv);
  validate(back, read_strands(path), "test");
}

TEST(LodFile, StrandsAreReadAsWithoutIt) {
  const StrandSet set = kit::full_groom();
  const std::string with = temporary("with.pelage"), without = temporary("without.pelage");
  write_lod(with, set, kit::small_lod(set));
  write_strands(without, set);
  ImportReport report;
  const StrandSet a = read_strands(with, {}, &report), b = read_strands(without);
  EXPECT_THAT(report.notes, testing::IsEmpty());
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.offsets, b.offsets);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_TRUE(read_lod(without).empty());
}

TEST(LodFile, OtherFilesHaveNone) {
  const std::string path = temporary("other.hair");
  write_strands(path, kit::full_groom());
  EXPECT_TRUE(read_lod(path).empty());
}

TEST(LodFile, TruncationIsAnErrorAtEveryLength) {
  const std::string whole = written();
  ASSERT_FALSE(read_bytes(whole).empty());
  for (std::size_t n = 8; n < whole.size(); n += n < 2000 ? 1 : 61) EXPECT_NE(refusal(whole.substr(0, n)), "") << n;
}

TEST(LodFile, EveryFlippedByteIsAnErrorOrChangesNothing) {
  const std::string whole = written();
  for (std::size_t at = 0; at < whole.size(); at += 37) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    if (at < 8 || at >= 48) fuzz::read_chain(std::as_bytes(std::span(bytes.data(), bytes.size())));
    bytes = sealed(bytes);
    fuzz::read_chain(std::as_bytes(std::span(bytes.data(), bytes.size())));  // aborts where validate() does not hold
  }
}

TEST(LodFile, WhatDoesNotFitIsNamed) {
  const std::string whole = written();
  const auto with = [&](const char* name, std::size_t offset, std::uint32_t value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + section(bytes, name) + offset, &value, sizeof value);
    return refusal(sealed(bytes));
  };
  EXPECT_THAT(with("lodhead", 0, 9), HasSubstr("version 9"));
  EXPECT_THAT(with("lodhead", 12, 1000000000), HasSubstr("section lodhairs"));
  EXPECT_THAT(with("lodorder", 0, 0xffffffff), HasSubstr("permutation"));
  EXPECT_THAT(with("lodlevel", 4, 7), HasSubstr("lod"));
  EXPECT_THAT(with("lodhairs", 4, 1), HasSubstr("hairs"));
  EXPECT_THAT(with("lodhairs", 12, 2), HasSubstr("children of hair 0"));
  EXPECT_THAT(with("lodhairs", 16, 1), HasSubstr("children of hair 0"));
  EXPECT_THAT(with("lodorder", 0, 0), HasSubstr("permutation"));
  EXPECT_THAT(with("lodprism", 0, 4), HasSubstr("prisms"));
  EXPECT_THAT(with("lodguide", 0, 4000), HasSubstr("guides"));
  EXPECT_THAT(with("lodcentr", 0, 0x7fc00000), HasSubstr("not finite"));
  EXPECT_THAT(with("lodradii", 0, 0xbf800000), HasSubstr("radii"));
  EXPECT_THAT(with("lodstrnw", 0, 0x40000000), HasSubstr("shares"));
}

TEST(LodFile, OfOtherStrandsItIsRefused) {
  const StrandSet set = kit::full_groom();
  StrandSet moved = set;
  for (Vec3& p : moved.points) p.x += 0.01f;
  const std::string path = temporary("moved.pelage");
  EXPECT_THROW(write_lod(path, moved, kit::small_lod(set)), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
  std::string bytes = written();  // a point changed behind its back
  bytes[section(bytes, "points")] ^= 1;
  EXPECT_THAT(refusal(sealed(bytes, false)), HasSubstr("other strands"));
  EXPECT_THROW(write_lod(temporary("a.hair"), set, kit::small_lod(set)), Error);
}

}  // namespace
}  // namespace pelage
