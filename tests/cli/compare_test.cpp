// pelage compare: pictures and sequences from files, as table and JSON, with maps, masks and regions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>
#include <pelage/metrics.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class CliCompare : public Cli {
 protected:
  Image make_image(float value, std::vector<std::string> channels = {"R", "G", "B"}) const {
    Image image(48, 32, std::move(channels));
    std::fill(image.pixels.begin(), image.pixels.end(), value);
    return image;
  }
  void write(const std::string& name, const Image& image) const { write_image(in(name).string(), image, true); }
  void write(const std::string& name, float value) const { write(name, make_image(value)); }

  Json compare(const std::string& arguments) const {
    const Outcome outcome = run("compare --json " + arguments);
    EXPECT_EQ(outcome.status, 0) << arguments << outcome.err;
    return outcome.status == 0 ? Json::parse(outcome.out) : Json();
  }
  void expect_failure(const std::string& arguments, int status, const std::string& words) const {
    const Outcome outcome = run("compare " + arguments);
    EXPECT_EQ(outcome.status, status) << arguments << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
  }
};

TEST_F(CliCompare, JsonHasTheStableKeys) {
  write("a.png", 0.6f), write("b.png", 0.4f);
  const Json json = compare("a.png b.png");
  EXPECT_NEAR(json["mse"].get<double>(), 0.04, 1e-6) << "sRGB values as they stand in the file";
  EXPECT_NEAR(json["psnr"].get<double>(), -10 * std::log10(0.04), 1e-4);
  for (const char* key : {"relative_mse", "ssim", "flip"}) EXPECT_TRUE(json[key].is_number()) << key;
  EXPECT_TRUE(json["ms_ssim"].is_null()) << "too small a picture";
  EXPECT_THAT(json["notes"]["ms_ssim"].get<std::string>(), HasSubstr("at least 161"));
  EXPECT_EQ(json["domain"], "display");
  EXPECT_EQ(json["pixels"], 48 * 32);
  const Json same = compare("a.png a.png");
  EXPECT_TRUE(same["psnr"].is_null());
  EXPECT_EQ(same["flip"], 0);
  EXPECT_EQ(same["ssim"], 1);
}

TEST_F(CliCompare, TableNamesMetricsAndWhatTheyMean) {
  write("a.png", 0.6f), write("b.png", 0.4f);
  const Outcome outcome = run("compare a.png b.png --metrics mse,psnr --regions 2x1 --region corner=0,0,8x8");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("a.png against b.png: 48 × 32 pixels, as a display shows them"), HasSubstr("decibels"),
                    HasSubstr("13.97"), HasSubstr("corner"), HasSubstr("1,0"), Not(HasSubstr("flip"))));
  EXPECT_THAT(run("compare --list").out, AllOf(HasSubstr("relative_mse"), HasSubstr("flip")));
}

TEST_F(CliCompare, LinearPicturesAreComparedAsTheyAreUnlessToneMapped) {
  write("a.exr", 2.f), write("b.exr", 1.f), write("b.png", 1.f);
  const Json linear = compare("a.exr b.exr");
  EXPECT_EQ(linear["domain"], "linear");
  EXPECT_NEAR(linear["mse"].get<double>(), 1, 1e-6);
  EXPECT_EQ(linear["flip_exposures"], 2);
  const Json shown = compare("a.exr b.exr --tone-map aces");
  EXPECT_EQ(shown["domain"], "display");
  EXPECT_LT(shown["mse"].get<double>(), 0.05);
  EXPECT_FALSE(shown.contains("flip_exposures"));
  const Json mixed = compare("a.exr b.png --tone-map none");
  EXPECT_LT(mixed["mse"].get<double>(), 1e-12) << "2 is clipped to 1";
  EXPECT_THAT(mixed["warnings"].at(0).get<std::string>(), HasSubstr("display-encoded"));
  const Json forced = compare("a.exr b.exr --exposures -1,3,5 --metrics flip");
  EXPECT_EQ(forced["flip_start_exposure"], -1);
  EXPECT_EQ(forced["flip_stop_exposure"], 3);
  EXPECT_EQ(forced["flip_exposures"], 5);
}

