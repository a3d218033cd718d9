// The pelage command as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pelage/io.h>
#include <thread>

#include "cli/cli_kit.h"

namespace pelage {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST_F(Cli, HelpAndVersionSucceed) {
  EXPECT_THAT(run("--version").out, HasSubstr("pelage 0."));
  const Outcome help = run("--help");
  EXPECT_EQ(help.status, 0);
  for (const char* verb : {"grow", "info", "convert", "render", "trace", "compare", "bench"}) {
    EXPECT_THAT(help.out, HasSubstr(verb));
    const Outcome verb_help = run(std::string(verb) + " --help");
    EXPECT_EQ(verb_help.status, 0) << verb;
    EXPECT_THAT(verb_help.out, HasSubstr(std::string("pelage ") + verb)) << "an example";
  }
}

TEST_F(Cli, UsageErrorsNameTheNearest) {
  const std::pair<const char*, const char*> cases[] = {
      {"rendr x", "did you mean render?"},
      {"redner", "did you mean render?"},
      {"render x -o a.png --siez 1x1", "did you mean --size?"},
      {"bench --lst", "did you mean --list?"},
      {"render x -o a.png --view dept", "did you mean `depth`?"},
      {"render x -o a.png --hair blonde", "did you mean `blond`?"},
      {"render", "INPUT"},
      {"render x", "--output"},
      {"render x -o a.png --method mssa", "did you mean `msaa`?"},
      {"render x -o a.png --method ssaa --spp 0", "--spp"},
      {"render x -o a.png --spp 3", "--spp"},
      {"render x -o a.png --threads -1", "--threads"},
      {"render x -o a.png --isa MMX", "--isa"},
      {"", "subcommand"},
  };
  make_hair();
  for (const auto& [arguments, words] : cases) {
    std::string line = arguments;
    if (const std::size_t x = line.find(" x"); x != std::string::npos) line.replace(x, 2, " hair.pelage");
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.status, 2) << line << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << line;
    EXPECT_EQ(outcome.out, "") << line;
  }
  EXPECT_THAT(files(), testing::IsEmpty());
}

