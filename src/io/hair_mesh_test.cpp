// Hair-mesh files: there and back, cut short at every length, written by hand, and each rule broken once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <span>
#include <sstream>

#include "io/hair_mesh_formats.h"
#include "kit/hair_mesh_kit.h"
#include "kit/io_kit.h"

namespace pelage::io {
namespace {

using kit::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

HairMesh read_bytes(const std::string& bytes) { return read_hair_mesh(ByteSource("mesh", std::as_bytes(std::span(bytes)))); }

std::string error_of(const std::string& bytes) {
  return kit::error_of([&] { read_bytes(bytes); });
}

std::string written(const HairMesh& mesh, const std::string& name, const HairMeshPrecision& precision = {}) {
  const TemporaryFolder folder;
  write_hair_mesh(folder / name, mesh, precision);
  EXPECT_EQ(folder.entries(), 1u);
  return kit::slurp(folder / name);
}

void expect_same_but_vectors(const HairMesh& a, const HairMesh& b) {
  EXPECT_EQ(a.column_offsets, b.column_offsets);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.comment, b.comment);
  ASSERT_EQ(a.bundles.size(), b.bundles.size());
  for (std::size_t i = 0; i < a.bundles.size(); ++i) {
    EXPECT_EQ(a.bundles[i].columns, b.bundles[i].columns);
    EXPECT_EQ(a.bundles[i].strands, b.bundles[i].strands);
    EXPECT_EQ(a.bundles[i].style, b.bundles[i].style);
    EXPECT_EQ(a.bundles[i].seed, b.bundles[i].seed);
  }
  ASSERT_EQ(a.styles.size(), b.styles.size());
  for (std::size_t s = 0; s < a.styles.size(); ++s) {
    ASSERT_EQ(a.styles[s].size(), b.styles[s].size());
    for (std::size_t i = 0; i < a.styles[s].size(); ++i) {
      const StyleOperator &x = a.styles[s][i], &y = b.styles[s][i];
      EXPECT_EQ(x.kind, y.kind);
      EXPECT_EQ((std::array{x.amount, x.frequency, x.start, x.variation}),
                (std::array{y.amount, y.frequency, y.start, y.variation}));
    }
  }
}

float largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  float most = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, length(a[i] - b[i]));
  return most;
}

TEST(HairMeshFile, TextKeepsEveryBit) {
  HairMesh mesh = kit::two_bundles();
  mesh.positions[3] = {1.f / 3, -1e-7f, 0.1f};
  const HairMesh back = read_bytes(written(mesh, "a.json"));
  expect_same_but_vectors(back, mesh);
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.tangents, mesh.tangents);
  EXPECT_EQ(back.uvw, mesh.uvw);
  EXPECT_EQ(back.occlusion, mesh.occlusion);
}

TEST(HairMeshFile, BinaryErrsByHalfAStepAndStaysTheSameFromThen) {
  for (const bool float_positions : {false, true})
    for (const bool wide : {false, true}) {
      const HairMeshPrecision precision{float_positions, wide};
      const HairMesh mesh = kit::two_bundles(7);
      const std::string bytes = written(mesh, "a.hairmesh", precision);
      const HairMesh back = read_bytes(bytes);
      expect_same_but_vectors(back, mesh);
      const float share_step = wide ? 1.f / 65535 : 1.f / 255;
      // Half a step of the box along each axis; the largest tangent and box are 0.2 m.
      EXPECT_LE(largest_difference(back.positions, mesh.positions), float_positions ? 0.f : 0.9f * 0.2f / 65535);
      EXPECT_LE(largest_difference(back.tangents, mesh.tangents), float_positions ? 0.f : 0.9f * 0.2f / 32767);
      EXPECT_LE(largest_difference(back.uvw, mesh.uvw), 0.9f * share_step);
      for (std::size_t i = 0; i < mesh.occlusion.size(); ++i)
        EXPECT_NEAR(back.occlusion[i], mesh.occlusion[i], 0.51f * share_step);
      EXPECT_EQ(written(back, "b.hairmesh", precision), bytes);
    }
}

