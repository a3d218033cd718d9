// pelage info FILE…: what a file holds, what the reader assumed and what it repaired.
#include <fmt/format.h>
#include <pelage/pelage.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "import_options.h"
#include "io/byte_source.h"
#include "io/file_kind.h"
#include "lod_table.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Spread {
  double least = 0, mean = 0, most = 0;
};

// Lengths of the control polygons; the curves are a little shorter or longer.
Spread strand_lengths(const StrandSet& set) {
  Spread spread{INFINITY, 0, 0};
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    double sum = 0;
    for (std::uint32_t i = set.offsets[s] + 1; i < set.offsets[s + 1]; ++i)
      sum += static_cast<double>(length(set.points[i] - set.points[i - 1]));
    spread.least = std::min(spread.least, sum), spread.most = std::max(spread.most, sum), spread.mean += sum;
  }
  spread.mean /= static_cast<double>(set.strand_count());
  return spread;
}

Spread strand_widths(const StrandSet& set) {
  Spread spread{INFINITY, 0, 0};
  for (const float width : set.widths) {
    const auto w = static_cast<double>(width);
    spread.least = std::min(spread.least, w), spread.most = std::max(spread.most, w), spread.mean += w;
  }
  spread.mean /= static_cast<double>(set.widths.size());
  return spread;
}

Spread points_per_strand(const StrandSet& set) {
  Spread spread{INFINITY, static_cast<double>(set.point_count()) / static_cast<double>(set.strand_count()), 0};
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    const double n = set.offsets[s + 1] - set.offsets[s];
    spread.least = std::min(spread.least, n), spread.most = std::max(spread.most, n);
  }
  return spread;
}

const char* basis_name(CurveBasis basis) {
  switch (basis) {
    case CurveBasis::kLinear: return "linear";
    case CurveBasis::kCatmullRom: return "catmull-rom";
    case CurveBasis::kBSpline: return "b-spline";
    case CurveBasis::kBezier: return "bezier";
  }
  return "";
}

const char* up_name(UpAxis up) { return up == UpAxis::kZ ? "z" : "y"; }

std::vector<std::string> attributes(const StrandSet& set) {
  std::vector<std::string> names;
  const auto add = [&](bool present, const char* name) {
    if (present) names.emplace_back(name);
  };
  add(set.widths.size() > 1, "widths");
  add(!set.colors.empty(), set.colors.size() == set.point_count() ? "point colors" : "strand colors");
  add(!set.transparency.empty(), "transparency");
  add(!set.root_uv.empty(), "root uv");
  add(!set.strand_id.empty(), "strand ids");
  add(!set.guide_id.empty(), "guide ids");
  add(!set.group.empty(), "groups");
  return names;
}

Json to_json(Vec3 v) { return Json::array({v.x, v.y, v.z}); }
Json to_json(const Bounds& b) { return {{"lower", to_json(b.lower)}, {"upper", to_json(b.upper)}}; }
Json to_json(const Spread& s) { return {{"min", s.least}, {"mean", s.mean}, {"max", s.most}}; }

Json to_json(const RepairReport& r) {
  return {{"clean", r.clean()},
          {"summary", r.summary()},
          {"non_finite_points", r.non_finite_points},
          {"short_strands", r.short_strands},
          {"zero_length_segments", r.zero_length_segments},
          {"degenerate_strands", r.degenerate_strands},
          {"partial_spans", r.partial_spans},
          {"bad_widths", r.bad_widths},
          {"bad_attributes", r.bad_attributes},
          {"dropped", r.dropped}};
}

Json to_json(const GuideAnimation& a, std::size_t guides) {
  return {{"first_frame", a.first_frame},
          {"last_frame", a.last_frame()},
          {"frame_rate", a.frame_rate},
          {"guides", guides},
          {"bytes", a.guides.size() * sizeof(Vec3) + a.head.size() * sizeof(Affine)}};
}

Json groom_info(const std::string& path, const ImportOptions& options) {
  ImportReport report;
  ProgressLine line;
  const StrandSet set = read_strands(path, options, &report, line.callback());
  Json json{{"kind", "groom"},
            {"format", report.format},
            {"strands", set.strand_count()},
            {"points", set.point_count()},
            {"points_per_strand", to_json(points_per_strand(set))},
            {"basis", basis_name(set.basis)},
            {"bounds", to_json(bounds(set))},
            {"lengths", to_json(strand_lengths(set))},
            {"widths", to_json(strand_widths(set))},
            {"scale", report.scale},
            {"scale_guessed", report.scale_guessed},
            {"up", up_name(report.up)},
            {"up_guessed", report.up_guessed},
            {"width_guessed", report.width_guessed},
            {"attributes", attributes(set)},
            {"comment", set.comment},
            {"bytes", resident_bytes(set)},
            {"repairs", to_json(report.repairs)},
            {"notes", report.notes}};
  if (const LodHierarchy lod = read_lod(path, line.callback()); !lod.empty()) {
    json["lod"] = lod_json(lod, set);
    if (lod.animation) json["animation"] = to_json(*lod.animation, lod.guide_count());
  }
  return json;
}

