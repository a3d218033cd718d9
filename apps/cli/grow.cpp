// pelage grow: makes hair from a seed, as strands or as a hair mesh, and knitted cloth.
#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>
#include <pelage/knit.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/hair_mesh_formats.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

struct Change {
  const char* option;
  std::function<void(GrowSettings&)> apply;
};
using KnitChange = std::function<void(KnitSettings&)>;

struct GrowOptions {
  std::string style, output, mesh, head_output;
  bool hair_mesh = false, hair_mesh_schema = false;
  float length_scale = 1;
  float mesh_scale = 1;
  UpAxis mesh_up = UpAxis::kY;
  std::vector<Change> changes;           // to the style's defaults, as typed
  std::vector<KnitChange> knit_changes;  // to those of knitted cloth
};

using OptionsPtr = std::shared_ptr<GrowOptions>;

// --name VALUE for a field of GrowSettings.
template <class T>
void add_setting(CLI::App& verb, const OptionsPtr& options, const char* name, T GrowSettings::*field, const char* type,
                 const char* help) {
  verb.add_option_function<T>(
          name,
          [options, field, name](T value) {
            options->changes.push_back({name, [=](GrowSettings& s) { s.*field = value; }});
          },
          help)
      ->type_name(type)
      ->group("Hair");
}

void add_settings(CLI::App& verb, const OptionsPtr& options) {
  const auto count = [&](const char* name, int GrowSettings::*field, const char* help) {
    add_setting(verb, options, name, field, "N", help);
  };
  const auto meters = [&](const char* name, float GrowSettings::*field, const char* help) {
    add_setting(verb, options, name, field, "M", help);
  };
  const auto share = [&](const char* name, float GrowSettings::*field, const char* help) {
    add_setting(verb, options, name, field, "X", help);
  };
  count("--strands", &GrowSettings::strands, "Number of strands, up to 1,000,000");
  count("--points", &GrowSettings::points, "Control points a strand, 4 to 1024");
  add_setting(verb, options, "--seed", &GrowSettings::seed, "N", "Another seed is another head of hair");
  meters("--length", &GrowSettings::length, "Mean length of a strand, meters");
  share("--length-variation", &GrowSettings::length_variation, "Standard deviation as a share of the length, 0 to 0.5");
  meters("--width", &GrowSettings::width, "Mean diameter at the root, meters; human hair is 5e-5 to 1e-4");
  share("--width-variation", &GrowSettings::width_variation, "Standard deviation as a share of the width, 0 to 0.5");
  share("--taper", &GrowSettings::taper, "Share of the width that is gone at the tip, 0 to 1");
  meters("--curl-radius", &GrowSettings::curl_radius, "Mean radius of curls or amplitude of waves, meters; 0 for none");
  meters("--curl-pitch", &GrowSettings::curl_pitch, "Mean distance along a lock in which it turns once, meters");
  count("--clumps", &GrowSettings::clumps, "Number of locks; 0 for none");
  share("--clump-tightness", &GrowSettings::clump_tightness, "0 for none, 1 for tips that meet");
  share("--frizz", &GrowSettings::frizz, "0 combed to 1 unruly");
  share("--flyaways", &GrowSettings::flyaways, "Share of strands that leave their lock, 0 to 1");
  share("--gravity", &GrowSettings::gravity, "0 stands, 1 hangs");
  meters("--volume", &GrowSettings::volume, "How far hair of the crown piles up, meters");
  meters("--parting", &GrowSettings::parting, "Meters left of the head's middle, -0.05 to 0.05");
  share("--undercoat", &GrowSettings::undercoat, "Coat: share of short, fine wool between the guard hairs, 0 to 1");
}

// --name VALUE for a field of KnitSettings.
template <class T>
void add_knit_setting(CLI::App& verb, const OptionsPtr& options, const char* name, T KnitSettings::*field, const char* type,
                      const char* help) {
  verb.add_option_function<T>(
          name, [options, field](T value) { options->knit_changes.push_back([=](KnitSettings& s) { s.*field = value; }); },
          help)
      ->type_name(type)
      ->group("Knitted cloth, with --strands, --points and --seed");
}