TEST(HairMeshFile, OptionalArraysStayAway) {
  HairMesh mesh = kit::two_bundles();
  mesh.tangents.clear(), mesh.occlusion.clear();
  for (const char* name : {"a.json", "a.hairmesh"}) {
    const HairMesh back = read_bytes(written(mesh, name));
    EXPECT_TRUE(back.tangents.empty() && back.occlusion.empty());
    EXPECT_LT(largest_difference(back.positions, mesh.positions), 5e-6f);
  }
}

TEST(HairMeshFile, FlatMeshesKeepTheirPlane) {
  HairMesh mesh = kit::two_bundles();
  for (Vec3& p : mesh.positions) p.z = 0.125f;
  for (const Vec3 p : read_bytes(written(mesh, "a.hairmesh")).positions) EXPECT_EQ(p.z, 0.125f);
}

// docs/formats.md, byte for byte: one bundle of four columns of two vertices.
std::string hand_made() {
  std::string bytes("\x89HMESH\r\n", 8);
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint16_t{1}), put(std::uint16_t{0});  // version
  put(std::uint32_t{8});                         // flags: occlusion
  for (const std::uint32_t count : {4, 8, 1, 1}) put(count);
  put(6e-5f), put(std::uint32_t{2});  // width, bytes of comment
  put(std::uint64_t{0}), put(std::uint64_t{0});
  for (int c = 0; c < 4; ++c) put(std::uint8_t{2});
  for (const float x : {-1.f, 0.f, 2.f, 1.f, 1.f, 4.f}) put(x);
  for (std::uint16_t i = 0; i < 24; ++i) put(static_cast<std::uint16_t>(i % 3 == 1 ? (i % 6 < 3 ? 65535 : 0) : 13107));
  for (std::uint8_t i = 0; i < 24; ++i) put(static_cast<std::uint8_t>(i * 10));
  for (std::uint8_t i = 0; i < 8; ++i) put(static_cast<std::uint8_t>(255 - i));
  for (const std::uint16_t column : {3, 1, 0, 2}) put(column);
  for (const std::uint32_t number : {500, 0, 9}) put(number);
  put(std::uint8_t{1}), put(std::uint8_t{4});  // a style of one operator: curl
  for (const float x : {0.01f, 5.f, 0.25f, 0.5f}) put(x);
  bytes += "hi";
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 40, &size, 8);
  const std::uint64_t checksum = hair_mesh_checksum(bytes);
  std::memcpy(bytes.data() + 48, &checksum, 8);
  return bytes;
}

TEST(HairMeshFile, ReadsBinaryWrittenByHand) {
  const HairMesh mesh = read_bytes(hand_made());
  EXPECT_EQ(mesh.column_offsets, (std::vector<std::uint32_t>{0, 2, 4, 6, 8}));
  EXPECT_FLOAT_EQ(mesh.positions[0].x, -0.6f);  // a fifth of the way from −1 to 1
  EXPECT_EQ(mesh.positions[0].y, 1);
  EXPECT_EQ(mesh.positions[1].y, 0);
  EXPECT_FLOAT_EQ(mesh.positions[0].z, 2.4f);
  EXPECT_FLOAT_EQ(mesh.uvw[1].y, 40.f / 255);
  EXPECT_FLOAT_EQ(mesh.occlusion[5], 250.f / 255);
  EXPECT_EQ(mesh.bundles[0].columns, (std::array<std::uint32_t, 4>{3, 1, 0, 2}));
  EXPECT_EQ(mesh.bundles[0].strands, 500u);
  EXPECT_EQ(mesh.bundles[0].seed, 9u);
  EXPECT_EQ(mesh.styles[0][0].kind, StyleOperator::Kind::kCurl);
  EXPECT_EQ(mesh.styles[0][0].frequency, 5);
  EXPECT_EQ(mesh.width, 6e-5f);
  EXPECT_EQ(mesh.comment, "hi");
}