TEST_F(CliCompare, MapsAreWrittenInColorOrAsTheyAre) {
  write("a.png", 1.f), write("b.png", 0.f);
  ASSERT_EQ(run("compare a.png b.png --map flip.png --map mse=errors.exr --map mse=m.png --map-scale 2").status, 0);
  const Image flip = read_image(in("flip.png").string(), false), mse = read_image(in("errors.exr").string());
  EXPECT_EQ(flip.width, 48);
  EXPECT_EQ(mse.channels, std::vector<std::string>{"error"});
  EXPECT_EQ(mse.pixels.at(0), 1);
  const Image colored = color_error({"mse", mse}, 2), written = read_image(in("m.png").string(), false);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(written.pixels[c], colored.pixels[c], 0.5f / 255 + 1e-6f);
}

TEST_F(CliCompare, HairOfARenderedPicture) {
  make_hair();
  ASSERT_EQ(run("render hair.pelage --size 96x96 --layers coverage -o a.exr -o a.png --spp 1").status, 0);
  ASSERT_EQ(run("render hair.pelage --size 96x96 --layers coverage -o b.exr --spp 8").status, 0);
  const Json whole = compare("a.exr b.exr"), hair = compare("a.exr b.exr --mask hair");
  EXPECT_LT(hair["pixels"].get<int>(), whole["pixels"].get<int>());
  EXPECT_GT(hair["mse"].get<double>(), whole["mse"].get<double>()) << "the background is equal";
  EXPECT_TRUE(hair["coverage_error"].is_number());
  // The picture for a display that `render` wrote is the one that compare makes, but for eight bits.
  const Json png = compare("a.exr a.png");
  EXPECT_LT(png["mse"].get<double>(), 1.0 / (255 * 255 * 4)) << "at most half a step";
  EXPECT_EQ(png["warnings"].size(), 1u);
  expect_failure("a.png a.png --mask hair", 1, "--layers coverage");
  Image mask = make_image(0);
  write("black.png", mask);
  expect_failure("a.exr b.exr --mask black.png", 1, "black everywhere");
  mask.at(3, 4)[1] = 1;
  write("mask.png", mask);
  expect_failure("a.exr b.exr --mask mask.png", 1, "the pictures have 96 × 96");
}

TEST_F(CliCompare, SequencesHaveValuesOverTime) {
  for (int i = 0; i < 3; ++i) {
    write("t." + std::to_string(9 + i) + ".png", i == 1 ? 0.8f : 0.6f);
    write("r." + std::to_string(9 + i) + ".png", 0.6f);
  }
  const Json json = compare("'t.%d.png' 'r.%d.png'");
  EXPECT_EQ(json["frames"], 3);
  EXPECT_NEAR(json["mse"].get<double>(), 0.04 / 3, 1e-6);
  EXPECT_NEAR(json["flicker"].get<double>(), 0.2, 1e-6);
  EXPECT_NEAR(json["adjacent_psnr"].get<double>(), -10 * std::log10(0.04), 1e-4);
  EXPECT_TRUE(json["reference_adjacent_psnr"].is_null()) << "equal frames";
  EXPECT_EQ(json["per_frame"].size(), 3u);
  EXPECT_GT(json["per_frame"][1]["mse"].get<double>(), 0.03) << "t.10 comes between t.9 and t.11";
  const Json matched = compare("'t.*.png' 'r.*.png'");
  EXPECT_EQ(matched["flicker"], json["flicker"]);
  EXPECT_THAT(run("compare 't.*.png' 'r.*.png'").out, AllOf(HasSubstr("3 frames of 48 × 32"), HasSubstr("flicker")));
  fs::remove(in("r.10.png"));
  expect_failure("'t.%d.png' 'r.%d.png'", 1, "r.%d.png: frame 10: t.%d.png has it, this has not");
  expect_failure("'t.*.png' 'r.*.png'", 1, "3 frames, but r.*.png has 2");
  expect_failure("'t.*.png' r.9.png", 2, "one picture");
  expect_failure("'x.*.png' r.9.png", 1, "no file has such a name");
}

