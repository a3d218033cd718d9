// pelage simulate: hair that moves, from a groom with guides.
#include <fmt/format.h>
#include <pelage/grow.h>
#include <pelage/io.h>
#include <pelage/simulate.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "frame_list.h"
#include "io/atomic_file.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

struct SimulateVerb {
  std::string in, out, frames = "1-240", motion = "still", mesh;
  std::vector<float> wind, gravity;
  SimulationSettings settings;
  int head_cells = 64;
  bool no_head = false;
};

void check_output(const std::string& path) {
  if (!path.ends_with(".pelage"))
    throw UsageError("--output", path, "hair that moves is stored in .pelage files only", "call it name.pelage");
  const io::AtomicFile probe(path);
}

SimulationSettings settings_of(const SimulateVerb& verb) {
  SimulationSettings s = verb.settings;
  const FrameList frames = parse_frames("--frames", verb.frames);
  s.frames = static_cast<std::uint32_t>(frames.count ? *frames.count : frames.range->last - frames.range->first + 1);
  s.first_frame = frames.range ? frames.range->first : 1;
  if (!verb.wind.empty()) s.wind = {verb.wind[0], verb.wind[1], verb.wind[2]};
  if (!verb.gravity.empty()) s.gravity = {verb.gravity[0], verb.gravity[1], verb.gravity[2]};
  return s;
}

HeadMotion motion_of(const SimulateVerb& verb, const SimulationSettings& settings, const LodHierarchy& lod) {
  if (verb.motion.ends_with(".json")) return read_head_motion(verb.motion, neck_of(lod));
  const std::vector<std::string>& names = head_motion_names();
  if (std::find(names.begin(), names.end(), verb.motion) == names.end())
    throw UsageError("--motion", verb.motion, "unknown motion",
                     fmt::format("{}, or a file of keyframes, name.json", fmt::join(names, ", ")));
  return head_motion(verb.motion, static_cast<double>(settings.frames) / static_cast<double>(settings.frame_rate),
                     neck_of(lod));
}

std::shared_ptr<const HeadShape> head_of(const SimulateVerb& verb, const StrandSet& groom, const Progress& progress) {
  if (!verb.mesh.empty()) return make_head_shape(read_mesh(verb.mesh, 1, UpAxis::kY), verb.head_cells, progress);
  if (verb.no_head || !grown_on_mannequin(groom)) return nullptr;
  return make_head_shape(mannequin_head(), verb.head_cells, progress);
}

void run(const SimulateVerb& verb) {
  check_output(verb.out);
  const SimulationSettings settings = settings_of(verb);
  const auto start = std::chrono::steady_clock::now();
  bool collides = false;
  {
    ProgressLine line;
    const Progress progress = line.callback();
    const StrandSet groom = read_strands(verb.in, {}, nullptr, progress);
    LodHierarchy lod = read_lod(verb.in, progress);
    if (lod.empty())
      throw Error(verb.in, "", "the groom has no guides to move",
                  fmt::format("pelage lod build {} -o with_lod.pelage, and simulate that", verb.in));
    const std::shared_ptr<const HeadShape> head = head_of(verb, groom, progress);
    collides = head != nullptr;
    lod.animation = std::make_shared<GuideAnimation>(simulate(lod, settings, motion_of(verb, settings, lod), head, progress));
    write_lod(verb.out, groom, lod, progress);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: frames {} to {}, {:g} a second, in {:.1f} s\n", verb.out, settings.first_frame,
             settings.first_frame + static_cast<std::int32_t>(settings.frames) - 1, settings.frame_rate, seconds);
  if (!collides && !verb.no_head) fmt::print(stderr, "pelage: {}: no head to keep out of; --mesh gives one\n", verb.in);
}

void add_rod_options(CLI::App& verb, SimulationSettings& s) {
  const auto add = [&](const char* name, auto& value, const char* unit, const char* about) {
    verb.add_option(name, value, about)->type_name(unit)->capture_default_str();
  };
  add("--bend", s.bend_stiffness, "M4/S2", "Resistance to bending over mass per length; a human hair's is 0.001");
  add("--stretch", s.stretch_stiffness, "M2/S2", "Resistance to stretching over mass per length; a human hair's is 3e6");
  add("--shape", s.shape_frequency, "HZ", "How fast strands swing back into shape at the root; less toward the tip");
  add("--support", s.support, "SHARE", "Of their weight at rest that strands do not feel, so that they stay as styled, 0 to 1");
  add("--damping", s.damping, "1/S", "Of motion against the head's");
  add("--drag", s.drag, "1/S", "Of motion against the air's");
  add("--clearance", s.clearance, "M", "Distance that guides keep from the head");
  add("--friction", s.friction, "SHARE", "Of hair on the head, 0 to 1");
  add("--longest-step", s.longest_step, "S", "Longest substep");
}

}  // namespace

void add_simulate(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("simulate", "Moves the guides of a groom: gravity, wind, a head that moves");
  const auto o = std::make_shared<SimulateVerb>();
  SimulationSettings& s = o->settings;
  verb->add_option("GROOM", o->in, "Groom with levels of detail, from `pelage lod build`")->type_name("FILE")->required();
  verb->add_option("-o,--output", o->out, "Groom that moves: .pelage")->type_name("FILE")->required();
  verb->add_option("--frames", o->frames, "First and last frame, or how many")->type_name("A-B")->capture_default_str();
  verb->add_option("--fps", s.frame_rate, "Frames a second")->type_name("N")->capture_default_str();
  verb->add_option("--motion", o->motion,
                   "Of the head: still, nod, turn, walk, or a JSON file of keyframes (docs/simulation.md)")
      ->type_name("NAME")
      ->capture_default_str();
  CLI::Option* mesh = verb->add_option("--mesh", o->mesh,
                                       "Head that hair keeps out of, in meters; else the mannequin below hair that grew on it")
                          ->type_name("FILE");
  verb->add_flag("--no-head", o->no_head, "Nothing to keep out of")->excludes(mesh);
  verb->add_option("--head-cells", o->head_cells, "Cells of the head's distance field along its longest side, 8 to 512")
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--wind", o->wind, "Direction and speed, m/s: three numbers")
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z");
  verb->add_option("--gusts", s.gusts, "By what share of its speed the wind varies")->type_name("X")->capture_default_str();
  verb->add_option("--gust-size", s.gust_size, "Meters from gust to gust")->type_name("M")->capture_default_str();
  verb->add_option("--seed", s.seed, "Of the gusts")->type_name("N")->capture_default_str();
  verb->add_option("--gravity", o->gravity, "m/s², three numbers; 0,-9.81,0")->expected(3)->delimiter(',')->type_name("X,Y,Z");
  verb->add_option("--preroll", s.preroll, "Seconds that wind blows before the first frame")
      ->type_name("S")
      ->capture_default_str();
  add_rod_options(*verb, s);
  add_machine_options(*verb);
  verb->footer(
      "Example:\n"
      "  pelage grow wavy -o wavy.pelage\n"
      "  pelage lod build wavy.pelage -o wavy_lod.pelage\n"
      "  pelage simulate wavy_lod.pelage -o animated.pelage --frames 1-48 --motion nod --wind 2,0,0\n"
      "  pelage render animated.pelage --frames 1-48 -o nod.####.png");
  verb->callback([o] { run(*o); });
}

}  // namespace pelage::cli
