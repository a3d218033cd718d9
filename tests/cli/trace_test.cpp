// pelage trace as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/io.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::HasSubstr;

const std::string kSmall = "trace hair.pelage --no-head --size 48x40 ";

class TraceVerb : public Cli {
 protected:
  TraceVerb() { make_hair(); }
};

TEST_F(TraceVerb, WritesPicturesOfEveryKind) {
  const Outcome done = run(kSmall + "-o a.exr -o b.png -o c.hdr --spp 4 --layers all --json --stats");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(files(), testing::UnorderedElementsAre("a.exr", "b.png", "c.hdr"));
  const Image image = read_image(in("a.exr").string());
  EXPECT_EQ(image.channel_count(), 4u + 3 + 1 + 1 + 3 + 3 + 3 + 2 + 1 + 3 + 2 + 3 * 16 + 3 * 5);
  for (const char* channel : {"variance.G", "coverage", "Z", "strand", "motion.Y", "bounce15.B", "TRT.R"})
    EXPECT_TRUE(std::count(image.channels.begin(), image.channels.end(), channel)) << channel;
  const auto json = nlohmann::json::parse(done.out.substr(done.out.find('{')));
  EXPECT_EQ(json["samples"], 4);
  EXPECT_EQ(json["width"], 48);
}

TEST_F(TraceVerb, KilledAndCalledAgainItEndsWithTheSamePicture) {
  const std::string what = kSmall + "--spp 300 --checkpoint-every 0 ";
  ASSERT_EQ(run(what + "-o whole.exr").status, 0);
  // `timeout` kills without a chance to say goodbye; how far the work got does not matter.
  const std::string command =
      "cd '" + folder_.string() + "' && timeout -s KILL 0.3 '" PELAGE_COMMAND "' " + what + "-o resumed.exr >/dev/null 2>&1";
  [[maybe_unused]] const int status = std::system(command.c_str());
  const Outcome done = run(what + "-o resumed.exr");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(read_image(in("whole.exr").string()).pixels, read_image(in("resumed.exr").string()).pixels);
  EXPECT_FALSE(fs::exists(in("resumed.exr.checkpoint")));
}

TEST_F(TraceVerb, ANamedCheckpointStaysAndRefinesThePicture) {
  ASSERT_EQ(run(kSmall + "-o a.exr --spp 8 --checkpoint a.state").status, 0);
  ASSERT_TRUE(fs::exists(in("a.state")));
  const Outcome more = run(kSmall + "-o a.exr --spp 12 --checkpoint a.state");
  EXPECT_THAT(more.err, HasSubstr("went on from 8 samples"));
  const Outcome other = run(kSmall + "-o b.exr --spp 12 --checkpoint a.state --seed 7");
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("a.state: fingerprint: the state of another picture"));
  EXPECT_FALSE(fs::exists(in("b.exr")));
}

TEST_F(TraceVerb, MotionIsWhereTheCameraCameFrom) {
  const auto motion_of = [&](const std::string& options) {
    EXPECT_EQ(run(kSmall + "-o m.exr --spp 1 --layers motion " + options).status, 0);
    const Image image = read_image(in("m.exr").string());
    float sum = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count()) sum += std::abs(image.pixels[i + 4]);
    return sum;
  };
  EXPECT_EQ(motion_of(""), 0);
  EXPECT_GT(motion_of("--orbit 3"), 0);
}

TEST_F(TraceVerb, UsageErrors) {
  const std::pair<const char*, const char*> cases[] = {{"--spp 0", "--spp"},
                                                       {"--integrator pth", "--integrator"},
                                                       {"--layers depht", "--layers"},
                                                       {"--intgrator path", "did you mean --integrator?"},
                                                       {"--noise -1", "--noise"}};
  for (const auto& [arguments, words] : cases) {
    const Outcome outcome = run(kSmall + "-o a.png " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << arguments;
  }
  EXPECT_THAT(files(), testing::IsEmpty());
}

}  // namespace
}  // namespace pelage
