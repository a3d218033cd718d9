// pelage denoise as a user meets it: from the samples of both renderers to a picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::HasSubstr;

const std::string kScene = "hair.pelage --size 96x80 --width-scale 3 ";

class DenoiseVerb : public Cli {
 protected:
  DenoiseVerb() { make_hair(); }

  void make_gbuffer(const std::string& verb, const std::string& options = "") const {
    const Outcome made = run(verb + " " + kScene + "--gbuffer g.exr " + options);
    ASSERT_EQ(made.status, 0) << made.err;
  }
  double error_after(const std::string& options) const {
    const Outcome done = run("denoise --gbuffer g.exr -o out.exr --json " + options);
    EXPECT_EQ(done.status, 0) << done.err;
    if (done.status != 0) return -1;
    const auto json = nlohmann::json::parse(done.out);
    EXPECT_LT(json["after"]["mse"], json["before"]["mse"]);
    EXPECT_GT(json["after"]["psnr"], json["before"]["psnr"]);
    return json["after"]["mse"];
  }
};

TEST_F(DenoiseVerb, RenderedSamplesBecomeThePictureOfMethodLink) {
  make_gbuffer("render");
  ASSERT_EQ(run("render " + kScene + "-o linked.exr --float --method link --kernel-size 0.03").status, 0);
  ASSERT_EQ(run("render " + kScene + "-o truth.exr --method ssaa --spp 64").status, 0);
  const double with = error_after("--reference truth.exr --float --k 0.03 --groom hair.pelage");
  const Image linked = read_image(in("linked.exr").string()), ours = read_image(in("out.exr").string());
  ASSERT_EQ(ours.pixels.size(), linked.pixels.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < ours.pixels.size(); ++i) different += std::abs(ours.pixels[i] - linked.pixels[i]) > 1e-3f;
  EXPECT_LT(different, ours.pixels.size() / 200);
  EXPECT_LT(error_after("--reference truth.exr --k 0.03"), 1.15 * with);
  EXPECT_GT(error_after("--reference truth.exr --k 0.03 --method filter-only"), with);
}

TEST_F(DenoiseVerb, TracedSamplesComeCloserToTheTruth) {
  make_gbuffer("trace");
  EXPECT_THAT(files(), testing::ElementsAre("g.exr"));
  ASSERT_EQ(run("trace " + kScene + "-o truth.exr --spp 64").status, 0);
  const double one = error_after("--reference truth.exr");
  make_gbuffer("trace", "--spp 4");
  EXPECT_EQ(read_image(in("g.exr").string()).width, 192);
  EXPECT_LT(error_after("--reference truth.exr --samples 4"), one);
}

TEST_F(DenoiseVerb, WritesPicturesAndTells) {
  make_gbuffer("render", "-o beauty.png --alpha coverage --method link");
  const Outcome done = run("denoise --gbuffer g.exr -o a.exr -o b.png -o c.hdr --alpha coverage --stats");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(files(), testing::UnorderedElementsAre("a.exr", "b.png", "beauty.png", "c.hdr", "g.exr"));
  EXPECT_THAT(done.out, HasSubstr("filter.curves"));
  EXPECT_THAT(done.out, HasSubstr("strands, camera 0."));
}

TEST_F(DenoiseVerb, ErrorsNameTheFileAndTheRemedy) {
  make_gbuffer("render");
  const Outcome renamed = run("denoise --gbuffer g.exr -o a.exr --channel strand=ViewLayer.strand");
  EXPECT_EQ(renamed.status, 1);
  EXPECT_THAT(renamed.err, HasSubstr("g.exr: channel ViewLayer.strand (for strand): is not there"));
  ASSERT_EQ(run("render " + kScene + "-o plain.exr").status, 0);
  const Outcome plain = run("denoise --gbuffer plain.exr -o a.exr");
  EXPECT_EQ(plain.status, 1);
  EXPECT_THAT(plain.err, HasSubstr("plain.exr: channel depth: is not there"));
  EXPECT_THAT(plain.err, HasSubstr("say --channel depth=NAME; there are R, G, B, A"));
  EXPECT_FALSE(fs::exists(in("a.exr")));
  const std::pair<const char*, const char*> cases[] = {{"--channel strand", "FIELD=NAME"},
                                                       {"--samples 2", "--samples"},
                                                       {"--method lnk", "--method"},
                                                       {"--gbufer g.exr", "did you mean --gbuffer?"}};
  for (const auto& [options, words] : cases) {
    const Outcome outcome = run(std::string("denoise --gbuffer g.exr -o a.exr ") + options);
    EXPECT_NE(outcome.status, 0) << options;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  }
  EXPECT_EQ(run("render " + kScene + "--gbuffer g.png").status, 1);
  EXPECT_EQ(run("trace " + kScene + "--gbuffer g.exr --spp 3").status, 2);
  EXPECT_EQ(run("trace " + kScene + "--gbuffer g.exr -o a.exr").status, 2);
}

TEST_F(DenoiseVerb, HelpListsTheChannels) {
  const Outcome help = run("denoise --help");
  EXPECT_EQ(help.status, 0);
  for (const char* words : {"position.X position.Y position.Z", "R G B", "screen.X screen.Y", "--channel", "optional"})
    EXPECT_THAT(help.out, HasSubstr(words));
}

}  // namespace
}  // namespace pelage
