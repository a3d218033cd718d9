// pelage fit hairmesh: a hair mesh for a groom that has none.
#include <fmt/format.h>
#include <pelage/hair_mesh_fit.h>
#include <pelage/io.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "import_options.h"
#include "io/atomic_file.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct FitVerb {
  std::string in, out;
  HairMeshFitSettings settings;
  ImportOptions import;
  bool no_operators = false, no_occlusion = false, json = false;
};

/// Before the long work: the name, and whether it can be written.
void check_output(const std::string& path) {
  if (!path.ends_with(".hairmesh") && !path.ends_with(".json"))
    throw UsageError("--output", path, "hair meshes are .hairmesh or .json", "call it name.hairmesh");
  const io::AtomicFile probe(path);
}

void print_json(const FitVerb& verb, const HairMeshFitReport& r, std::uintmax_t bytes_in, std::uintmax_t bytes_out) {
  const Json json{{"input", verb.in},
                  {"output", verb.out},
                  {"strands", r.strands},
                  {"sampled", r.sampled},
                  {"bundles", r.bundles},
                  {"layers", r.layers},
                  {"vertices", r.vertices},
                  {"styles", r.styles},
                  {"size_m", r.size},
                  {"base_rms_m", r.base_rms},
                  {"base_p95_m", r.base_p95},
                  {"slow_rms_m", r.slow_rms},
                  {"fast_rms_m", r.fast_rms},
                  {"operator_rms_m", r.operator_rms},
                  {"silhouette_overlap", r.silhouette_overlap},
                  {"bytes_in", bytes_in},
                  {"bytes_out", bytes_out}};
  fmt::print("{}\n", json.dump(2));
}

void print_report(const FitVerb& verb, const HairMeshFitReport& r, std::uintmax_t bytes_in, std::uintmax_t bytes_out) {
  fmt::print("{}: {} strands in {} bundles of {} layers, {} styles; {} bytes for {}, 1 to {:.0f}\n", verb.out, r.strands,
             r.bundles, r.layers, r.styles, bytes_out, bytes_in,
             static_cast<double>(bytes_in) / static_cast<double>(bytes_out));
  fmt::print("  strands to their base   {:.2f} mm rms, {:.2f} mm at 95 % ({:.2f} % and {:.2f} % of the groom's size)\n",
             1e3 * r.base_rms, 1e3 * r.base_p95, 100 * r.base_rms / r.size, 100 * r.base_p95 / r.size);
  fmt::print("  of that                 {:.2f} mm slow, {:.2f} mm curls and frizz\n", 1e3 * r.slow_rms, 1e3 * r.fast_rms);
  fmt::print("  operators move strands  {:.2f} mm rms\n", 1e3 * r.operator_rms);
  fmt::print("  silhouettes overlap     {:.1f} %\n", 100 * r.silhouette_overlap);
}

void fit_hairmesh(const FitVerb& verb) {
  check_output(verb.out);
  HairMeshFitSettings settings = verb.settings;
  settings.operators = !verb.no_operators, settings.occlusion = !verb.no_occlusion;
  HairMeshFitReport report;
  {
    ProgressLine line;
    ImportReport import;
    const StrandSet groom = read_strands(verb.in, verb.import, &import, line.callback());
    const std::string summary = import_summary(import);
    const HairMesh mesh = fit_hair_mesh(groom, settings, &report, line.callback());
    write_hair_mesh(verb.out, mesh);
    fmt::print(stderr, "{}", summary);
  }
  const auto bytes_in = std::filesystem::file_size(verb.in), bytes_out = std::filesystem::file_size(verb.out);
  if (verb.json) print_json(verb, report, bytes_in, bytes_out);
  else print_report(verb, report, bytes_in, bytes_out);
}

}  // namespace

void add_fit(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("fit", "Fit a compact description to a groom");
  verb->require_subcommand(1);
  CLI::App* mesh = verb->add_subcommand("hairmesh", "A hair mesh of a few kilobytes, and how near it comes");
  const auto o = std::make_shared<FitVerb>();
  HairMeshFitSettings& s = o->settings;
  mesh->add_option("GROOM", o->in, "Groom in any format that is read")->type_name("FILE")->required();
  mesh->add_option("-o,--output", o->out, "Hair mesh to write: .hairmesh, or .json as text")->type_name("FILE")->required();
  mesh->add_option("--bytes", s.bytes, "Size of the file, about; decides the number of bundles")->type_name("N");
  mesh->add_option("--bundles", s.bundles, "Bundles instead, up to 65536")->type_name("N");
  mesh->add_option("--layers", s.layers, "Vertices along a strand, 2 to 64")->type_name("N");
  mesh->add_option("--styles", s.styles, "Styles that bundles share, 1 to 64")->type_name("N");
  mesh->add_option("--sample", s.sample, "Strands that are looked at, up to 1,000,000")->type_name("N");
  mesh->add_option("--seed", s.seed, "Of clusters and of new strands")->type_name("N");
  mesh->add_flag("--no-operators", o->no_operators, "The cage alone: smooth strands");
  mesh->add_flag("--no-occlusion", o->no_occlusion, "Without ambient occlusion");
  mesh->add_flag("--json", o->json, "Print JSON; distances in meters");
  add_import_options(*mesh, o->import);
  add_machine_options(*mesh);
  mesh->footer(
      "Example:\n"
      "  pelage grow wavy -o wavy.pelage\n"
      "  pelage fit hairmesh wavy.pelage -o wavy.hairmesh --bytes 40000\n"
      "  pelage render wavy.hairmesh -o wavy.png");
  mesh->callback([o] { fit_hairmesh(*o); });
}

}  // namespace pelage::cli