TEST_F(Cli, BadFilesFailWithAMessageAndNoOutput) {
  make_hair();
  std::ofstream(in("empty.hair"));
  std::ofstream(in("noise.hair")) << "these are no strands at all, whatever their name says";
  fs::create_directory(in("folder"));
  std::ofstream(in("none.data"), std::ios::binary) << std::string(4, '\0');  // USC: no strands announced
  std::ofstream(in("scene.json")) << "{\"grooms\": [{\"flie\": \"hair.pelage\"}]}";
  const std::string whole = slurp(in("hair.pelage"));
  std::ofstream(in("cut.pelage"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  for (const char* input : {"missing.hair", "folder", "empty.hair", "noise.hair", "none.data", "cut.pelage", "scene.json"}) {
    const Outcome outcome = run(std::string("render ") + input + " -o out.png");
    EXPECT_EQ(outcome.status, 1) << input;
    EXPECT_THAT(outcome.err, HasSubstr(std::string("pelage: ") + input)) << "names the file";
    EXPECT_FALSE(fs::exists(in("out.png"))) << input;
  }
  EXPECT_THAT(run("render hair.pelage --mesh missing.obj -o out.png").err, HasSubstr("missing.obj"));
  EXPECT_FALSE(fs::exists(in("out.png")));
}

TEST_F(Cli, UnwritableOutputsFailBeforeTheWork) {
  make_hair();
  fs::create_directory(in("folder.png"));
  std::ofstream(in("file"));
  for (const char* output : {"nowhere/out.png", "folder.png", "file/out.png", "out.bmp", "out"}) {
    const Outcome outcome = run(std::string("render hair.pelage --size 8x8 -o ") + output);
    EXPECT_EQ(outcome.status, 1) << output;
    EXPECT_THAT(outcome.err, HasSubstr(output));
  }
  // The input does not exist: that the output is told shows that it is looked at first.
  EXPECT_THAT(run("render missing.hair -o nowhere/out.png").err, HasSubstr("nowhere"));
  EXPECT_THAT(files(), testing::UnorderedElementsAre("folder.png", "file"));
}

TEST_F(Cli, AFullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  make_hair();
  fs::create_symlink("/dev/full", in("out.png"));
  const Outcome outcome = run("render hair.pelage --size 64x64 -o out.png");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("No space left"));
}

TEST_F(Cli, AFailedRenderLeavesTheOldPicture) {
  make_hair();
  std::ofstream(in("out.png")) << "old";
  EXPECT_EQ(run("render missing.hair -o out.png").status, 1);
  EXPECT_EQ(slurp(in("out.png")), "old");
  EXPECT_THAT(files(), testing::ElementsAre("out.png"));
}

TEST_F(Cli, WritesEveryKindOfPicture) {
  make_hair();
  const Outcome outcome = run("render hair.pelage --size 40x30 --spp 2 -o a.png -o a.exr -o a.hdr --layers Z,coverage,id");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(slurp(in("a.png")).substr(1, 3), "PNG");
  EXPECT_EQ(slurp(in("a.exr")).substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_EQ(slurp(in("a.hdr")).substr(0, 2), "#?");
  EXPECT_THAT(slurp(in("a.exr")), testing::AllOf(HasSubstr("coverage"), HasSubstr("id.R")));
  EXPECT_EQ(outcome.out, "") << "quiet when all is well";
}

TEST_F(Cli, RendersByEveryMethod) {
  make_hair();
  for (const char* method : {"msaa", "ssaa --spp 5", "taa --frames 3", "fxaa", "smaa"}) {
    const Outcome outcome = run(std::string("render hair.pelage --size 40x30 -o a.png --stats --method ") + method);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string name(method, 4);
    if (name != "msaa") {
      EXPECT_THAT(outcome.out, HasSubstr("filter." + name.substr(0, name.find(' '))));
    }
  }
}

TEST_F(Cli, DenoisingWithoutItsLibrarySaysHowToGetIt) {
  make_hair();
  const Outcome outcome = run("render hair.pelage --size 40x30 -o a.png --method oidn");
  if (outcome.status == 0) GTEST_SKIP() << "this build has Open Image Denoise";
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("openimagedenoise.org"));
  EXPECT_FALSE(fs::exists(in("a.png")));
}

TEST_F(Cli, WritesSequences) {
  make_hair();
  const Outcome taa =
      run("render hair.pelage --size 40x30 -o a.###.exr -o last.png --method taa --orbit 2 --frames 3 --layers motion");
  EXPECT_EQ(taa.status, 0) << taa.err;
  EXPECT_THAT(files(), testing::UnorderedElementsAre("a.001.exr", "a.002.exr", "a.003.exr", "last.png"));
  EXPECT_THAT(slurp(in("a.002.exr")), HasSubstr("motion.X"));
  EXPECT_NE(slurp(in("a.001.exr")), slurp(in("a.002.exr")));
  const Image second = read_image(in("a.002.exr").string());
  const auto motion =
      static_cast<std::size_t>(std::find(second.channels.begin(), second.channels.end(), "motion.X") - second.channels.begin());
  float fastest = 0;
  for (std::size_t i = motion; i < second.pixels.size(); i += second.channel_count())
    fastest = std::max(fastest, std::abs(second.pixels[i]));
  EXPECT_GT(fastest, 0.05f) << "pixels";
  EXPECT_LT(fastest, 5);
  // The last picture of an orbit is the picture of the turned camera, where nothing is taken over from the others.
  EXPECT_EQ(run("render hair.pelage --size 40x30 --view strand-id -o b.png --orbit 2 --frames 3").status, 0);
  EXPECT_EQ(run("render hair.pelage --size 40x30 --view strand-id -o c.png --turn 4").status, 0);
  EXPECT_EQ(slurp(in("b.png")), slurp(in("c.png")));
  // A picture that is drawn alone moves as it does among the others.
  EXPECT_EQ(run("render hair.pelage --size 40x30 --view motion -o d.#.png --orbit 2 --frames 3").status, 0);
  EXPECT_EQ(run("render hair.pelage --size 40x30 --view motion -o e.png --orbit 2 --frames 3").status, 0);
  EXPECT_EQ(slurp(in("d.3.png")), slurp(in("e.png")));
  EXPECT_NE(slurp(in("d.1.png")), slurp(in("e.png")));
}

TEST_F(Cli, LinksStrands) {
  make_hair();
  EXPECT_EQ(run("render hair.pelage --size 64x48 --method link -o a.png").status, 0);
  EXPECT_EQ(run("render hair.pelage --size 64x48 --method link --spp 4 --alpha coverage --kernel-size 0.02 -o b.png").status,
            0);
  EXPECT_NE(slurp(in("a.png")), slurp(in("b.png")));
  const Outcome stats = run("render hair.pelage --size 64x48 --method link -o a.png --stats");
  for (const char* stage : {"filter.visibility", "filter.link", "filter.alpha", "filter.anisotropic"})
    EXPECT_THAT(stats.out, HasSubstr(stage));
  const Outcome wrong = run("render hair.pelage --method link --spp 8 -o c.png");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("1, 4, 9 or 16"));
  EXPECT_FALSE(std::filesystem::exists(in("c.png")));
}

