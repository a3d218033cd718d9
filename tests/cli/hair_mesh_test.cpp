// Hair meshes on the command line: made, told about, turned into each other and into strands, and drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>

#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"
#include "composite/side_by_side.h"

namespace pelage {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using Json = nlohmann::json;

class CliHairMesh : public Cli {
 protected:
  void make_bob() const {
    const Outcome made = run("grow --hair-mesh bob --strands 2000 --seed 3 -o bob.hairmesh");
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("2000 strands in 200 bundles"));
  }
};

TEST_F(CliHairMesh, InfoSaysWhatItHolds) {
  make_bob();
  const Outcome outcome = run("info --json bob.hairmesh");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  const HairMesh mesh = read_hair_mesh(in("bob.hairmesh").string());
  EXPECT_EQ(json["kind"], "hair mesh");
  EXPECT_EQ(json["format"], "binary");
  EXPECT_EQ(json["strands"], 2000);
  EXPECT_EQ(json["bundles"], mesh.bundles.size());
  EXPECT_EQ(json["columns"], mesh.column_count());
  EXPECT_EQ(json["vertices"], mesh.vertex_count());
  EXPECT_EQ(json["occlusion"], true);
  EXPECT_EQ(json["styles"][0][0]["kind"], "length");
  EXPECT_EQ(json["file_bytes"], fs::file_size(in("bob.hairmesh")));
  EXPECT_THAT(run("info bob.hairmesh").out,
              AllOf(HasSubstr("binary hair mesh"), HasSubstr("clump amount"), HasSubstr("bob, seed 3")));
}

TEST_F(CliHairMesh, BothFilesAndStrandsComeFromEither) {
  make_bob();
  ASSERT_EQ(run("convert bob.hairmesh bob.json").status, 0);
  EXPECT_EQ(Json::parse(run("info --json bob.json").out)["format"], "text");
  ASSERT_EQ(run("convert bob.json back.hairmesh").status, 0);
  EXPECT_EQ(slurp(in("back.hairmesh")), slurp(in("bob.hairmesh")));
  ASSERT_EQ(run("convert bob.json exact.hairmesh --exact").status, 0);
  EXPECT_GT(fs::file_size(in("exact.hairmesh")), fs::file_size(in("bob.hairmesh")));

  ASSERT_EQ(run("convert bob.hairmesh bob.pelage").status, 0);
  ASSERT_EQ(run("convert bob.json half.pelage --points 100 --share 0.5").status, 0);
  const StrandSet all = read_strands(in("bob.pelage").string()), half = read_strands(in("half.pelage").string());
  EXPECT_EQ(all.strand_count(), 2000u);
  EXPECT_EQ(all.point_count(), 2000u * 64);
  EXPECT_NEAR(static_cast<double>(half.strand_count()), 1000, 110);  // rounded up in each of 200 bundles
  EXPECT_EQ(half.point_count(), half.strand_count() * 100);
}

TEST_F(CliHairMesh, IsDrawnAsItsStrands) {
  make_bob();
  ASSERT_EQ(run("convert bob.hairmesh bob.pelage --points 127").status, 0);
  const std::string options =
      " --size 40x40 --spp 1 --no-shadows --eye 0,0,1.2 --target 0,0,0 --light directional:0,-1,-1:3,3,3";
  const Outcome drawn = run("render bob.hairmesh -o mesh.png" + options);
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.err + drawn.out, HasSubstr("mannequin"));
  ASSERT_EQ(run("render bob.hairmesh --no-head -o mesh.png" + options).status, 0);
  ASSERT_EQ(run("render bob.pelage --no-head -o strands.png" + options).status, 0);
  EXPECT_TRUE(slurp(in("mesh.png")) == slurp(in("strands.png")));
  std::ofstream(in("scene.json")) << R"({"grooms": [{"file": "bob.hairmesh"}], "settings": {"width": 16, "height": 16}})";
  EXPECT_EQ(run("render scene.json -o scene.png").status, 0);
}

TEST_F(CliHairMesh, TextIsDrawnLikeBinary) {
  make_bob();
  ASSERT_EQ(run("convert bob.hairmesh bob.json").status, 0);
  for (const char* name : {"bob.hairmesh", "bob.json"}) {
    const Outcome drawn = run("render " + std::string(name) + " --method swr --size 40x40 -o " + name + ".png");
    EXPECT_EQ(drawn.status, 0) << drawn.err;
  }
  EXPECT_TRUE(slurp(in("bob.hairmesh.png")) == slurp(in("bob.json.png")));
}

