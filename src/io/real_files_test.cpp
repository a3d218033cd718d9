// Real grooms, meshes and pictures, against counts that an independent parser published with them.
#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>

#include "kit/io_kit.h"

namespace pelage {
namespace {

void expect_groom(const std::string& path, std::size_t strands, std::size_t per_strand, const std::string& format) {
  ImportReport report;
  const StrandSet set = read_strands(path, {}, &report);
  EXPECT_EQ(report.format, format);
  EXPECT_EQ(set.strand_count() + report.repairs.dropped_strands(), strands);
  EXPECT_EQ(set.point_count() + report.repairs.zero_length_segments + report.repairs.dropped_strands() * per_strand,
            strands * per_strand);
  EXPECT_NO_THROW(validate(set, path));
}

TEST(RealFiles, SintelGroomIsInMetersAndYUp) {
  PELAGE_NEEDS(path, "grooms/SintelHairOriginal-sintel_hair.16points.tfx");
  expect_groom(path, 11400, 16, "tressfx");
  ImportReport report;
  const StrandSet set = read_strands(path, {}, &report);
  EXPECT_EQ(report.scale, 1);
  EXPECT_EQ(report.up, UpAxis::kY);
  EXPECT_TRUE(report.scale_guessed);
  EXPECT_TRUE(report.repairs.clean()) << report.repairs.summary();
  EXPECT_TRUE(set.root_uv.empty());
}

TEST(RealFiles, RatboyHasRootUv) {
  PELAGE_NEEDS(path, "grooms/Ratboy_mohawk.tfx");
  expect_groom(path, 2228, 32, "tressfx");
  EXPECT_EQ(read_strands(path).root_uv.size(), 2228u);
}

TEST(RealFiles, BearIsInCentimeters) {
  PELAGE_NEEDS(path, "grooms/bear.tfx");
  expect_groom(path, 48113, 4, "tressfx3");
  ImportReport report;
  const Vec3 size = bounds(read_strands(path, {}, &report)).extent();
  EXPECT_EQ(report.scale, 0.01f);
  EXPECT_NEAR(size.z, 2, 0.1);
}

TEST(RealFiles, RealGroomsSurviveEveryFormat) {
  for (const char* name : {"grooms/SintelHairOriginal-sintel_hair.16points.tfx", "grooms/Ratboy_mohawk.tfx"}) {
    PELAGE_NEEDS(path, name);
    const kit::TemporaryFolder folder;
    const StrandSet set = read_strands(path);
    ImportOptions meters;
    meters.scale = 1;
    for (const char* extension : {"pelage", "hair", "tfx", "data"}) {
      const std::string copy = folder / (std::string("copy.") + extension);
      write_strands(copy, set);
      const StrandSet back = read_strands(copy, meters);
      EXPECT_EQ(back.points, set.points) << name << " as " << extension;
      EXPECT_EQ(back.offsets, set.offsets) << name << " as " << extension;
    }
  }
}

TEST(RealFiles, UnsupportedGroomsAreNamed) {
  const std::pair<const char*, const char*> files[] = {{"grooms/cortex_curves.abc", "Alembic"},
                                                       {"grooms/tinyusdz_hair.usdc", "USD crate"},
                                                       {"grooms/tinyusdz_hair.usda", "USD text"},
                                                       {"grooms/Fibermesh2_mohi0.3k_Curves.tfx", "TressFX 2"}};
  for (const auto& [name, kind] : files) {
    PELAGE_NEEDS(path, name);
    try {
      read_strands(path);
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_NE(e.problem().find(kind), std::string::npos) << e.what();
    }
  }
}

TEST(RealFiles, PlyAndGlbMeshes) {
  PELAGE_NEEDS(ply, "meshes/bear_body.ply");
  PELAGE_NEEDS(glb, "meshes/suzi.glb");
  const TriangleMesh bear = read_mesh(ply, 0.01f), monkey = read_mesh(glb);
  EXPECT_EQ(bear.triangles.size(), 57784u);
  EXPECT_EQ(bear.positions.size(), 31175u);
  EXPECT_EQ(bear.uv.size(), 31175u);
  EXPECT_EQ(monkey.triangles.size(), 15744u);
  EXPECT_EQ(monkey.positions.size(), 8098u);
  EXPECT_EQ(monkey.uv.size(), 8098u);
}

TEST(RealFiles, TfxMeshes) {
  PELAGE_NEEDS(body, "meshes/Ratboy_body.tfxmesh");
  PELAGE_NEEDS(hand, "meshes/Ratboy_left_hand.tfxmesh");
  EXPECT_EQ(read_mesh(body).triangles.size(), 25814u);
  EXPECT_EQ(read_mesh(body).positions.size(), 12909u);
  EXPECT_EQ(read_mesh(hand).triangles.size(), 2490u);
  EXPECT_EQ(read_mesh(hand).positions.size(), 1247u);
}

TEST(RealFiles, Environments) {
  const std::pair<const char*, float> maps[] = {
      {"env/studio.hdr", 3568.f}, {"env/sunset.hdr", 2176.f}, {"env/forest.hdr", 74.5f}};
  for (const auto& [name, largest] : maps) {
    PELAGE_NEEDS(path, name);
    const Image map = read_image(path);
    EXPECT_EQ(map.width, 1024);
    EXPECT_EQ(map.height, 512);
    EXPECT_EQ(map.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(*std::max_element(map.pixels.begin(), map.pixels.end()), largest) << name;
  }
  for (const char* name : {"env/comp_zip.exr", "env/comp_piz.exr"}) {
    PELAGE_NEEDS(path, name);
    const Image image = read_image(path);
    EXPECT_EQ(image.width, 587);
    EXPECT_EQ(image.height, 675);
    EXPECT_EQ(image.channel_count(), 4u);
  }
  PELAGE_NEEDS(tiled, "env/WavyLinesLatLong.exr");
  EXPECT_EQ(read_image(tiled).width, 1024);
}

TEST(RealFiles, ObjMeshes) {
  const std::pair<const char*, std::size_t> meshes[] = {{"meshes/sintel.obj", 5952},
                                                        {"meshes/sintel-eyes.obj", 1408},
                                                        {"meshes/sintel-eyelashes.obj", 192},
                                                        {"meshes/sintel-collider.obj", 678},
                                                        {"meshes/spot.obj", 5856}};
  for (const auto& [name, triangles] : meshes) {
    PELAGE_NEEDS(path, name);
    EXPECT_EQ(read_mesh(path).triangles.size(), triangles) << name;
  }
}

}  // namespace
}  // namespace pelage