TEST_F(Cli, TunesTheFilter) {
  make_hair();
  const Outcome outcome =
      run("tune filter hair.pelage --size 64x48 --reference-spp 16 --radii 0,4,30 --aspects 0.3,0.6 --json -o k.svg");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["kernels"].size(), 6u);
  double least = 1e9;
  for (const auto& k : json["kernels"]) least = std::min(least, k["share"].get<double>());
  for (const auto& k : json["kernels"])
    if (k["kernel_radius"] == json["best"]["kernel_radius"] && k["aspect"] == json["best"]["aspect"]) {
      EXPECT_EQ(k["share"], least);
    }
  EXPECT_LT(least, json["kernels"][0]["share"].get<double>());  // not to smooth at all
  EXPECT_THAT(slurp(in("k.svg")), HasSubstr("</svg>"));
  const Outcome published =
      run("tune filter hair.pelage --size 64x48 --reference-spp 4 --kernel-sizes 0.01,0.03 --falloffs 0.5,1000 -o k.svg");
  EXPECT_EQ(published.status, 0) << published.err;
  EXPECT_THAT(published.out, HasSubstr("kernel_size"));
  EXPECT_THAT(slurp(in("k.svg")), HasSubstr("kernel size k"));
  EXPECT_EQ(run("tune filter hair.pelage -o k.png").status, 2);
  EXPECT_EQ(run("tune filter nothing.pelage").status, 1);
}

TEST_F(Cli, JsonIsTheSameForAnyThreads) {
  make_hair();
  std::string hash, picture;
  for (const char* threads : {"1", "2", "5"}) {
    const Outcome outcome = run(std::string("render hair.pelage --size 64x48 -o out.png --json --threads ") + threads);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["width"], 64);
    EXPECT_GT(json["peak_bytes"], 0);
    EXPECT_EQ(json["stages"][1]["stage"], "groom");
    EXPECT_EQ(json["stages"][1]["items"], 300 * 16);
    if (hash.empty()) hash = json["hash"], picture = slurp(in("out.png"));
    EXPECT_EQ(json["hash"], hash);
    EXPECT_EQ(slurp(in("out.png")), picture) << "byte for byte";
    EXPECT_THAT(outcome.err, Not(HasSubstr("Warning")));
  }
}

TEST_F(Cli, StatsNameTheStages) {
  make_hair();
  const Outcome outcome = run("render hair.pelage --size 64x48 -o out.png --stats");
  for (const char* stage : {"io.read", "groom", "light", "raster", "shade", "composite", "bytes per control point"})
    EXPECT_THAT(outcome.out, HasSubstr(stage));
}