TEST_F(CliCompare, AFileCalledLikeAPatternIsAFile) {
  write("a%d.png", 0.5f), write("a*.png", 0.5f);
  EXPECT_EQ(compare("'a%d.png' 'a*.png'")["mse"], 0);
}

TEST_F(CliCompare, BadInputIsNamed) {
  write("a.png", 0.5f);
  expect_failure("a.png missing.png", 1, "missing.png");
  std::ofstream(in("noise.png")) << "no picture";
  expect_failure("a.png noise.png", 1, "noise.png");
  write("small.png", Image(3, 2, {"R", "G", "B"}));
  expect_failure("small.png a.png", 1, "small.png: 3 × 2 pixels, but a.png has 48 × 32");
  Image nan = make_image(0);
  nan.at(7, 5)[2] = std::numeric_limits<float>::quiet_NaN();
  write("nan.exr", nan);
  expect_failure("nan.exr nan.exr", 1, "nan.exr: pixel (7, 5): channel B is NaN");
  expect_failure("a.png", 2, "REFERENCE");
  expect_failure("a.png a.png --metrics flop", 2, "did you mean `flip`?");
  expect_failure("a.png a.png --map flop.png", 2, "did you mean `flip`?");
  expect_failure("a.png a.png --map flip.bmp", 1, "flip.bmp");
  expect_failure("a.png a.png --map nowhere/flip.png", 1, "nowhere");
  expect_failure("a.png a.png --map psnr.png", 1, "no error per pixel");
  expect_failure("a.png a.png --regions 4", 2, "COLUMNSxROWS");
  expect_failure("a.png a.png --regions 400x1", 1, "no such tiles");
  expect_failure("a.png a.png --region r=1,2,3", 2, "NAME=X,Y,WxH");
  expect_failure("a.png a.png --region r=40,0,9x9", 1, "do not lie in 48 × 32");
  expect_failure("a.png a.png --tone-map linear", 2, "--tone-map");
  expect_failure("a.png a.png --exposures 1", 2, "START,STOP");
  EXPECT_THAT(files(), testing::UnorderedElementsAre("a.png", "noise.png", "small.png", "nan.exr")) << "no map was written";
}

TEST_F(CliCompare, FollowsStrandsOfTheScene) {
  ASSERT_EQ(run("grow straight --strands 300 --points 16 -o g.pelage").status, 0);
  ASSERT_EQ(run("render g.pelage --size 96x96 --background transparent --method ssaa --spp 16 -o truth.exr").status, 0);
  ASSERT_EQ(run("render g.pelage --size 96x96 --background transparent --spp 1 -o one.exr").status, 0);
  const Json same = compare("truth.exr truth.exr --strands g.pelage");
  EXPECT_EQ(same["continuity"], 1);
  EXPECT_EQ(same["continuity_gap"], 0);
  EXPECT_GT(same["continuity_length"], 50);
  const Json one = compare("one.exr truth.exr --strands g.pelage --mask flyaway --background 1,1,1 --metrics mse");
  EXPECT_LT(one["continuity"], 0.6);
  EXPECT_LT(one["pixels"], 96 * 96 / 2);
  EXPECT_THAT(run("compare one.exr truth.exr --strands g.pelage --metrics mse").out, HasSubstr("without a gap"));
  expect_failure("one.exr truth.exr --mask flyaway", 1, "no channel `coverage`");
  expect_failure("one.exr truth.exr --strands none.pelage", 1, "none.pelage");
}

}  // namespace
}  // namespace pelage
