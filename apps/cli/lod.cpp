// pelage lod build, pelage lod extract: chains of thick hairs for level of detail, and a look at them.
#include <fmt/format.h>
#include <pelage/io.h>
#include <pelage/lod.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "import_options.h"
#include "io/atomic_file.h"
#include "lod_table.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BuildVerb {
  std::string in, out;
  LodSettings settings;
  ImportOptions import;
  bool json = false;
};

struct ExtractVerb {
  std::string in, out;
  std::size_t level = 0;
};

/// Before the long work: the name, and whether it can be written.
void check_output(const std::string& path) {
  if (!path.ends_with(".pelage"))
    throw UsageError("--output", path, "levels of detail are stored in .pelage files only", "call it name.pelage");
  const io::AtomicFile probe(path);
}

void build(const BuildVerb& verb) {
  check_output(verb.out);
  StrandSet groom;
  LodHierarchy lod;
  ImportReport import;
  double seconds = 0;
  {
    ProgressLine line;
    groom = read_strands(verb.in, verb.import, &import, line.callback());
    const auto start = std::chrono::steady_clock::now();
    lod = build_lod(groom, verb.settings, line.callback());
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_lod(verb.out, groom, lod, line.callback());
  }
  fmt::print(stderr, "{}", import_summary(import));
  if (verb.json) {
    Json json = lod_json(lod, groom);
    json["input"] = verb.in, json["output"] = verb.out, json["seconds"] = seconds;
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{}: {} strands, {} levels of thick hairs in {:.1f} s\n", verb.out, groom.strand_count(), lod.levels(), seconds);
  for (const std::string& row : lod_rows(lod_json(lod, groom))) fmt::print("  {}\n", row);
  const bool more_to_divide = summarize(lod).back().most_fibers > 1;
  if (lod.levels() < verb.settings.levels && more_to_divide)
    fmt::print("  a finer level would take more than {:.0f} % of the groom's memory; --memory-share allows it\n",
               100 * verb.settings.memory_share);
}

void extract(const ExtractVerb& verb) {
  const LodHierarchy lod = read_lod(verb.in);
  if (lod.empty())
    throw Error(verb.in, "", "the file has no levels of detail",
                fmt::format("pelage lod build {} -o with_lod.pelage", verb.in));
  if (verb.level >= lod.levels())
    throw UsageError("--level", fmt::format("{}", verb.level), fmt::format("{} has {} levels", verb.in, lod.levels()),
                     fmt::format("levels are 0 (coarsest) to {}", lod.levels() - 1));
  const StrandSet set = extract_level(lod, verb.level);
  std::vector<std::string> lost;
  {
    ProgressLine line;
    lost = write_strands(verb.out, set, "", line.callback());
  }
  fmt::print("{}: {} thick hairs of level {}\n", verb.out, set.strand_count(), verb.level);
  for (const std::string& sentence : lost) fmt::print(stderr, "pelage: {}: {}\n", verb.out, sentence);
}

void add_build(CLI::App& lod) {
  CLI::App* verb = lod.add_subcommand("build", "Makes a chain of thick hairs for a groom, and writes both into one file");
  const auto o = std::make_shared<BuildVerb>();
  LodSettings& s = o->settings;
  verb->add_option("GROOM", o->in, "Groom in any format that is read")->type_name("FILE")->required();
  verb->add_option("-o,--output", o->out, "Groom with its levels of detail: .pelage")->type_name("FILE")->required();
  verb->add_option("--levels", s.levels, "Levels of thick hairs, at most, 1 to 16")->type_name("N")->capture_default_str();
  verb->add_option("--guides", s.guides,
                   "Guides, by which level 0 is grouped and all is moved; 0: those that the groom's strands name")
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--area-ratio", s.area_ratio, "By which cross-sections shrink from level to level, 1.5 to 64")
      ->type_name("X")
      ->capture_default_str();
  verb->add_option("--covered", s.covered, "Share of its fibers that a cross-section holds, 0.5 to 1")
      ->type_name("X")
      ->capture_default_str();
  verb->add_option("--memory-share", s.memory_share, "Of the groom's memory; no finer level beyond that, 0.01 to 100")
      ->type_name("X")
      ->capture_default_str();
  verb->add_option("--seed", s.seed, "Of the clusters")->type_name("N")->capture_default_str();
  verb->add_flag("--json", o->json, "Print JSON; lengths in meters");
  add_import_options(*verb, o->import);
  add_machine_options(*verb);
  verb->footer(
      "Example:\n"
      "  pelage grow wavy -o wavy.pelage\n"
      "  pelage lod build wavy.pelage -o wavy_lod.pelage --levels 5\n"
      "  pelage info wavy_lod.pelage");
  verb->callback([o] { build(*o); });
}

void add_extract(CLI::App& lod) {
  CLI::App* verb = lod.add_subcommand("extract", "Writes the thick hairs of one level as a groom of its own, to look at");
  const auto o = std::make_shared<ExtractVerb>();
  verb->add_option("GROOM", o->in, "Groom with levels of detail, from `pelage lod build`")->type_name("FILE")->required();
  verb->add_option("-o,--output", o->out, "Groom to write; the extension decides the format")->type_name("FILE")->required();
  verb->add_option("--level", o->level, "0 the coarsest; pelage info lists them")->type_name("K")->capture_default_str();
  add_machine_options(*verb);
  verb->footer(
      "Example:\n"
      "  pelage grow wavy -o wavy.pelage\n"
      "  pelage lod build wavy.pelage -o wavy_lod.pelage\n"
      "  pelage lod extract wavy_lod.pelage --level 1 -o level1.pelage\n"
      "  pelage render level1.pelage -o level1.png");
  verb->callback([o] { extract(*o); });
}

}  // namespace

void add_lod(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("lod", "Levels of detail: thick hairs that stand for many strands far away");
  verb->require_subcommand(1);
  add_build(*verb);
  add_extract(*verb);
}

}  // namespace pelage::cli