constexpr const char* kText = R"(
 {"hair_mesh": 1,
  "styles": [[{"kind": "wave", "amount": 0.01, "frequency": 3}]],
  "columns": [
    {"positions": [[0, 0, 0], [0, -1, 0]], "uvw": [[0, 0, 0], [0, 0, 1]]},
    {"positions": [[1, 0, 0], [1, -1, 0]], "uvw": [[1, 0, 0], [1, 0, 1]]},
    {"positions": [[1, 0, 1], [1, -1, 1]], "uvw": [[1, 1, 0], [1, 1, 1]]},
    {"positions": [[0, 0, 1], [0, -1, 1]], "uvw": [[0, 1, 0], [0, 1, 1]]}],
  "bundles": [{"columns": [0, 1, 2, 3], "strands": 12}]}
)";

std::string text_with(const std::string& from, const std::string& to) {
  std::string text = kText;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(HairMeshFile, ReadsTextWrittenByHand) {
  const HairMesh mesh = read_bytes(kText);
  EXPECT_EQ(mesh.column_count(), 4u);
  EXPECT_EQ(mesh.positions[5], Vec3(1, -1, 1));
  EXPECT_EQ(mesh.bundles[0].strands, 12u);
  EXPECT_EQ(mesh.styles[0][0].frequency, 3);
  EXPECT_TRUE(mesh.tangents.empty() && mesh.occlusion.empty());
  EXPECT_EQ(mesh.width, HairMesh().width);
}

TEST(HairMeshFile, TextErrorsNameLineAndKey) {
  EXPECT_THAT(error_of(text_with("\"frequency\"", "\"frequenzy\"")),
              AllOf(HasSubstr("line 3: /styles/0/0/frequenzy"), HasSubstr("did you mean `frequency`")));
  EXPECT_THAT(error_of(text_with("\"wave\"", "\"waves\"")), AllOf(HasSubstr("line 3"), HasSubstr("did you mean `wave`")));
  EXPECT_THAT(error_of(text_with("[[1, 0, 1]", "[[1, 0]")), AllOf(HasSubstr("line 7"), HasSubstr("3 numbers")));
  EXPECT_THAT(error_of(text_with("[[1, 0, 1]", "[[1, 0, 1e30]")),
              AllOf(HasSubstr("line 7: /columns/2/positions/0/2"), HasSubstr("out of range")));
  EXPECT_THAT(error_of(text_with("[[1, 0, 1]", "[[1, 0, \"x\"]")), AllOf(HasSubstr("line 7"), HasSubstr("a number")));
  EXPECT_THAT(error_of(text_with("[1, 1, 1]", "[1, 1, 1.5]")),
              AllOf(HasSubstr("line 7: /columns/2/uvw/1"), HasSubstr("out of range")));
  EXPECT_THAT(error_of(text_with("[0, 1, 2, 3]", "[0, 1, 2]")), HasSubstr("line 9: /bundles/0/columns: 3 columns"));
  EXPECT_THAT(error_of(text_with("\"strands\": 12", "\"strands\": 0")), HasSubstr("line 9: /bundles/0/strands"));
  EXPECT_THAT(error_of(text_with(", \"strands\": 12", "")), HasSubstr("`strands` is missing"));
  EXPECT_THAT(error_of(text_with("\"hair_mesh\": 1", "\"hair_mesh\": 2")), HasSubstr("use a newer Pelage"));
  EXPECT_THAT(error_of(text_with("{\"positions\": [[1, 0, 1], ", "{\"occlusion\": [1, 1], \"positions\": [[1, 0, 1], ")),
              HasSubstr("/columns/2/occlusion: 2 of them where 0"));
  EXPECT_THAT(error_of(text_with("[[1, 1, 0], ", "[")), HasSubstr("/columns/2/uvw: 1 of them where 2"));
  EXPECT_THAT(error_of(text_with("]}\n", "")), HasSubstr("parse error"));
}

TEST(HairMeshFile, TextThatIsSomethingElseIsNoHairMesh) {
  EXPECT_THAT(error_of(""), HasSubstr("an empty file"));
  EXPECT_THAT(error_of(R"({"camera": {}})"), HasSubstr("not a hair mesh"));
  EXPECT_THAT(error_of("hair"), HasSubstr("not a hair mesh"));
}

TEST(HairMeshFile, CutShortAtEveryLengthIsAnError) {
  for (const std::string& bytes : {hand_made(), written(kit::two_bundles(), "a.hairmesh")})
    for (std::size_t n = 0; n < bytes.size(); ++n) ASSERT_NE(error_of(bytes.substr(0, n)), "") << n;
  const std::string text = written(kit::two_bundles(), "a.json");
  for (std::size_t n = 0; n + 2 < text.size(); ++n) ASSERT_NE(error_of(text.substr(0, n)), "") << n;  // "}\n" ends it
}

// A binary file with right size and checksum whatever was done to it.
std::string sealed(std::string bytes) {
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 40, &size, 8);
  const std::uint64_t checksum = hair_mesh_checksum(bytes);
  std::memcpy(bytes.data() + 48, &checksum, 8);
  return bytes;
}