void add_knit_settings(CLI::App& verb, const OptionsPtr& options) {
  const auto share = [&](const char* name, float KnitSettings::*field, const char* help) {
    add_knit_setting(verb, options, name, field, "X", help);
  };
  add_knit_setting(verb, options, "--wales", &KnitSettings::wales, "N", "Columns of stitches, 1 to 1000");
  add_knit_setting(verb, options, "--courses", &KnitSettings::courses, "N", "Rows of stitches, 1 to 1000");
  add_knit_setting(verb, options, "--yarn", &KnitSettings::yarn, "M",
                   "Diameter of the yarn, meters; a stitch is 3.3 wide and 2.5 high");
  add_knit_setting(verb, options, "--plies", &KnitSettings::plies, "N", "Plies of a yarn, 1 to 16");
  share("--ply-pitch", &KnitSettings::ply_pitch, "Diameters of the yarn along which its plies turn once, 1 to 1000");
  share("--fiber-pitch", &KnitSettings::fiber_pitch, "The same of the fibers of a ply, which turn the other way");
  share("--packing", &KnitSettings::packing, "Share of a ply's section that fibers take, 0.01 to 1: how thick they are");
  share("--migration", &KnitSettings::migration,
        "Share of their distance from a ply's middle that fibers give up on their way, 0 to 1");
  share("--irregularity", &KnitSettings::irregularity, "Unevenness of the cloth, diameters of the yarn, 0 to 0.5");
}

// Throws UsageError at the first change of hair that is none of `shared`.
template <std::size_t N>
void allow_only(const GrowOptions& options, const std::array<const char*, N>& shared, const char* problem, const char* remedy) {
  for (const Change& change : options.changes)
    if (std::none_of(shared.begin(), shared.end(), [&](const char* name) { return std::string(name) == change.option; }))
      throw UsageError(change.option, "", problem, remedy);
}

GrowSettings settings_of(const GrowOptions& options) {
  GrowSettings settings = grow_defaults(hair_style_from_name(options.style));
  for (const Change& change : options.changes) change.apply(settings);
  return settings;
}

// The settings of a hair mesh that go by the same words.
HairMeshSettings hair_mesh_settings_of(const GrowOptions& options) {
  allow_only(options, std::array{"--strands", "--seed", "--width", "--parting"}, "not a setting of hair meshes",
             "theirs are --strands, --seed, --width, --parting and --length-scale");
  HairMeshSettings settings;
  settings.style = hair_mesh_style_from_name(options.style);
  settings.length = options.length_scale;
  GrowSettings words;
  words.strands = static_cast<int>(settings.strands), words.width = settings.width, words.parting = settings.parting;
  for (const Change& change : options.changes) change.apply(words);
  settings.strands = static_cast<std::uint32_t>(std::max(words.strands, 0));
  settings.seed = static_cast<std::uint32_t>(words.seed);
  settings.width = words.width, settings.parting = words.parting;
  return settings;
}

void hair_mesh_verb(const GrowOptions& options) {
  const HairMeshSettings settings = hair_mesh_settings_of(options);
  if (!options.mesh.empty())
    throw UsageError("--mesh", options.mesh, "hair meshes are made for the mannequin", "leave it away");
  HairMesh mesh;
  {
    ProgressLine progress;
    mesh = make_hair_mesh(settings, progress.callback());
  }
  write_hair_mesh(options.output, mesh);
  if (!options.head_output.empty()) write_mesh(options.head_output, mannequin_head());
  fmt::print("{}: {} strands in {} bundles, {} bytes\n", options.output, strand_count(mesh), mesh.bundles.size(),
             std::filesystem::file_size(options.output));
}

bool is_knit(const std::string& style) { return style.starts_with("knit"); }

KnitSettings knit_settings_of(const GrowOptions& options) {
  allow_only(options, std::array{"--strands", "--points", "--seed"}, "not a setting of knitted cloth",
             "pelage grow --help lists them");
  if (!options.mesh.empty() || !options.head_output.empty())
    throw UsageError("--mesh", "", "cloth is not grown on a surface", "leave it away");
  KnitSettings settings;
  settings.pattern = knit_pattern_from_name(options.style);
  GrowSettings words;
  words.strands = settings.strands, words.points = settings.points, words.seed = settings.seed;
  for (const Change& change : options.changes) change.apply(words);
  settings.strands = words.strands, settings.points = words.points, settings.seed = words.seed;
  for (const KnitChange& change : options.knit_changes) change(settings);
  return settings;
}

