#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/hair_mesh.h>
#include <pelage/runtime.h>

#include <cmath>
#include <functional>
#include <string>

#include "kit/test_hair_mesh.h"

namespace pelage {
namespace {

using Kind = StyleOperator::Kind;
using testing::every_operator;
using testing::small_hair_mesh;

TEST(HairMesh, ExpandsToASoundGroom) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  const StrandSet set = expand(mesh, {.points = 33});
  validate(set, "expanded");
  EXPECT_EQ(set.strand_count(), strand_count(mesh));
  EXPECT_EQ(set.point_count(), set.strand_count() * 33);
  EXPECT_EQ(set.strand_id[41], 41u);
}

TEST(HairMesh, SameBitsForAnyNumberOfThreads) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  set_thread_count(1);
  const StrandSet one = expand(mesh);
  set_thread_count(3);
  const StrandSet three = expand(mesh);
  set_thread_count(0);
  EXPECT_TRUE(one.points == three.points && one.widths == three.widths && one.root_uv == three.root_uv);
}

// A coarser level of detail is a prefix of every bundle: no strand moves or changes its number.
TEST(HairMesh, AShareIsAPrefix) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  const StrandSet full = expand(mesh, {.points = 9}), some = expand(mesh, {.points = 9, .share = 0.25f});
  EXPECT_EQ(some.strand_count(), 4u * 10);
  for (std::size_t s = 0; s < some.strand_count(); ++s)
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(some.points[s * 9 + i], full.points[some.strand_id[s] * 9 + i]);
}

void expect_in_box(const HairMesh& mesh) {
  const Bounds box = bounds(mesh);
  for (const std::uint32_t count : {2u, 9u, 17u, 127u}) {
    const Bounds points = bounds(expand(mesh, {.points = count}));
    EXPECT_TRUE(box.lower.x <= points.lower.x && box.lower.y <= points.lower.y && box.lower.z <= points.lower.z) << count;
    EXPECT_TRUE(box.upper.x >= points.upper.x && box.upper.y >= points.upper.y && box.upper.z >= points.upper.z) << count;
    EXPECT_LT(length(box.extent()), 2.5f * length(points.extent()));
  }
}

TEST(HairMesh, ItsBoxHoldsEveryPoint) {
  const std::vector<StyleOperator> longer{{Kind::kLength, 2, 0, 0, 0.2f}}, turned{{Kind::kCurl, 0.03f, 3, 0, 0}};
  for (const auto& style : {{}, every_operator(), longer, turned}) {
    SCOPED_TRACE(style.empty() ? "plain" : style_operator_names()[static_cast<std::size_t>(style[0].kind)]);
    expect_in_box(small_hair_mesh(style));
  }
}

// Points stand outside of bends: those of the cage, and those of a braid's locks.
TEST(HairMesh, ItsBoxHoldsTheBends) {
  for (const bool braided : {false, true}) {
    HairMesh mesh = small_hair_mesh({});
    if (braided) mesh.styles[0] = {{Kind::kBraid, 1, 3, 0, 0}};
    for (std::size_t c = 0; !braided && c + 1 < mesh.column_offsets.size(); ++c)
      for (std::uint32_t i = mesh.column_offsets[c]; i < mesh.column_offsets[c + 1]; ++i)
        mesh.positions[i].x += (i - mesh.column_offsets[c]) % 2 == 0 ? 0.05f : -0.05f;
    expect_in_box(mesh);
  }
}

TEST(HairMesh, NamesEveryBrokenRule) {
  struct Case {
    const char* said;
    std::function<void(HairMesh&)> spoil;
  };
  const auto with = [](StyleOperator o) { return [o](HairMesh& m) { m.styles[0] = {o}; }; };
  const std::vector<Case> cases{
      {"columns: there are none", [](HairMesh& m) { m.column_offsets.clear(); }},
      {"the first is 1", [](HairMesh& m) { m.column_offsets[0] = 1; }},
      {"column 1: its offset lies after", [](HairMesh& m) { m.column_offsets[2] = 3; }},
      {"column 0: 1 layers", [](HairMesh& m) { m.column_offsets[1] = 1; }},
      {"but there are", [](HairMesh& m) { m.positions.pop_back(); }},
      {"tangents: 1 entries", [](HairMesh& m) { m.tangents.resize(1); }},
      {"uvw: 3 entries", [](HairMesh& m) { m.uvw.resize(3); }},
      {"occlusion: 2 entries", [](HairMesh& m) { m.occlusion.resize(2); }},
      {"positions[4]", [](HairMesh& m) { m.positions[4].y = NAN; }},
      {"uvw[3]", [](HairMesh& m) { m.uvw[3].z = 1.5f; }},
      {"occlusion[2]", [](HairMesh& m) { m.occlusion[2] = -0.1f; }},
      {"width", [](HairMesh& m) { m.width = INFINITY; }},
      {"bundles: there are none", [](HairMesh& m) { m.bundles.clear(); }},
      {"bundle 2: column 900", [](HairMesh& m) { m.bundles[2].columns[3] = 900; }},
      {"bundle 0: 0 strands", [](HairMesh& m) { m.bundles[0].strands = 0; }},
      {"bundle 1: style 4", [](HairMesh& m) { m.bundles[1].style = 4; }},
      {"style 0: length: amount", with({Kind::kLength, 0.01f, 0, 0, 0})},
      {"style 0: clump: frequency 2.5", with({Kind::kClump, 0.5f, 2.5f, 0, 0})},
      {"style 0: curl: amount", with({Kind::kCurl, 0.2f, 5, 0, 0})},
      {"style 0: wave: start", with({Kind::kWave, 0.01f, 5, 1.5f, 0})},
      {"style 0: frizz: variation", with({Kind::kFrizz, 0.01f, 5, 0, NAN})},
      {"stands there twice",
       [](HairMesh& m) {
         m.styles[0] = {{Kind::kTaper, 1, 0, 0, 0}, {Kind::kTaper, 1, 0, 0, 0}};
       }},
  };
  for (const Case& c : cases) {
    HairMesh mesh = small_hair_mesh(every_operator());
    c.spoil(mesh);
    try {
      validate(mesh, "bob.hairmesh");
      ADD_FAILURE() << "nobody noticed: " << c.said;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(c.said), std::string::npos) << e.what();
    }
  }
}

TEST(HairMesh, ColumnsOfABundleHaveAsManyLayers) {
  HairMesh mesh = small_hair_mesh({}, 2, 5);
  for (std::uint32_t c = 1; c < mesh.column_offsets.size(); ++c) mesh.column_offsets[c] -= 1;  // column 0 loses a layer
  mesh.positions.pop_back(), mesh.uvw.pop_back(), mesh.occlusion.pop_back();
  EXPECT_THROW(validate(mesh, "test"), Error);
}

TEST(HairMesh, SettingsOutOfRangeAreNamed) {
  const HairMesh mesh = small_hair_mesh({});
  EXPECT_THROW(expand(mesh, {.points = 1}), Error);
  EXPECT_THROW(expand(mesh, {.points = 128}), Error);
  EXPECT_THROW(expand(mesh, {.share = 1.1f}), Error);
}

}  // namespace
}  // namespace pelage