Json to_json(const StyleOperator& o) {
  return {{"kind", style_operator_names()[static_cast<std::size_t>(o.kind)]},
          {"amount", o.amount},
          {"frequency", o.frequency},
          {"start", o.start},
          {"variation", o.variation}};
}

Json hair_mesh_info(const std::string& path, const std::string& format) {
  const HairMesh mesh = read_hair_mesh(path);
  std::uint32_t fewest = HairMesh::kMaxLayers, most = 0;
  for (const HairMesh::Bundle& b : mesh.bundles)
    fewest = std::min(fewest, mesh.layers(b)), most = std::max(most, mesh.layers(b));
  Json styles = Json::array();
  for (const auto& style : mesh.styles) {
    Json operators = Json::array();
    for (const StyleOperator& o : style) operators.push_back(to_json(o));
    styles.push_back(operators);
  }
  return {{"kind", "hair mesh"},
          {"format", format},
          {"strands", strand_count(mesh)},
          {"bundles", mesh.bundles.size()},
          {"columns", mesh.column_count()},
          {"vertices", mesh.vertex_count()},
          {"layers", {{"min", fewest}, {"max", most}}},
          {"tangents", !mesh.tangents.empty()},
          {"occlusion", !mesh.occlusion.empty()},
          {"width", mesh.width},
          {"bounds", to_json(bounds(mesh))},
          {"styles", styles},
          {"comment", mesh.comment},
          {"bytes", resident_bytes(mesh)}};
}

Json mesh_info(const std::string& path, const ImportOptions& options, const std::string& format) {
  const float scale = options.scale > 0 ? options.scale : 1;
  const TriangleMesh mesh = read_mesh(path, scale, options.up == UpAxis::kZ ? UpAxis::kZ : UpAxis::kY);
  return {{"kind", "mesh"},
          {"format", format},
          {"triangles", mesh.triangles.size()},
          {"vertices", mesh.positions.size()},
          {"uv", !mesh.uv.empty()},
          {"bounds", to_json(bounds(mesh))},
          {"scale", scale},
          {"up", up_name(options.up)}};
}

Json image_info(const std::string& path, const std::string& format) {
  const Image image = read_image(path, false);
  float least = INFINITY, most = -INFINITY;
  std::size_t non_finite = 0;
  for (const float x : image.pixels) {
    non_finite += !std::isfinite(x);
    if (std::isfinite(x)) least = std::min(least, x), most = std::max(most, x);
  }
  return {
      {"kind", "image"}, {"format", format}, {"width", image.width},    {"height", image.height}, {"channels", image.channels},
      {"min", least},    {"max", most},      {"non_finite", non_finite}};
}

Json info(const std::string& path, const ImportOptions& options) {
  const io::FileKind kind = io::file_kind(io::ByteSource::open(path));
  Json json = kind.content == io::FileContent::kImage      ? image_info(path, kind.format)
              : kind.content == io::FileContent::kMesh     ? mesh_info(path, options, kind.format)
              : kind.content == io::FileContent::kHairMesh ? hair_mesh_info(path, kind.format)
                                                           : groom_info(path, options);
  json["file"] = path;
  json["file_bytes"] = std::filesystem::file_size(path);
  return json;
}

// 1234567 → 1,234,567
std::string grouped(std::size_t n) {
  std::string text = fmt::format("{}", n);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

// A length in meters, in the unit that reads best.
std::string metric(double meters) {
  const double size = std::fabs(meters);
  if (size < 1e-3) return fmt::format("{:.3g} µm", meters * 1e6);
  if (size < 1e-2) return fmt::format("{:.3g} mm", meters * 1e3);
  if (size < 1) return fmt::format("{:.3g} cm", meters * 1e2);
  return fmt::format("{:.3g} m", meters);
}

std::string size_of_file(std::size_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  if (bytes < 1024 * 1024) return fmt::format("{:.1f} KiB", static_cast<double>(bytes) / 1024);
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024 * 1024));
}

void row(const char* name, const std::string& value) { fmt::print("  {:<12} {}\n", name, value); }

std::string spread_text(const Json& spread) {
  if (spread["min"] == spread["max"]) return metric(spread["mean"]);
  return fmt::format("{} to {}, mean {}", metric(spread["min"]), metric(spread["max"]), metric(spread["mean"]));
}

std::string bounds_text(const Json& box) {
  const auto lower = box["lower"].get<std::array<double, 3>>(), upper = box["upper"].get<std::array<double, 3>>();
  return fmt::format("{} × {} × {}  from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", metric(upper[0] - lower[0]),
                     metric(upper[1] - lower[1]), metric(upper[2] - lower[2]), lower[0], lower[1], lower[2], upper[0], upper[1],
                     upper[2]);
}

