// The authored hair meshes: sound, small, of the promised number of strands, outside the head, and hair from root to tip.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <filesystem>

#include "groom/hairmesh/scalp_grid.h"
#include "groom/head_shape.h"
#include "groom/scalp.h"
#include "kit/io_kit.h"

namespace pelage {
namespace {

class EveryStyle : public testing::TestWithParam<std::string> {
 protected:
  HairMeshSettings settings() const {
    HairMeshSettings s;
    s.style = hair_mesh_style_from_name(GetParam());
    s.occlusion = false;
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(HairMesh, EveryStyle, testing::ValuesIn(hair_mesh_style_names()), [](const auto& style) {
  std::string name = style.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryStyle, IsValidAndHasItsStrands) {
  for (const std::uint32_t strands : {1000u, 127000u, 1000000u}) {
    HairMeshSettings s = settings();
    s.strands = strands;
    const HairMesh mesh = make_hair_mesh(s);
    EXPECT_NO_THROW(validate(mesh, "style"));
    EXPECT_EQ(strand_count(mesh), strands);
  }
}

TEST_P(EveryStyle, IsTenToTwentyKilobytes) {
  HairMeshSettings s = settings();
  s.occlusion = true;
  const kit::TemporaryFolder folder;
  write_hair_mesh(folder / "style.hairmesh", make_hair_mesh(s));
  const auto bytes = std::filesystem::file_size(folder / "style.hairmesh");
  EXPECT_GE(bytes, 10000u);
  EXPECT_LE(bytes, 20000u);
}

TEST_P(EveryStyle, StandsOnTheScalpAndStaysOutOfTheHead) {
  const HairMesh mesh = make_hair_mesh(settings());
  for (std::size_t c = 0; c < mesh.column_count(); ++c) {
    const Vec3 root = mesh.positions[mesh.column_offsets[c]];
    EXPECT_NEAR(groom::head_distance(root), 0.0008f, 0.0009f) << "column " << c;
    EXPECT_GT(groom::hairline_distance(root), -0.008f) << "column " << c;  // whose raggedness is 6.5 mm
    for (std::uint32_t v = mesh.column_offsets[c] + 1; v < mesh.column_offsets[c + 1]; ++v)
      EXPECT_GT(groom::head_distance(mesh.positions[v]), 0) << "column " << c << ", vertex " << v;
  }
}

TEST_P(EveryStyle, StrandsShowTheMannequinBelowThem) {
  HairMesh mesh = make_hair_mesh(settings());
  EXPECT_TRUE(grown_on_mannequin(mesh));
  for (Vec3& p : mesh.positions) p.x += 0.03f;  // moved by 3 cm
  EXPECT_FALSE(grown_on_mannequin(mesh));
}

TEST_P(EveryStyle, FewStrandsPassThroughTheHead) {
  ExpandSettings few;
  few.share = 0.02f;
  const StrandSet set = expand(make_hair_mesh(settings()), few);
  std::size_t inside = 0, all = 0;
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    for (std::uint32_t i = set.offsets[s] + 6; i < set.offsets[s + 1]; ++i, ++all)
      inside += groom::head_distance(set.points[i]) < -0.002f;
  EXPECT_LT(static_cast<double>(inside), 0.02 * static_cast<double>(all));
}

TEST_P(EveryStyle, StrandsAreSharedOutByArea) {
  const HairMesh mesh = make_hair_mesh(settings());
  std::vector<double> density;
  for (const HairMesh::Bundle& b : mesh.bundles) {
    if (b.style != 0) continue;
    const auto root = [&](std::size_t i) { return mesh.positions[mesh.column_offsets[b.columns[i]]]; };
    density.push_back(b.strands / (0.5 * static_cast<double>(length(cross(root(2) - root(0), root(3) - root(1))))));
  }
  const auto [least, most] = std::minmax_element(density.begin(), density.end());
  EXPECT_LT(*most, 1.1 * *least);
}

TEST_P(EveryStyle, IsTheSameForAnyThreadCountAndAnotherForAnotherSeed) {
  HairMeshSettings s = settings();
  s.occlusion = true;
  set_thread_count(1);
  const HairMesh one = make_hair_mesh(s);
  set_thread_count(4);
  const HairMesh four = make_hair_mesh(s);
  set_thread_count(0);
  EXPECT_EQ(one.positions, four.positions);
  EXPECT_EQ(one.occlusion, four.occlusion);
  s.seed = 2;
  EXPECT_NE(make_hair_mesh(s).bundles[0].seed, one.bundles[0].seed);
}

// A bundle whose columns went to both sides of the head would hang across the face.
TEST(HairMeshStyles, PartedHairStaysOnItsSide) {
  for (const HairMeshStyle style : {HairMeshStyle::kBob, HairMeshStyle::kWavy, HairMeshStyle::kCurls}) {
    HairMeshSettings s;
    s.style = style, s.occlusion = false, s.strands = 20000;
    const StrandSet set = expand(make_hair_mesh(s));
    std::size_t in_the_way = 0;
    for (const Vec3 p : set.points) in_the_way += std::abs(p.x) < 0.03f && p.z > 0.03f && p.y < 0;
    EXPECT_LT(static_cast<double>(in_the_way), 1e-3 * static_cast<double>(set.point_count())) << static_cast<int>(style);
  }
}

TEST(HairMeshStyles, QuadsOfTheScalpAreWellShaped) {
  const groom::ScalpGrid grid = groom::make_scalp_grid({.rows = 10, .across = 5, .parting_x = 0.018f, .parted = true});
  for (const auto& quad : grid.quads) {
    float shortest = 1, longest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const float side = length(grid.columns[quad[i]].root - grid.columns[quad[(i + 1) % 4]].root);
      shortest = std::min(shortest, side), longest = std::max(longest, side);
    }
    EXPECT_GT(shortest, 0.004f);
    EXPECT_LT(longest, 0.06f);
  }
}

TEST(HairMeshStyles, SettingsOutOfRangeAreNamed) {
  HairMeshSettings s;
  s.strands = 999;
  EXPECT_THROW(make_hair_mesh(s), Error);
  s = {}, s.length = 2;
  EXPECT_THROW(make_hair_mesh(s), Error);
  s = {}, s.width = -1;
  EXPECT_THROW(make_hair_mesh(s), Error);
  s = {}, s.parting = 0.06f;
  EXPECT_THROW(make_hair_mesh(s), Error);
  EXPECT_THROW(hair_mesh_style_from_name("bobb"), Error);
}

}  // namespace
}  // namespace pelage
