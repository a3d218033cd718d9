// pelage lod: the file, what info says of it, and mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>
#include <pelage/lod.h>

#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;
using CliLod = Cli;

TEST_F(CliLod, BuildsAChainThatInfoLists) {
  make_hair();
  const Outcome outcome = run("lod build hair.pelage -o lod.pelage --levels 3 --guides 12 --memory-share 20 --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  const LodHierarchy lod = read_lod(in("lod.pelage").string());
  EXPECT_EQ(json["guides"], 12);
  ASSERT_EQ(json["levels"].size(), 3u);
  EXPECT_EQ(json["levels"][2]["hairs"], lod.level(2).size());
  EXPECT_EQ(json["strands"], 300);
  EXPECT_EQ(json["bytes"], resident_bytes(lod));
  validate(lod, read_strands(in("lod.pelage").string()), "test");

  const Outcome info = run("info lod.pelage --json");
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(Json::parse(info.out)["lod"]["levels"], json["levels"]);
  EXPECT_THAT(run("info lod.pelage").out, AllOf(HasSubstr("thick hairs"), HasSubstr("12 guides"), HasSubstr("mean width")));
  EXPECT_THAT(run("info hair.pelage").out, testing::Not(HasSubstr("thick hairs")));
}

TEST_F(CliLod, SaysThatMemoryEndsTheChain) {
  make_hair();
  EXPECT_THAT(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 0.8").out,
              AllOf(HasSubstr("80 % of the groom's memory"), HasSubstr("--memory-share")));
  EXPECT_THAT(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 50 --levels 2").out,
              testing::Not(HasSubstr("--memory-share")));
}

TEST_F(CliLod, ExtractsALevel) {
  make_hair();
  ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 20").status, 0);
  const Outcome outcome = run("lod extract lod.pelage --level 1 -o level.pelage");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LodHierarchy lod = read_lod(in("lod.pelage").string());
  const StrandSet level = read_strands(in("level.pelage").string());
  EXPECT_EQ(level.strand_count(), lod.level(1).size());
  EXPECT_EQ(level.basis, CurveBasis::kBSpline);
  EXPECT_EQ(level.points[0], lod.centers[lod.level_offsets[1] * LodHierarchy::kPoints]);
}

TEST_F(CliLod, ConvertKeepsTheChainOrSaysThatItIsLost) {
  make_hair();
  ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 20").status, 0);
  ASSERT_EQ(run("convert lod.pelage copy.pelage").status, 0);
  EXPECT_EQ(read_lod(in("copy.pelage").string()).centers, read_lod(in("lod.pelage").string()).centers);
  EXPECT_THAT(run("convert lod.pelage copy.hair").err, HasSubstr("levels of detail"));
  EXPECT_THAT(run("convert lod.pelage big.pelage --scale 2").err, HasSubstr("levels of detail"));
  EXPECT_TRUE(read_lod(in("big.pelage").string()).empty());
}

TEST_F(CliLod, RenderChoosesByWidthOrByPredictedError) {
  make_hair();
  ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 20").status, 0);
  const auto segments = [&](const std::string& how) {
    const Outcome outcome = run("render lod.pelage --size 48x48 -o lod.png --json " + how);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const Json told = Json::parse(outcome.out);
    std::uint64_t drawn = 0;
    for (const auto& stage : told["stages"])
      if (stage["stage"] == "lod") drawn += stage["items"].get<std::uint64_t>();
    return drawn;
  };
  const std::uint64_t fine = segments("--lod-error 0.02"), coarse = segments("--lod-error 0.1");
  EXPECT_LT(coarse, fine);
  EXPECT_GT(coarse, 0u);
  EXPECT_EQ(segments("--lod-error 0"), segments(""));
  Outcome outcome = run("render lod.pelage -o lod.png --lod-as cards --lod-error 0.05");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("--lod-error"), HasSubstr("--lod-pixels")));
  EXPECT_EQ(run("render lod.pelage -o lod.png --lod-pixels 3 --lod-error 0.05").status, 2);
}

TEST_F(CliLod, LevelsBlendWhereTheyAreAskedTo) {
  make_hair();
  ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 12 --memory-share 20").status, 0);
  const auto rendered = [&](const std::string& how) {
    const Outcome outcome = run("render lod.pelage --size 48x48 -o lod.exr " + how);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_image(in("lod.exr").string()).pixels;
  };
  const std::vector<float> whole = rendered("");
  EXPECT_EQ(rendered("--lod-blend 0"), whole);
  EXPECT_NE(rendered("--lod-blend 0.9"), whole);
  const std::vector<float> by_error = rendered("--lod-blend 0.9 --lod-error 0.03");
  EXPECT_NE(by_error, rendered("--lod-error 0.03"));
  EXPECT_NE(by_error, rendered("--lod-blend 0.9"));
  Outcome outcome = run("render lod.pelage -o lod.png --lod-as cards --lod-blend 0.5");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("--lod-blend"), HasSubstr("--lod-as")));
  EXPECT_EQ(run("render lod.pelage -o lod.png --lod-level 1 --lod-blend 0.5").status, 2);
  EXPECT_EQ(run("render lod.pelage -o lod.png --lod-blend 1").status, 2);
}

TEST_F(CliLod, MistakesAreNamed) {
  make_hair();
  Outcome outcome = run("lod build hair.pelage -o lod.hair");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr(".pelage"));
  outcome = run("lod build hair.pelage -o lod.pelage --levels 17");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("levels"), HasSubstr("1 … 16")));
  outcome = run("lod extract hair.pelage -o level.pelage");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("pelage lod build"));
  ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 12 --levels 2").status, 0);
  outcome = run("lod extract lod.pelage --level 7 -o level.pelage");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("levels"));
  EXPECT_EQ(run("lod").status, 2);
  EXPECT_THAT(run("lod build --help").out, HasSubstr("pelage lod build wavy.pelage -o wavy_lod.pelage"));
}

}  // namespace
}  // namespace pelage