void print_groom(const Json& json) {
  const Json& per = json["points_per_strand"];
  const auto least = per["min"].get<std::size_t>(), most = per["max"].get<std::size_t>();
  row("strands", grouped(json["strands"]));
  row("points", fmt::format("{} ({} a strand)", grouped(json["points"]),
                            least == most ? fmt::format("{}", least)
                                          : fmt::format("{} to {}, mean {:.1f}", least, most, per["mean"].get<double>())));
  row("curves", json["basis"].get<std::string>());
  row("size", bounds_text(json["bounds"]));
  row("lengths", spread_text(json["lengths"]));
  row("widths", fmt::format("{}{}", spread_text(json["widths"]), json["width_guessed"] ? " (assumed)" : ""));
  row("units", fmt::format("1 unit = {} m{}", json["scale"].get<float>(), json["scale_guessed"] ? " (guessed)" : ""));
  row("up", fmt::format("{}{}", json["up"] == "z" ? "Z, turned to Y" : "Y", json["up_guessed"] ? " (guessed)" : ""));
  std::string names;
  for (const Json& name : json["attributes"]) names += fmt::format("{}{}", names.empty() ? "" : ", ", name.get<std::string>());
  row("attributes", names.empty() ? "none" : names);
  if (json["comment"] != "") row("comment", json["comment"]);
  row("repairs", json["repairs"]["summary"]);
  row("memory", size_of_file(json["bytes"]));
  for (const Json& note : json["notes"]) row("note", note);
  if (json.contains("animation")) {
    const Json& a = json["animation"];
    row("animation",
        fmt::format("frames {} to {}, {:g} a second, {} guides, {}", a["first_frame"].get<int>(), a["last_frame"].get<int>(),
                    a["frame_rate"].get<double>(), a["guides"].get<std::size_t>(), size_of_file(a["bytes"])));
  }
  if (!json.contains("lod")) return;
  const char* name = "thick hairs";
  for (const std::string& text : lod_rows(json["lod"])) row(std::exchange(name, ""), text);
}

void print_mesh(const Json& json) {
  row("triangles", grouped(json["triangles"]));
  row("vertices", grouped(json["vertices"]) + (json["uv"] ? ", with texture coordinates" : ""));
  row("size", bounds_text(json["bounds"]));
}

void print_image(const Json& json) {
  std::string channels;
  for (const Json& name : json["channels"])
    channels += fmt::format("{}{}", channels.empty() ? "" : ", ", name.get<std::string>());
  row("pixels", fmt::format("{} × {}", json["width"].get<int>(), json["height"].get<int>()));
  row("channels", channels);
  row("values", fmt::format("{:.4g} to {:.4g}", json["min"].is_null() ? 0. : json["min"].get<double>(),
                            json["max"].is_null() ? 0. : json["max"].get<double>()));
  if (json["non_finite"] != 0) row("note", fmt::format("{} values are not finite", grouped(json["non_finite"])));
}

// "curl amount 0.0075 frequency 8", without numbers that are 0.
std::string operator_text(const Json& o) {
  std::string text = o["kind"];
  for (const char* number : {"amount", "frequency", "start", "variation"})
    if (o[number] != 0) text += fmt::format(" {} {:.3g}", number, o[number].get<double>());
  return text;
}

void print_hair_mesh(const Json& json) {
  const auto least = json["layers"]["min"].get<int>(), most = json["layers"]["max"].get<int>();
  row("strands", grouped(json["strands"]));
  row("bundles", fmt::format("{} between {} columns", grouped(json["bundles"]), grouped(json["columns"])));
  row("layers", least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most));
  row("vertices", fmt::format("{}, {} tangents, {} occlusion", grouped(json["vertices"]), json["tangents"] ? "with" : "without",
                              json["occlusion"] ? "with" : "without"));
  row("size", bounds_text(json["bounds"]));
  row("width", metric(json["width"]));
  for (std::size_t s = 0; s < json["styles"].size(); ++s)
    for (const Json& o : json["styles"][s]) row(fmt::format("style {}", s).c_str(), operator_text(o));
  if (json["comment"] != "") row("comment", json["comment"]);
  row("memory", size_of_file(json["bytes"]));
}

void print(const Json& json) {
  fmt::print("{}: {} {}, {}\n", json["file"].get<std::string>(), json["format"].get<std::string>(),
             json["kind"].get<std::string>(), size_of_file(json["file_bytes"]));
  if (json["kind"] == "groom") print_groom(json);
  if (json["kind"] == "hair mesh") print_hair_mesh(json);
  if (json["kind"] == "mesh") print_mesh(json);
  if (json["kind"] == "image") print_image(json);
}

struct Options {
  std::vector<std::string> files;
  ImportOptions import;
  bool json = false;
};

void run(const Options& options) {
  for (const std::string& file : options.files) {
    const Json json = info(file, options.import);
    if (options.json) fmt::print("{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
    else print(json);
  }
}

}  // namespace

void add_info(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("info", "Says what a groom, a hair mesh, a mesh or an image holds");
  verb->footer("Example:\n  pelage info hair.tfx --scale 0.01");
  verb->add_option("file", options->files, "Grooms, hair meshes, meshes or images")->required()->type_name("FILE");
  verb->add_flag("--json", options->json, "One JSON object a line, for machines");
  add_import_options(*verb, options->import);
  add_machine_options(*verb);
  verb->callback([options] { run(*options); });
}

}  // namespace pelage::cli
