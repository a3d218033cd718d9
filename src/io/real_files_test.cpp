// Real grooms, meshes and pictures, against counts that an independent parser published with them.
#include <pelage/io.h>

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

TEST(RealFiles, ObjMeshes) {
  const std::pair<const char*, std::size_t> meshes[] = {{"meshes/sintel.obj", 5952}, {"meshes/sintel-eyes.obj", 1408},
                                                        {"meshes/sintel-eyelashes.obj", 192},
                                                        {"meshes/sintel-collider.obj", 678}, {"meshes/spot.obj", 5856}};
  for (const auto& [name, triangles] : meshes) {
    PELAGE_NEEDS(path, name);
    EXPECT_EQ(read_mesh(path).triangles.size(), triangles) << name;
  }
}

}  // namespace
}  // namespace pelage