StrandSet grow_strands(const GrowOptions& options, const Progress& progress) {
  if (is_knit(options.style)) return grow_knit(knit_settings_of(options), progress);
  if (!options.knit_changes.empty())
    throw UsageError("--wales and the like", "", "settings of knitted cloth", "pelage grow " + knit_pattern_names()[0]);
  const GrowSettings settings = settings_of(options);
  const TriangleMesh surface =
      options.mesh.empty() ? mannequin_head() : read_mesh(options.mesh, options.mesh_scale, options.mesh_up);
  StrandSet strands = grow(settings, surface, progress);
  if (!options.head_output.empty()) write_mesh(options.head_output, surface);
  return strands;
}

void grow_verb(const GrowOptions& options) {
  if (options.hair_mesh_schema) return void(fmt::print("{}", io::hair_mesh_schema()));
  if (options.style.empty()) throw UsageError("STYLE", "", "missing", "pelage grow --help lists them");
  if (options.output.empty()) throw UsageError("--output", "", "missing", "name the file to write");
  if (options.hair_mesh) return hair_mesh_verb(options);
  StrandSet strands;
  std::vector<std::string> losses;
  {
    ProgressLine progress;
    strands = grow_strands(options, progress.callback());
    losses = write_strands(options.output, strands, "", progress.callback());
  }
  for (const std::string& loss : losses) fmt::print(stderr, "pelage: {}: {}\n", options.output, loss);
  fmt::print("{}: {} strands, {} points\n", options.output, strands.strand_count(), strands.point_count());
}

}  // namespace

static std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void add_grow(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("grow", "Make hair, or knitted cloth, from a seed");
  const auto options = std::make_shared<GrowOptions>();
  verb->add_option("STYLE", options->style,
                   "One of " + listed(hair_style_names()) + ", or cloth: " + listed(knit_pattern_names()) +
                       "; with --hair-mesh one of " + listed(hair_mesh_style_names()));
  verb->add_option("-o,--output", options->output, "Groom to write; the extension decides the format")->type_name("FILE");
  verb->add_flag("--hair-mesh", options->hair_mesh,
                 "Make a hair mesh, a few kilobytes from which strands are made when they are drawn: .hairmesh or .json");
  verb->add_option("--length-scale", options->length_scale, "Hair mesh: length as a share of the style's own, 0.5 to 1.5")
      ->type_name("X");
  verb->add_flag("--hair-mesh-schema", options->hair_mesh_schema, "Prints the JSON schema of hair meshes as text, and stops");
  verb->add_option("--mesh", options->mesh, "Surface to grow on instead of the mannequin's scalp")->type_name("FILE");
  verb->add_option("--mesh-scale", options->mesh_scale, "Meters per unit of the mesh")->type_name("X");
  verb->add_option("--mesh-up", options->mesh_up, "Axis of the mesh that points up")
      ->transform(CLI::CheckedTransformer(std::vector<std::pair<std::string, UpAxis>>{{"y", UpAxis::kY}, {"z", UpAxis::kZ}}))
      ->type_name("y|z");
  verb->add_option("--write-mesh", options->head_output, "Also write the surface, in meters, to FILE")->type_name("FILE");
  add_settings(*verb, options);
  add_knit_settings(*verb, options);
  add_machine_options(*verb);
  verb->footer(
      "Settings that are not given come from the style.\n\n"
      "Examples:\n"
      "  pelage grow curly -o curly.pelage\n"
      "  pelage grow straight --strands 100000 --length 0.4 --seed 7 -o long.pelage --write-mesh head.obj\n"
      "  pelage grow coat --mesh spot.obj --strands 200000 -o spot.pelage\n"
      "  pelage grow knit-rib --strands 80000 --wales 16 -o rib.pelage\n"
      "  pelage grow --hair-mesh bob -o bob.hairmesh");
  verb->callback([options] { grow_verb(*options); });
}

}  // namespace pelage::cli