TEST_F(Cli, OptionsReachThePicture) {
  make_hair();
  const auto hash = [&](const std::string& options) {
    const Outcome outcome = run("render hair.pelage --size 64x48 -o out.png --json " + options);
    EXPECT_EQ(outcome.status, 0) << options << outcome.err;
    return outcome.status ? "" : nlohmann::json::parse(outcome.out)["hash"].get<std::string>();
  };
  const std::string plain = hash("");
  for (const char* options : {"--spp 16",
                              "--view u",
                              "--view depth",
                              "--exposure 1",
                              "--background 1,0,0",
                              "--background transparent",
                              "--eye 1,0,0",
                              "--target 0,0.1,0",
                              "--fov 60",
                              "--turn 90",
                              "--ortho",
                              "--light point:0,1,1:2,2,2",
                              "--light directional:0,-1,0:3,3,3",
                              "--no-shadows",
                              "--hair blond",
                              "--color 0.9,0.1,0.1",
                              "--melanin 4",
                              "--model kajiya-kay",
                              "--model zhu",
                              "--width-scale 3",
                              "--no-dual-scattering"})
    EXPECT_NE(hash(options), plain) << options;
}

TEST_F(Cli, ScenesRender) {
  make_hair();
  std::ofstream(in("scene.json")) << R"({"grooms": [{"file": "hair.pelage"}], "meshes": [{"shape": "mannequin"}],
                                          "settings": {"width": 40, "height": 30, "samples": 2}})";
  EXPECT_EQ(run("render scene.json -o out.png").status, 0);
  const Outcome larger = run("render scene.json -o out.png --size 50x20 --json");
  EXPECT_EQ(nlohmann::json::parse(larger.out)["width"], 50) << "options win over the file";
  EXPECT_EQ(nlohmann::json::parse(run("render --schema").out)["title"], "Pelage scene");
}

TEST_F(Cli, GrownHairShowsTheHeadItGrewOn) {
  const auto hash = [&](const std::string& arguments, bool head) {
    const Outcome outcome = run("render --size 64x48 -o out.png --json " + arguments);
    EXPECT_EQ(outcome.status, 0) << arguments << outcome.err;
    EXPECT_EQ(outcome.err.find("mannequin it was grown on; --no-head") != std::string::npos, head)
        << arguments << ": " << outcome.err;
    return outcome.status ? "" : nlohmann::json::parse(outcome.out)["hash"].get<std::string>();
  };
  std::ofstream(in("tile.obj")) << "v 0 0 0\nv 0.1 0 0\nv 0.1 0 -0.1\nf 1 2 3\n";
  for (const char* hair : {"hair.pelage", "hair.tfx", "hair.hair"}) {  // in every format, also those without a comment
    const std::string name = hair;
    ASSERT_EQ(run("grow curly --strands 300 --points 16 --write-mesh head.ply -o " + name).status, 0);
    const std::string shown = hash(name, true);
    EXPECT_NE(hash(name + " --no-head", false), shown);
    EXPECT_NE(hash(name + " --mesh tile.obj", false), shown) << "another mesh takes its place";
  }
  EXPECT_EQ(hash("hair.pelage --view depth --mesh head.ply", false), hash("hair.pelage --view depth", true)) << "the same head";
  ASSERT_EQ(run("grow coat --strands 50 --mesh tile.obj -o tile.pelage").status, 0);
  hash("tile.pelage", false);
}

TEST_F(Cli, GrowsEveryStyle) {
  for (const char* style : {"straight", "wavy", "curly", "afro", "ponytail", "coat"}) {
    const Outcome outcome = run(std::string("grow ") + style + " --strands 200 -o grown.pelage");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("grown.pelage: 200 strands")) << style;
    EXPECT_THAT(run("info grown.pelage").out, HasSubstr("200")) << style;
  }
}

TEST_F(Cli, GrowsKnittedCloth) {
  for (const char* pattern : {"knit-stockinette", "knit-rib"}) {
    const Outcome outcome =
        run(std::string("grow ") + pattern + " --wales 3 --courses 2 --plies 2 --strands 100 --points 9 -o cloth.pelage");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("cloth.pelage: 96 strands, 864 points")) << "4 fibers in each of 24 pieces of plies";
  }
}

TEST_F(Cli, GrowsOnAMeshOfAnyUnitsAndAxes) {
  std::ofstream(in("tile.obj")) << "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n";  // cm, z up
  const Outcome grown =
      run("grow coat --strands 50 --mesh tile.obj --mesh-scale 0.01 --mesh-up z --write-mesh out.obj -o tile.pelage");
  ASSERT_EQ(grown.status, 0) << grown.err;
  std::vector<std::array<float, 3>> vertices;
  std::ifstream written(in("out.obj"));
  for (std::string word; written >> word;)
    if (std::array<float, 3> v; word == "v" && written >> v[0] >> v[1] >> v[2]) vertices.push_back(v);
  EXPECT_THAT(vertices,
              testing::UnorderedElementsAre(std::array{0.f, 0.f, 0.f}, std::array{1.f, 0.f, 0.f}, std::array{0.f, 0.f, -1.f}));
}

