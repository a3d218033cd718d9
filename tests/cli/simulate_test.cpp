// pelage simulate and what reads its result: info, render, trace, convert; and mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/animation.h>
#include <pelage/io.h>

#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;

class CliSimulate : public Cli {
 protected:
  void make_animation(const std::string& options) {
    make_hair();
    ASSERT_EQ(run("lod build hair.pelage -o lod.pelage --guides 8 --memory-share 20 --levels 2").status, 0);
    const Outcome made = run("simulate lod.pelage -o moving.pelage " + options);
    ASSERT_EQ(made.status, 0) << made.err;
  }
};

TEST_F(CliSimulate, WritesFramesThatInfoTells) {
  make_animation("--frames 5-12 --fps 30 --motion nod");
  const Json json = Json::parse(run("info moving.pelage --json").out)["animation"];
  EXPECT_EQ(json["first_frame"], 5);
  EXPECT_EQ(json["last_frame"], 12);
  EXPECT_EQ(json["frame_rate"], 30);
  EXPECT_EQ(json["guides"], 8);
  EXPECT_THAT(run("info moving.pelage").out, HasSubstr("frames 5 to 12, 30 a second"));
  EXPECT_THAT(run("info lod.pelage").out, testing::Not(HasSubstr("a second")));
  ASSERT_EQ(run("convert moving.pelage copy.pelage").status, 0);
  EXPECT_EQ(read_lod(in("copy.pelage").string()).animation->guides, read_lod(in("moving.pelage").string()).animation->guides);
}

TEST_F(CliSimulate, RenderDrawsFramesByTheirNumbers) {
  make_animation("--frames 5-8 --motion turn --wind 5,0,0");
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 --frames 6-7 -o a.##.png").status, 0);
  EXPECT_FALSE(fs::exists(in("a.05.png")));
  EXPECT_TRUE(fs::exists(in("a.06.png")));
  EXPECT_TRUE(fs::exists(in("a.07.png")));
  EXPECT_FALSE(fs::exists(in("a.08.png")));
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 --frame 7 -o one.png").status, 0);
  EXPECT_EQ(slurp(in("one.png")), slurp(in("a.07.png")));
  EXPECT_NE(slurp(in("a.06.png")), slurp(in("a.07.png")));
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 -o all.#.png").status, 0);
  EXPECT_EQ(slurp(in("all.7.png")), slurp(in("one.png")));
  EXPECT_TRUE(fs::exists(in("all.5.png")) && fs::exists(in("all.8.png")));
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 -o rest.png").status, 0);
  ASSERT_EQ(run("render lod.pelage --size 40x30 --spp 1 -o lod.png").status, 0);
  EXPECT_EQ(slurp(in("rest.png")), slurp(in("lod.png")));
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 --frame 8 --still-meshes -o still.png").status, 0);
  EXPECT_NE(slurp(in("still.png")), slurp(in("all.8.png")));
}

TEST_F(CliSimulate, MotionIsWrittenWithFrames) {
  make_animation("--frames 1-8 --motion turn");
  ASSERT_EQ(run("render moving.pelage --size 40x30 --spp 1 --frame 8 --layers motion -o a.exr").status, 0);
  const Image image = read_image(in("a.exr").string());
  const auto channel =
      static_cast<std::size_t>(std::find(image.channels.begin(), image.channels.end(), "motion.X") - image.channels.begin());
  ASSERT_LT(channel, image.channel_count());
  float most = 0;
  for (std::size_t p = 0; p < image.pixels.size(); p += image.channel_count())
    most = std::max(most, std::fabs(image.pixels[p + channel]));
  EXPECT_GT(most, 0.1f);
}

TEST_F(CliSimulate, TraceSeesTheFrame) {
  make_animation("--frames 1-8 --motion turn");
  for (const char* frame : {"--frame 1", "--frame 8"})
    ASSERT_EQ(run(std::string("trace moving.pelage --size 24x18 --spp 1 --no-checkpoint -o ") + (frame[8] == '1' ? "a" : "b") +
                  ".png " + frame)
                  .status,
              0);
  EXPECT_NE(slurp(in("a.png")), slurp(in("b.png")));
}

TEST_F(CliSimulate, HeadsMoveByFiles) {
  std::ofstream(in("m.json")) << R"({"keys": [{"time": 0}, {"time": 0.1, "translation": [0.1, 0, 0]}]})";
  make_animation("--frames 4 --motion m.json");
  const LodHierarchy lod = read_lod(in("moving.pelage").string());
  EXPECT_NEAR(lod.animation->head.back().m[0][3], 0.1f, 1e-6f);
  EXPECT_NEAR(lod.animation->guides_at(3)[0].x, lod.guides[0].x + 0.1f, 1e-6f);
}

TEST_F(CliSimulate, MistakesAreNamed) {
  make_animation("--frames 4");
  const auto refused = [&](const std::string& command, int status, const std::string& text) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, status) << command;
    EXPECT_THAT(outcome.err, HasSubstr(text)) << command;
  };
  refused("simulate hair.pelage -o out.pelage", 1, "pelage lod build hair.pelage");
  refused("simulate lod.pelage -o out.hair", 2, ".pelage");
  refused("simulate lod.pelage -o out.pelage --motion dance", 2, "nod");
  refused("simulate lod.pelage -o out.pelage --frames 9-2", 2, "9-2");
  refused("simulate lod.pelage -o out.pelage --frames 2 --bend -1", 1, "bend_stiffness");
  refused("render moving.pelage --frame 5 -o a.png", 2, "1 to 4");
  refused("render moving.pelage --frames 2-5 -o a.#.png", 2, "1 to 4");
  refused("render lod.pelage --frame 1 -o a.png", 2, "pelage simulate");
  refused("render lod.pelage --frames x -o a.png", 2, "1-240");
  refused("trace moving.pelage --frame 0 -o a.png", 2, "1 to 4");
  EXPECT_THAT(run("simulate --help").out, AllOf(HasSubstr("--motion nod"), HasSubstr("pelage render animated.pelage")));
}

}  // namespace
}  // namespace pelage
