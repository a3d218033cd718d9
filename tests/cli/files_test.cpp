// pelage info and pelage convert: what they say about files, and that a groom survives the way through every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>

#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;

class CliFiles : public Cli {
 protected:
  StrandSet strands(const std::string& name) const { return read_strands(in(name).string()); }
  void convert(const std::string& arguments) const {
    const Outcome outcome = run("convert " + arguments);
    ASSERT_EQ(outcome.status, 0) << arguments << outcome.err;
    EXPECT_EQ(outcome.out, "") << arguments;
  }
};

TEST_F(CliFiles, InfoAsJsonHasWhatTheFileHolds) {
  make_hair();
  const Outcome outcome = run("info --json hair.pelage");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  const StrandSet set = strands("hair.pelage");
  EXPECT_EQ(json["kind"], "groom");
  EXPECT_EQ(json["format"], "pelage");
  EXPECT_EQ(json["strands"], 300);
  EXPECT_EQ(json["points"], 300 * 16);
  EXPECT_EQ(json["points_per_strand"]["min"], 16);
  const Bounds box = bounds(set);
  EXPECT_EQ(json["bounds"]["lower"], (Json{box.lower.x, box.lower.y, box.lower.z}));
  EXPECT_EQ(json["bounds"]["upper"], (Json{box.upper.x, box.upper.y, box.upper.z}));
  EXPECT_EQ(json["repairs"]["clean"], true);
  EXPECT_EQ(json["width_guessed"], false);
  EXPECT_EQ(json["file_bytes"], fs::file_size(in("hair.pelage")));
}

TEST_F(CliFiles, InfoCountsRepairs) {
  // USC: two strands of two points, one of them with a coordinate that is no number.
  const std::uint32_t words[] = {2, 2, 0, 0, 0, 0, 0x3f800000, 0, 2, 0x7fc00000, 0, 0, 0, 0x3f800000, 0};
  std::ofstream(in("nan.data"), std::ios::binary).write(reinterpret_cast<const char*>(words), sizeof words);
  const Json json = Json::parse(run("info --json nan.data --scale 0.25").out);
  EXPECT_EQ(json["strands"], 1);
  EXPECT_EQ(json["repairs"]["clean"], false);
  EXPECT_EQ(json["repairs"]["non_finite_points"], 1);
  EXPECT_EQ(json["scale"], 0.25);
  EXPECT_EQ(json["bounds"]["upper"][1], 0.25);
  EXPECT_EQ(json["width_guessed"], true);
  EXPECT_EQ(Json::parse(run("info --json nan.data --width 1e-4").out)["width_guessed"], false);
}

TEST_F(CliFiles, InfoOfSeveralFilesIsALineEach) {
  make_hair();
  ASSERT_EQ(run("render hair.pelage --size 8x6 -o a.png").status, 0);
  ASSERT_EQ(run("grow curly --strands 10 -o ten.pelage --write-mesh head.obj").status, 0);
  std::istringstream lines(run("info --json hair.pelage a.png head.obj").out);
  std::vector<Json> files;
  for (std::string line; std::getline(lines, line);) files.push_back(Json::parse(line));
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[1]["kind"], "image");
  EXPECT_EQ(files[1]["width"], 8);
  EXPECT_EQ(files[2]["kind"], "mesh");
  EXPECT_EQ(files[2]["triangles"], read_mesh(in("head.obj").string()).triangles.size());
  EXPECT_THAT(run("info hair.pelage").out, AllOf(HasSubstr("strands      300"), HasSubstr("4,800 (16 a strand)")));
}

TEST_F(CliFiles, PointsSurviveTheWayThroughEveryFormat) {
  make_hair();
  const StrandSet set = strands("hair.pelage");
  for (const char* there : {"pelage", "hair", "tfx", "data"})
    for (const char* onward : {"pelage", "hair", "tfx", "data"}) {
      const std::string a = std::string("a.") + there, b = std::string("b.") + onward;
      convert("hair.pelage " + a);
      convert(a + " " + b + " --scale 1");
      convert(b + " back.pelage --scale 1");
      const StrandSet back = strands("back.pelage");
      EXPECT_EQ(back.points, set.points) << there << " and " << onward << ": neither scaled nor turned";
      EXPECT_EQ(back.offsets, set.offsets) << there << " and " << onward;
    }
}

TEST_F(CliFiles, ConvertTellsWhatIsLostAndWhatIsAssumed) {
  make_hair();
  EXPECT_THAT(run("convert hair.pelage a.data").err, AllOf(HasSubstr("300 strands"), HasSubstr("cannot hold widths")));
  EXPECT_THAT(run("convert a.data b.pelage").err, AllOf(HasSubstr("taken as meters"), HasSubstr("--scale")));
}

TEST_F(CliFiles, FormatUpAndWidthReachTheFile) {
  make_hair();
  const StrandSet set = strands("hair.pelage");
  convert("hair.pelage noext --format usc");
  convert("noext turned.pelage --up z --scale 2 --width 1e-4");
  const StrandSet turned = strands("turned.pelage");
  ASSERT_EQ(turned.point_count(), set.point_count());
  for (std::size_t i = 0; i < set.point_count(); ++i)
    ASSERT_EQ(turned.points[i], Vec3(2 * set.points[i].x, 2 * set.points[i].z, -2 * set.points[i].y)) << i;
  EXPECT_EQ(turned.widths, std::vector<float>{1e-4f});
}

TEST_F(CliFiles, MeshesConvert) {
  ASSERT_EQ(run("grow curly --strands 10 -o ten.pelage --write-mesh head.obj").status, 0);
  convert("head.obj head.ply");
  const TriangleMesh before = read_mesh(in("head.obj").string()), after = read_mesh(in("head.ply").string());
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.triangles, before.triangles);
}

TEST_F(CliFiles, FailuresNameTheFileAndLeaveNothing) {
  make_hair();
  std::ofstream(in("noise.hair")) << "no strands";
  std::ofstream(in("empty.hair"));
  const std::string whole = slurp(in("hair.pelage"));
  std::ofstream(in("cut.pelage"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  for (const char* input : {"missing.hair", "noise.hair", "empty.hair", "cut.pelage"}) {
    for (const std::string& line :
         {std::string("info ") + input, std::string("info --json ") + input, std::string("convert ") + input + " out.pelage"}) {
      const Outcome outcome = run(line);
      EXPECT_EQ(outcome.status, 1) << line;
      EXPECT_EQ(outcome.out, "") << line;
      EXPECT_THAT(outcome.err, HasSubstr(input)) << line;
    }
    EXPECT_FALSE(fs::exists(in("out.pelage"))) << input;
  }
  EXPECT_EQ(run("convert hair.pelage out.xyz").status, 1) << "an extension without a format";
  EXPECT_EQ(run("convert hair.pelage nowhere/out.hair").status, 1);
  EXPECT_EQ(run("convert hair.pelage").status, 2);
  EXPECT_EQ(run("convert hair.pelage out.hair --scale -1").status, 2);
  EXPECT_EQ(run("info hair.pelage --up w").status, 2);
  EXPECT_THAT(files(), testing::UnorderedElementsAre("noise.hair", "empty.hair", "cut.pelage"));
}

}  // namespace
}  // namespace pelage