TEST(HairMeshFile, CutShortAndSealedAgainIsAnErrorToo) {
  const std::string bytes = hand_made();
  for (std::size_t n = 56; n < bytes.size(); ++n) ASSERT_NE(error_of(sealed(bytes.substr(0, n))), "") << n;
  EXPECT_THAT(error_of(sealed(bytes + "x")), HasSubstr("1 bytes too many"));
}

TEST(HairMeshFile, CountsThatTheFileCannotHoldAreRefusedBeforeAllocation) {
  for (const std::size_t at : {16, 20, 24, 28, 36})
    for (const std::uint32_t count : {1u << 20, 0xffffffffu}) {
      std::string bytes = hand_made();
      std::memcpy(bytes.data() + at, &count, 4);
      EXPECT_NE(error_of(sealed(bytes)), "") << at << ' ' << count;
    }
}

TEST(HairMeshFile, EveryChangedByteIsNoticed) {
  const std::string bytes = hand_made();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    EXPECT_NE(error_of(changed), "") << i;
  }
}

TEST(HairMeshFile, BrokenRulesAreNamedOnReadingAndNothingIsWritten) {
  const std::pair<const char*, std::function<void(HairMesh&)>> kBroken[] = {
      {"style", [](HairMesh& m) { m.bundles[1].style = 2; }},
      {"column 6", [](HairMesh& m) { m.bundles[0].columns[2] = 6; }},
      {"strands", [](HairMesh& m) { m.bundles[0].strands = HairMesh::kMaxStrands + 1; }},
      {"width", [](HairMesh& m) { m.width = 0.2f; }},
      {"frequency", [](HairMesh& m) { m.styles[0][1].frequency = 2.5f; }},
      {"twice", [](HairMesh& m) { m.styles[0][1] = m.styles[0][0]; }},
  };
  for (const auto& [what, damage] : kBroken) {
    HairMesh mesh = kit::two_bundles();
    damage(mesh);
    const TemporaryFolder folder;
    EXPECT_THROW(write_hair_mesh(folder / "a.hairmesh", mesh), Error) << what;
    EXPECT_EQ(folder.entries(), 0u);
    // Past the writer's own check, as a damaged or hostile file would come.
    AtomicFile file(folder / "b");
    write_hair_mesh_binary(file, mesh, {});
    file.commit();
    EXPECT_THAT(error_of(kit::slurp(folder / "b")), HasSubstr(what));
  }
}

TEST(HairMeshFile, UnknownExtensionsAndPlaces) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_hair_mesh(folder / "a.pelage", kit::two_bundles()), Error);
  EXPECT_THROW(write_hair_mesh(folder / "none/a.hairmesh", kit::two_bundles()), Error);
  EXPECT_THROW(pelage::read_hair_mesh(folder / "absent"), Error);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(HairMeshFile, PublishedSchemaIsThatOfTheReader) {
  std::ifstream file(PELAGE_SOURCE_DIR "/docs/hair_mesh.schema.json");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), hair_mesh_schema()) << "make it again: pelage grow --hair-mesh-schema > docs/hair_mesh.schema.json";
}

}  // namespace
}  // namespace pelage::io
