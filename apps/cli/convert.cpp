// pelage convert IN OUT: a groom, a hair mesh or a mesh in another format, in meters and Y up.
#include <fmt/format.h>
#include <pelage/pelage.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "import_options.h"
#include "io/byte_source.h"
#include "io/file_kind.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

struct Options {
  std::string in, out, format;
  ExpandSettings expand;
  bool exact = false;
  ImportOptions import;
};

// Whether the strands were read as they are stored, so that what the file says about them holds.
bool as_in_its_file(const ImportReport& report) {
  return report.scale == 1.f && report.up == UpAxis::kY && report.repairs.clean();
}

void convert_groom(const Options& options) {
  ImportReport report;
  ProgressLine line;
  const StrandSet set = read_strands(options.in, options.import, &report, line.callback());
  const LodHierarchy lod = read_lod(options.in);
  const bool keep = !lod.empty() && options.out.ends_with(".pelage") && options.format.empty() && as_in_its_file(report);
  std::vector<std::string> lost;
  if (keep) write_lod(options.out, set, lod, line.callback());
  else lost = write_strands(options.out, set, options.format, line.callback());
  if (!keep && !lod.empty()) lost.emplace_back("levels of detail are not kept; pelage lod build makes them again");
  fmt::print(stderr, "{}: {} strands, {} points\n{}", options.out, set.strand_count(), set.point_count(),
             import_summary(report));
  for (const std::string& sentence : lost) fmt::print(stderr, "  {}\n", sentence);
}

// To another file of hair meshes, or to the strands that it stands for.
void convert_hair_mesh(const Options& options) {
  const HairMesh mesh = read_hair_mesh(options.in);
  if (options.format.empty() && (options.out.ends_with(".hairmesh") || options.out.ends_with(".json"))) {
    write_hair_mesh(options.out, mesh, {.float_positions = options.exact, .wide_attributes = options.exact});
    fmt::print(stderr, "{}: {} strands in {} bundles, {} bytes\n", options.out, strand_count(mesh), mesh.bundles.size(),
               std::filesystem::file_size(options.out));
    return;
  }
  ProgressLine line;
  const StrandSet set = expand(mesh, options.expand, line.callback());
  const std::vector<std::string> lost = write_strands(options.out, set, options.format, line.callback());
  fmt::print(stderr, "{}: {} strands, {} points\n", options.out, set.strand_count(), set.point_count());
  for (const std::string& sentence : lost) fmt::print(stderr, "  {}\n", sentence);
}

void convert_mesh(const Options& options) {
  const float scale = options.import.scale > 0 ? options.import.scale : 1;
  const TriangleMesh mesh = read_mesh(options.in, scale, options.import.up == UpAxis::kZ ? UpAxis::kZ : UpAxis::kY);
  write_mesh(options.out, mesh);
  fmt::print(stderr, "{}: {} triangles, {} vertices\n", options.out, mesh.triangles.size(), mesh.positions.size());
}

void run(const Options& options) {
  switch (io::file_kind(io::ByteSource::open(options.in)).content) {
    case io::FileContent::kMesh: return convert_mesh(options);
    case io::FileContent::kImage: throw Error(options.in, "", "an image", "convert takes grooms, hair meshes and meshes");
    case io::FileContent::kHairMesh: return convert_hair_mesh(options);
    case io::FileContent::kGroom: return convert_groom(options);
  }
}

std::string known_formats() {
  std::string names;
  for (const FormatInfo& format : strand_formats())
    if (format.writes) names += fmt::format("{}{}", names.empty() ? "" : ", ", format.name);
  return names;
}

}  // namespace

void add_convert(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("convert", "Writes a groom, a hair mesh or a mesh in another format");
  verb->footer(
      "Examples:\n  pelage convert hair.tfx hair.pelage\n  pelage convert model.hair model.data --scale 0.01 --up z\n"
      "  pelage convert bob.hairmesh bob.json\n  pelage convert bob.hairmesh bob.pelage --points 127 --share 0.5");
  verb->add_option("in", options->in, "Groom, hair mesh or mesh")->required()->type_name("FILE");
  verb->add_option("out", options->out, "File to write; its extension names the format")->required()->type_name("FILE");
  verb->add_option("--format", options->format, "Groom format to write, whatever the extension: " + known_formats())
      ->type_name("NAME");
  verb->add_option("--points", options->expand.points, "Hair mesh to strands: control points a strand, 2 to 127")
      ->type_name("N");
  verb->add_option("--share", options->expand.share, "Hair mesh to strands: share of the strands of each bundle, 0 to 1")
      ->type_name("X");
  verb->add_flag("--exact", options->exact, "To .hairmesh: positions as floats, other values in 16 bits");
  add_import_options(*verb, options->import);
  add_machine_options(*verb);
  verb->callback([options] { run(*options); });
}

}  // namespace pelage::cli