TEST_F(Cli, GrowRefusesWhatItCannotDo) {
  const std::tuple<const char*, int, const char*> cases[] = {
      {"curly --strands 0", 1, "strands: 0 is outside 1 … 1000000"},
      {"curly --strands 1000001", 1, "outside 1 … 1000000"},
      {"curly --points 3", 1, "points: 3 is outside 4 … 1024"},
      {"curly --length -1", 1, "length: -1 is outside 0.0001 … 10"},
      {"curly --frizz 1.5", 1, "frizz: 1.5 is outside 0 … 1"},
      {"curly --width nan", 1, "width: nan is outside 0 … 0.1"},
      {"curly --mesh missing.obj", 1, "missing.obj"},
      {"curley", 1, "did you mean \"curly\"?"},
      {"curly --strands many", 2, "--strands"},
      {"curly --strnds 5", 2, "did you mean --strands?"},
      {"curly --mesh-up x", 2, "--mesh-up"},
      {"curly --wales 3", 2, "settings of knitted cloth"},
      {"knit-rib --wales 0", 1, "wales: 0 is outside 1 … 1000"},
      {"knit-rib --frizz 0.5", 2, "not a setting of knitted cloth"},
      {"knit-rib --mesh tile.obj", 2, "cloth is not grown on a surface"},
      {"knit-ribs", 1, "did you mean \"knit-rib\"?"},
  };
  for (const auto& [arguments, status, words] : cases) {
    const Outcome outcome = run(std::string("grow ") + arguments + " -o out.pelage");
    EXPECT_EQ(outcome.status, status) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << arguments;
  }
  EXPECT_EQ(run("grow curly").status, 2) << "no output named";
  EXPECT_THAT(files(), testing::IsEmpty());
}

TEST_F(Cli, BenchWritesALineAJsonAndRefusesUnknownNames) {
  const Outcome list = run("bench --list");
  EXPECT_THAT(list.out, testing::AllOf(HasSubstr("raster.centre.curly50k"), HasSubstr("frame.beauty.sintel")));
  const Outcome unknown = run("bench raster.cnter.curly50k");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("raster.centre.curly50k"));
  EXPECT_EQ(run("bench '('").status, 1);
}

// Runs on a terminal of its own; returns what it wrote there.
Outcome run_on_terminal(const fs::path& folder, const std::vector<std::string>& arguments, int interrupt_after_ms = 0) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    std::vector<char*> argv{const_cast<char*>(PELAGE_COMMAND)};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    if (chdir(folder.c_str()) == 0) execv(PELAGE_COMMAND, argv.data());
    _exit(127);
  }
  std::thread interrupter([=] {
    if (!interrupt_after_ms) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(interrupt_after_ms));
    kill(child, SIGINT);
  });
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
  int status = 0;
  waitpid(child, &status, 0);
  interrupter.join();
  close(terminal);
  return {status_of(status), text, text};
}

const std::vector<std::string> kLongWork{"grow", "curly", "--strands", "120000", "--points", "64", "-o", "long.pelage"};

TEST_F(Cli, ProgressShowsOnATerminalOnly) {
  const Outcome shown = run_on_terminal(folder_, kLongWork);
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_THAT(shown.err, HasSubstr("%")) << "work of more than a second";
  std::string line;
  for (const std::string& a : kLongWork) line += a + " ";
  EXPECT_THAT(run(line).err, Not(HasSubstr("%")));
}

TEST_F(Cli, AnInterruptLeavesNoFile) {
  const Outcome stopped = run_on_terminal(folder_, kLongWork, 400);
  EXPECT_EQ(stopped.status, 128 + SIGINT) << stopped.err;
  EXPECT_THAT(files(), testing::IsEmpty());
}

}  // namespace
}  // namespace pelage