// Every method draws what a scene file makes: swr the hair mesh, the others its strands.
TEST_F(CliHairMesh, ASceneFileMakesItself) {
  make_bob();
  const std::string rest = R"(, "camera": {"eye": [0, 0, 1.2], "target": [0, 0, 0]}, "settings": {"width": 40, "height": 40}})";
  std::ofstream(in("grown.json")) << R"({"grooms": [{"grow": {"hair_mesh": "bob", "strands": 2000, "seed": 3}}])" << rest;
  for (const char* method : {"swr", "msaa"}) {
    const std::string options = " --method " + std::string(method) + " --spp 1 --no-shadows -o ";
    const Outcome grown = run("render grown.json" + options + "grown.exr");
    ASSERT_EQ(grown.status, 0) << grown.err;
    const Image picture = read_image(in("grown.exr").string());
    EXPECT_GT(*std::max_element(picture.pixels.begin(), picture.pixels.end()), *picture.at(0, 0) + 0.05f) << method;
  }
}

TEST_F(CliHairMesh, TwoEyesSeeItSideBySideOrInFilesOfTheirOwn) {
  make_bob();
  const std::string common = "render bob.hairmesh --no-head --method swr --size 40x30 ";
  const Outcome drawn = run(common + "--stereo -o both.png -o eye.%V.png -o layers.%V.exr --layers Z --stats");
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr("raster"));
  EXPECT_EQ(files().size(), 6u);  // and the hair mesh
  const Image both = read_image(in("both.png").string());
  EXPECT_EQ(both.width, 80);
  for (const int eye : {0, 1}) {
    const std::string name = eye == 0 ? "left" : "right";
    const Image one = read_image(in("eye." + name + ".png").string());
    EXPECT_EQ(one.pixels, part_of(both, eye, 2).pixels);
    const Image layers = read_image(in("layers." + name + ".exr").string());
    EXPECT_EQ(layers.width, 40);
    EXPECT_THAT(layers.channels, Contains("Z"));
  }
  EXPECT_NE(slurp(in("eye.left.png")), slurp(in("eye.right.png")));

  const auto picture = [&](const std::string& options) {
    EXPECT_EQ(run(common + "-o one.png " + options).status, 0) << options;
    return slurp(in("one.png"));
  };
  EXPECT_EQ(picture("--stereo=0.063"), slurp(in("both.png")));
  EXPECT_NE(picture("--stereo=0.1"), slurp(in("both.png")));
  EXPECT_NE(picture("--stereo --convergence 0.5"), slurp(in("both.png")));
  EXPECT_EQ(picture("--stereo=0"), picture(""));
  // The usual way to name a picture of either eye goes along with the number of a picture.
  ASSERT_EQ(run(common + "--stereo -o turn.%V.##.png --orbit 5 --frames 2").status, 0);
  EXPECT_TRUE(fs::exists(in("turn.right.02.png")));
}

TEST_F(CliHairMesh, MistakesAboutEyesAreNamed) {
  make_bob();
  const auto error = [&](const std::string& options) {
    const Outcome outcome = run("render bob.hairmesh --no-head --method swr --size 16x16 " + options);
    EXPECT_NE(outcome.status, 0) << options;
    return outcome.err;
  };
  EXPECT_THAT(error("--stereo=-1 -o a.png"), HasSubstr("separation"));
  EXPECT_THAT(error("--stereo=wide -o a.png"), HasSubstr("--stereo"));
  EXPECT_THAT(error("--stereo --convergence 0 -o a.png"), HasSubstr("--convergence"));
  EXPECT_THAT(error("--convergence 1 -o a.png"), HasSubstr("--stereo"));
  EXPECT_THAT(error("-o eye.%V.png"), HasSubstr("--stereo"));
  EXPECT_THAT(error("--stereo --ortho -o a.png"), HasSubstr("orthographic"));
  EXPECT_THAT(error("--stereo --gbuffer g.exr"), HasSubstr("two eyes"));
  EXPECT_FALSE(fs::exists(in("a.png")));
}

TEST_F(CliHairMesh, MistakesAreNamed) {
  Outcome outcome = run("grow --hair-mesh bop -o a.hairmesh");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"bob\""));
  outcome = run("grow --hair-mesh bob --length 0.3 -o a.hairmesh");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--length-scale"));
  EXPECT_EQ(run("grow --hair-mesh bob -o a.png").status, 1);
  EXPECT_EQ(run("grow --hair-mesh bob").status, 2);
  EXPECT_EQ(run("grow -o a.hairmesh").status, 2);
  EXPECT_TRUE(files().empty());
}

TEST_F(CliHairMesh, SchemaIsPrinted) {
  EXPECT_EQ(Json::parse(run("grow --hair-mesh-schema").out)["title"], "Pelage hair mesh");
}

}  // namespace
}  // namespace pelage
