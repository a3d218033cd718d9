// Every groom format: there and back, cut short at every length, lying about its sizes, in any unit.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>

#include "io/strand_registry.h"
#include "kit/io_kit.h"

namespace pelage::io {
namespace {

using kit::TemporaryFolder;

StrandSet read_bytes(const std::string& bytes, const ImportOptions& options = {}, ImportReport* report = nullptr) {
  return read_strands(ByteSource("groom", std::as_bytes(std::span(bytes))), options, report);
}

std::string error_of(const std::string& bytes) {
  return kit::error_of([&] { read_bytes(bytes); });
}

std::string written(const StrandSet& set, const std::string& format, std::vector<std::string>* lost = nullptr) {
  const TemporaryFolder folder;
  const std::vector<std::string> sentences = write_strands(folder / "groom", set, format);
  if (lost) *lost = sentences;
  EXPECT_EQ(folder.entries(), 1u);
  return kit::slurp(folder / "groom");
}

std::vector<std::string> writable_formats() {
  std::vector<std::string> names;
  for (const FormatInfo& info : strand_formats())
    if (info.writes) names.push_back(info.name);
  return names;
}

template <class T>
void poke(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// A TressFX 3 file by hand: no writer makes one.
std::string tressfx3() {
  std::string bytes(296, '\0');
  poke(bytes, 0, 3.f), poke(bytes, 4, 2u), poke(bytes, 8, 3u), poke(bytes, 12, 4u), poke(bytes, 144, 296u);
  for (int i = 0; i < 6; ++i) {
    const float p[3] = {0.1f * static_cast<float>(i), 0.2f, 0.3f};
    bytes.append(reinterpret_cast<const char*>(p), sizeof p);
  }
  return bytes;
}

TEST(Strands, PelageKeepsEverythingBitForBit) {
  for (const bool point_colors : {true, false}) {
    StrandSet set = kit::full_groom(point_colors);
    for (const bool uniform : {true, false}) {
      if (!uniform) {
        set.offsets = {0, 2, 9, 12};
      }
      std::vector<std::string> lost;
      ImportReport report;
      const StrandSet back = read_bytes(written(set, "pelage", &lost), {}, &report);
      EXPECT_TRUE(lost.empty());
      EXPECT_EQ(report.format, "pelage");
      EXPECT_FALSE(report.scale_guessed || report.up_guessed || report.width_guessed);
      EXPECT_EQ(back.points, set.points);
      EXPECT_EQ(back.offsets, set.offsets);
      EXPECT_EQ(back.widths, set.widths);
      EXPECT_EQ(back.colors, set.colors);
      EXPECT_EQ(back.transparency, set.transparency);
      EXPECT_EQ(back.root_uv, set.root_uv);
      EXPECT_EQ(back.strand_id, set.strand_id);
      EXPECT_EQ(back.guide_id, set.guide_id);
      EXPECT_EQ(back.group, set.group);
      EXPECT_EQ(back.basis, set.basis);
      EXPECT_EQ(back.comment, set.comment);
    }
  }
}

TEST(Strands, PelageKeepsEveryBasisAndABareGroom) {
  for (const CurveBasis basis : {CurveBasis::kLinear, CurveBasis::kCatmullRom, CurveBasis::kBSpline, CurveBasis::kBezier}) {
    StrandSet set;
    set.points = kit::full_groom().points;
    set.offsets = {0, 4, 8, 12};
    set.widths = {7e-5f};
    set.basis = basis;
    const StrandSet back = read_bytes(written(set, "pelage"));
    EXPECT_EQ(back.basis, basis);
    EXPECT_EQ(back.widths, set.widths);
    EXPECT_TRUE(back.colors.empty() && back.root_uv.empty() && back.strand_id.empty());
  }
}

TEST(Strands, CyHairKeepsWhatItCanHold) {
  StrandSet set = kit::full_groom();
  set.offsets = {0, 2, 9, 12};
  std::vector<std::string> lost;
  ImportReport report;
  const StrandSet back = read_bytes(written(set, "cyhair", &lost), {}, &report);
  EXPECT_EQ(back.points, set.points) << "Y up to Z up and back changes signs only";
  EXPECT_EQ(back.offsets, set.offsets);
  EXPECT_EQ(back.widths, set.widths);
  EXPECT_EQ(back.colors, set.colors);
  EXPECT_EQ(back.transparency, set.transparency);
  EXPECT_EQ(back.comment, set.comment);
  EXPECT_EQ(report.scale, 1);
  EXPECT_FALSE(report.scale_guessed || report.up_guessed);
  EXPECT_EQ(lost.size(), 4u) << "root uv, strand ids, guide ids, groups";
}

TEST(Strands, CyHairRepeatsStrandColorsForEveryPoint) {
  const StrandSet set = kit::full_groom(false);
  const StrandSet back = read_bytes(written(set, "cyhair"));
  ASSERT_EQ(back.colors.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(back.colors[i], set.colors[i / 4]);
}

TEST(Strands, TressFxKeepsWhatItCanHold) {
  const StrandSet set = kit::full_groom();
  std::vector<std::string> lost;
  ImportOptions meters;
  meters.scale = 1;
  const std::string bytes = written(set, "tressfx", &lost);
  const StrandSet back = read_bytes(bytes, meters);
  EXPECT_EQ(back.points, set.points);
  EXPECT_EQ(back.offsets, set.offsets);
  EXPECT_EQ(back.colors, set.colors);
  EXPECT_EQ(back.root_uv, set.root_uv);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(back.widths[i], set.widths[i / 4 * 4]) << "the width of the root";
  EXPECT_NE(std::find(lost.begin(), lost.end(), ".tfx cannot hold widths that vary along a strand"), lost.end());
  float mass[4];
  for (std::size_t i = 0; i < 4; ++i) std::memcpy(&mass[i], bytes.data() + 160 + 16 * i + 12, 4);
  EXPECT_EQ(mass[0] + mass[1], 0) << "the first two points are held";
  EXPECT_EQ(mass[2] * mass[3], 1);
}

TEST(Strands, TressFxRefusesStrandsOfDifferentCounts) {
  StrandSet set = kit::full_groom();
  set.offsets = {0, 2, 9, 12};
  const TemporaryFolder folder;
  EXPECT_THROW(write_strands(folder / "a.tfx", set), Error);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Strands, TressFx3IsRead) {
  ImportReport report;
  const StrandSet set = read_bytes(tressfx3(), {}, &report);
  EXPECT_EQ(report.format, "tressfx3");
  EXPECT_EQ(set.strand_count(), 2u);
  EXPECT_EQ(set.points[5], Vec3(0.1f * 5, 0.2f, 0.3f));
  EXPECT_NE(report.notes.at(0).find("4 more strands"), std::string::npos);
}

TEST(Strands, UscKeepsPointsAndCounts) {
  StrandSet set = kit::full_groom();
  set.offsets = {0, 2, 9, 12};
  ImportOptions meters;
  meters.scale = 1;
  const StrandSet back = read_bytes(written(set, "usc"), meters);
  EXPECT_EQ(back.points, set.points);
  EXPECT_EQ(back.offsets, set.offsets);
}

TEST(Strands, UscSkipsBaldRootsAndKeepsTheNumbering) {
  std::string bytes;
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::int32_t{4});
  for (const std::int32_t m : {1, 3, 1, 2}) {
    put(m);
    for (std::int32_t i = 0; i < m; ++i) put(Vec3(0.1f * static_cast<float>(m), 1.5f + 0.1f * static_cast<float>(i), 0));
  }
  ImportReport report;
  const StrandSet set = read_bytes(bytes, {}, &report);
  EXPECT_EQ(report.format, "usc");
  EXPECT_EQ(set.offsets, (std::vector<std::uint32_t>{0, 3, 5}));
  EXPECT_EQ(set.strand_id, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_TRUE(report.repairs.clean());
  EXPECT_EQ(report.notes.at(0).substr(0, 12), "2 bald roots");
}

TEST(Strands, EveryTruncationIsAnErrorThatNamesThePlace) {
  constexpr const char* kPlaces[] = {"byte", "strand", "section", "header"};
  StrandSet set = kit::full_groom();
  for (const bool uniform : {true, false}) {
    if (!uniform) set.offsets = {0, 2, 9, 12};
    for (const std::string& format : writable_formats()) {
      if (format == "tressfx" && !uniform) continue;
      const std::string whole = written(set, format);
      ASSERT_EQ(error_of(whole), "") << format;
      for (std::size_t n = 0; n < whole.size(); ++n) {
        const std::string message = error_of(whole.substr(0, n));
        ASSERT_NE(message, "") << format << " of " << n << " bytes was accepted";
        ASSERT_EQ(message.substr(0, 7), "groom: ");
        const bool placed = std::any_of(std::begin(kPlaces), std::end(kPlaces),
                                        [&](const char* place) { return message.find(place) != std::string::npos; });
        ASSERT_TRUE(placed || n < 8) << message;
      }
    }
  }
  const std::string whole = tressfx3();
  for (std::size_t n = 0; n < whole.size(); ++n) ASSERT_NE(error_of(whole.substr(0, n)), "") << n;
}

// No damage is accepted in silence: the checksums see every byte but the padding.
TEST(Strands, PelageNoticesEveryDamagedByte) {
  const std::string whole = written(kit::full_groom(), "pelage");
  std::size_t unnoticed = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    if (error_of(damaged).empty()) {
      ++unnoticed;
      EXPECT_EQ(whole[i], '\0') << "byte " << i;
    }
  }
  EXPECT_LT(unnoticed, 64u * 10) << "padding between sections only";
  std::string damaged = whole;
  damaged[damaged.size() - 1] ^= 1;
  EXPECT_NE(error_of(damaged).find("section comment at byte"), std::string::npos) << error_of(damaged);
}

TEST(Strands, HugeCountsAreErrorsNotAllocations) {
  std::string hair = written(kit::full_groom(), "cyhair");
  poke(hair, 4, 0x80000000u);
  EXPECT_NE(error_of(hair).find("segment counts"), std::string::npos) << error_of(hair);
  poke(hair, 8, 0xFFFFFFFFu), poke(hair, 12, 2u), poke(hair, 16, 1u);
  EXPECT_NE(error_of(hair).find("do not make"), std::string::npos) << error_of(hair);
  std::string tfx = written(kit::full_groom(), "tressfx");
  poke(tfx, 4, 0x80000000u);
  EXPECT_NE(error_of(tfx).find("more than 2^32 points"), std::string::npos) << error_of(tfx);
  poke(tfx, 8, 1u);
  EXPECT_NE(error_of(tfx).find("point array of 34359738368 bytes expected"), std::string::npos) << error_of(tfx);
  poke(tfx, 8, 0u);
  EXPECT_NE(error_of(tfx).find("of 0 points"), std::string::npos) << error_of(tfx);
  std::string usc = written(kit::full_groom(), "usc");
  poke(usc, 0, std::int32_t{0x7FFFFFFF});
  EXPECT_NE(error_of(usc).find("2147483647 strands announced"), std::string::npos) << error_of(usc);
  poke(usc, 0, std::int32_t{-1});
  EXPECT_NE(error_of(usc), "");
}

TEST(Strands, CyHairExplainsWhatDisagrees) {
  const std::string whole = written(kit::full_groom(), "cyhair");
  const auto broken = [&](std::size_t at, auto value) {
    std::string bytes = whole;
    poke(bytes, at, value);
    return error_of(bytes);
  };
  EXPECT_NE(broken(12, 1u).find("no point array"), std::string::npos);
  EXPECT_NE(broken(8, 11u).find("strand 2: 4 points announced, 3 present"), std::string::npos) << broken(8, 11u);
  EXPECT_NE(broken(128, std::uint16_t{1}).find("10 points, the header says 12"), std::string::npos);
  std::string longer = whole + "tail";
  ImportReport report;
  read_bytes(longer, {}, &report);
  EXPECT_EQ(report.notes.at(0), "4 bytes after the last array were ignored");
}

// Flags 0x12: points and colors, no segment array; every strand takes the default count.
TEST(Strands, CyHairWithoutSegmentArray) {
  const StrandSet set = kit::full_groom();
  std::string bytes = written(set, "cyhair");
  poke(bytes, 12, 2u | 16u), poke(bytes, 16, 3u);
  bytes.erase(128 + 6 + 12 * 12, 8 * 12);  // thickness and transparency
  bytes.erase(128, 6);                     // segments
  poke(bytes, 20, 1.0f);                   // a default thickness that nobody set
  ImportReport report;
  ImportOptions options;
  options.default_width = 8e-5f;
  const StrandSet back = read_bytes(bytes, options, &report);
  EXPECT_EQ(back.offsets, set.offsets);
  EXPECT_EQ(back.colors, set.colors);
  EXPECT_FALSE(report.width_guessed);
  EXPECT_EQ(back.widths, std::vector<float>{8e-5f});
  read_bytes(bytes, {}, &report);
  EXPECT_TRUE(report.width_guessed);
}

// Strands of a sparse groom stand for several; those of a full one are human hair. 0.1 m of strand each, in a box of 0.2 m.
TEST(Strands, WidthsAreGuessedSoThatFewStrandsCover) {
  const auto guessed = [](int strands) {
    StrandSet set;
    set.offsets.push_back(0);
    for (int i = 0; i < strands; ++i) {
      const float x = 0.2f * static_cast<float>(i % 50) / 49, z = 0.2f * static_cast<float>(i / 50 % 50) / 49;
      const float y = 0.1f * static_cast<float>(i % 2);
      set.points.insert(set.points.end(), {{x, y + 0.1f, z}, {x, y, z}});
      set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
    }
    set.widths = {0};
    set.basis = CurveBasis::kLinear;
    const std::string bytes = written(set, "usc");  // holds no widths
    return read_bytes(bytes).width(0);
  };
  EXPECT_FLOAT_EQ(guessed(100), 8e-4f);
  EXPECT_NEAR(guessed(5000), 0.24f / 500, 2e-5f);
  EXPECT_FLOAT_EQ(guessed(50000), 8e-5f);
}

TEST(Strands, CyHairOfOtherProgramsIsTakenAsZUpUnlessItHangsAlongY) {
  for (const bool z_up : {true, false}) {
    StrandSet set;
    set.offsets = {0, 2, 4};
    set.points = {{0, 0, 0}, {0.01f, -0.2f, 0.02f}, {0.1f, 0, 0.1f}, {0.1f, -0.3f, 0.1f}};
    set.widths = {8e-5f};
    std::string bytes = written(set, "cyhair");
    std::memset(bytes.data() + 40, 0, 88);  // without our note
    if (!z_up) std::memcpy(bytes.data() + 128 + 4, set.points.data(), 48);
    ImportReport report;
    const StrandSet back = read_bytes(bytes, {}, &report);
    EXPECT_EQ(report.up, z_up ? UpAxis::kZ : UpAxis::kY);
    EXPECT_TRUE(report.up_guessed && report.scale_guessed);
    EXPECT_EQ(back.points, set.points);
  }
}

TEST(Strands, ScaleIsGuessedFromTheSizeAndCanBeGiven) {
  const auto report_of = [](float size, ImportOptions options = {}) {
    StrandSet set;
    set.offsets = {0, 2, 4};
    set.points = {{0, 0, 0}, {size, 0, 0}, {0, 0, 0}, {0, -size, 0}};
    set.widths = {1e-4f * size};
    ImportReport report;
    const StrandSet back = read_bytes(written(set, "tressfx"), options, &report);
    EXPECT_FLOAT_EQ(back.points[1].x, size * report.scale);
    EXPECT_FLOAT_EQ(back.widths[0], 1e-4f * size * report.scale) << "widths are scaled with the points";
    return report;
  };
  EXPECT_EQ(report_of(0.3f).scale, 1);
  EXPECT_EQ(report_of(30).scale, 0.01f);
  EXPECT_EQ(report_of(400).scale, 0.001f);
  EXPECT_TRUE(report_of(30).scale_guessed);
  ImportOptions inches;
  inches.scale = 0.0254f;
  EXPECT_EQ(report_of(12, inches).scale, 0.0254f);
  EXPECT_FALSE(report_of(12, inches).scale_guessed);
}

TEST(Strands, AGuessIgnoresStrayPoints) {
  StrandSet set;
  set.offsets = {0};
  for (int s = 0; s < 400; ++s) {
    set.points.emplace_back(0.001f * static_cast<float>(s), 0, 0);
    set.points.emplace_back(0.001f * static_cast<float>(s), -0.2f, 0);
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  set.points[7] = {1e9f, 1e9f, 1e9f};
  set.widths = {8e-5f};
  std::string bytes = written(set, "tressfx");
  poke(bytes, 160 + 16 * 3, std::numeric_limits<float>::quiet_NaN());
  ImportReport report;
  const StrandSet back = read_bytes(bytes, {}, &report);
  EXPECT_EQ(report.scale, 1);
  EXPECT_EQ(report.repairs.non_finite_points, 1u);
  EXPECT_EQ(back.strand_count(), 399u) << "one strand fell, not the groom";
}

TEST(Strands, WidthsAreCheckedForSense) {
  StrandSet set = kit::full_groom();
  for (float& width : set.widths) width = 0.05f;
  ImportReport report;
  read_bytes(written(set, "cyhair"), {}, &report);
  EXPECT_NE(report.notes.at(0).find("50 mm wide"), std::string::npos);
  EXPECT_FALSE(report.width_guessed);
}

TEST(Strands, BadOptionsAreErrors) {
  const std::string bytes = written(kit::full_groom(), "pelage");
  for (const float scale : {-1.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ImportOptions options;
    options.scale = scale;
    EXPECT_THROW(read_bytes(bytes, options), Error) << scale;
  }
}

TEST(Strands, ContentDecidesNotTheExtension) {
  const TemporaryFolder folder;
  for (const std::string& format : writable_formats()) {
    write_strands(folder / "groom.png", kit::full_groom(), format);
    ImportReport report;
    pelage::read_strands(folder / "groom.png", {}, &report);
    EXPECT_EQ(report.format, format);
  }
}

TEST(Strands, ForeignFilesAreNamed) {
  const std::pair<std::string, const char*> files[] = {
      {"Ogawa\xff", "Alembic"},
      {"\x89HDF\r\n\x1a\n", "HDF5"},
      {"PXR-USDC", "USD crate"},
      {"#usda 1.0", "USD text"},
      {std::string("PK\x03\x04") + std::string(8, 'x'), "npz"},
      {std::string("\x02\0\0\0\x04\0\0\0\x02\0\x02\0", 12) + std::string(48, 'x'), "MonoHair"},
      {std::string("\x01\0\0\0\x02\0\0\0", 8) + std::string(56, 'x'), "CT2Hair"},
  };
  for (const auto& [bytes, name] : files) EXPECT_NE(error_of(bytes).find(name), std::string::npos) << error_of(bytes);
  const std::string unknown = error_of("hello, world");
  for (const FormatInfo& info : strand_formats())
    EXPECT_NE(unknown.find(info.name + ": "), std::string::npos) << "what was tried and why not: " << unknown;
}

TEST(Strands, MisuseOfFiles) {
  const TemporaryFolder folder;
  const auto message = [](const std::string& path) -> std::string {
    try {
      pelage::read_strands(path);
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  };
  EXPECT_NE(message(folder / "absent.hair").find("no such file"), std::string::npos);
  EXPECT_NE(message(folder.path()).find("a directory"), std::string::npos);
  EXPECT_NE(message("/dev/null").find("not a regular file"), std::string::npos);
  kit::spill(folder / "empty.hair", "");
  EXPECT_NE(message(folder / "empty.hair").find("an empty file"), std::string::npos);
  std::string none = written(kit::full_groom(), "cyhair");
  poke(none, 4, 0u), poke(none, 8, 0u);
  kit::spill(folder / "none.hair", none);
  EXPECT_NE(message(folder / "none.hair").find("0 strands"), std::string::npos);
  EXPECT_THROW(write_strands(folder / "a.pelage", StrandSet()), Error);
  EXPECT_THROW(write_strands(folder / "a.xyz", kit::full_groom()), Error);
  EXPECT_THROW(write_strands(folder / "a.hair", kit::full_groom(), "nonsense"), Error);
  StrandSet broken = kit::full_groom();
  broken.points[3].x = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_strands(folder / "a.hair", broken), Error);
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Strands, ProgressIsToldAndCanCancel) {
  const TemporaryFolder folder;
  double last = -1;
  std::string stage;
  const Progress listen = [&](std::string_view name, double share) {
    if (name != stage) stage = name, last = -1;
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1);
    last = share;
    return true;
  };
  for (const std::string& format : writable_formats()) {
    stage.clear();
    write_strands(folder / "a", kit::full_groom(), format, listen);
    EXPECT_EQ(last, 1);
    pelage::read_strands(folder / "a", {}, nullptr, listen);
    EXPECT_EQ(last, 1);
  }
  const Progress cancel = [](std::string_view, double) { return false; };
  EXPECT_THROW(write_strands(folder / "b.hair", kit::full_groom(), "", cancel), Error);
  EXPECT_THROW(pelage::read_strands(folder / "a", {}, nullptr, cancel), Error);
  EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace pelage::io
