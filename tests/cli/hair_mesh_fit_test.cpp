// pelage fit hairmesh: the file, its report, and mistakes.
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
using CliFit = Cli;

TEST_F(CliFit, WritesAHairMeshAndTellsHowNear) {
  make_hair();
  const Outcome outcome = run("fit hairmesh hair.pelage -o hair.hairmesh --bundles 20 --layers 8 --no-occlusion --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  const HairMesh mesh = read_hair_mesh(in("hair.hairmesh").string());
  EXPECT_EQ(json["strands"], 300);
  EXPECT_EQ(strand_count(mesh), 300u);
  EXPECT_EQ(json["bundles"], 20);
  EXPECT_EQ(mesh.bundles.size(), 20u);
  EXPECT_EQ(json["vertices"], 20 * 4 * 8);
  EXPECT_EQ(json["bytes_out"], fs::file_size(in("hair.hairmesh")));
  EXPECT_EQ(json["bytes_in"], fs::file_size(in("hair.pelage")));
  EXPECT_GT(json["base_rms_m"].get<double>(), 0);
  EXPECT_GE(json["base_p95_m"].get<double>(), json["base_rms_m"].get<double>());
  EXPECT_TRUE(mesh.occlusion.empty());
}

TEST_F(CliFit, KeepsToTheBytes) {
  make_hair();
  for (const std::uintmax_t bytes : {4000, 12000}) {
    const Outcome outcome = run("fit hairmesh hair.pelage -o hair.hairmesh --bytes " + std::to_string(bytes));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("mm rms"), HasSubstr("silhouettes overlap")));
    EXPECT_LE(fs::file_size(in("hair.hairmesh")), bytes);
    EXPECT_GE(fs::file_size(in("hair.hairmesh")), bytes * 3 / 4);
  }
}

TEST_F(CliFit, OperatorsCanBeLeftOut) {
  make_hair();
  ASSERT_EQ(run("fit hairmesh hair.pelage -o plain.json --bundles 5 --no-operators --no-occlusion").status, 0);
  for (const auto& style : read_hair_mesh(in("plain.json").string()).styles) EXPECT_TRUE(style.empty());
}

TEST_F(CliFit, MistakesAreNamed) {
  make_hair();
  Outcome outcome = run("fit hairmesh hair.pelage -o hair.png");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr(".hairmesh"));
  outcome = run("fit hairmesh hair.pelage -o a.hairmesh --layers 1");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("layers"));
  outcome = run("fit hairmesh none.pelage -o a.hairmesh");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("none.pelage"));
  EXPECT_EQ(run("fit hairmesh hair.pelage").status, 2);
  EXPECT_EQ(run("fit").status, 2);
  EXPECT_TRUE(files().empty());
  EXPECT_THAT(run("fit hairmesh --help").out, HasSubstr("pelage fit hairmesh wavy.pelage -o wavy.hairmesh"));
}

}  // namespace
}  // namespace pelage
