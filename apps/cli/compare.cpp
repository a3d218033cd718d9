// pelage compare TEST REFERENCE: how far a picture, or a sequence, is from the one it should be.
#include <fmt/format.h>
#include <pelage/pelage.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/nearest.h"
#include "frame_files.h"
#include "picture_file.h"
#include "render.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareVerb {
  std::string test, reference, mask, tiles, tone_map;
  RenderOptions strands;  // its input is --strands
  std::vector<float> background;
  std::vector<std::string> regions, metrics, maps;
  std::vector<float> exposures;
  float pixels_per_degree = CompareOptions{}.pixels_per_degree, map_scale = 0;
  bool json = false, list = false;
};

struct MapFile {
  std::string key, path;
};

std::vector<std::string> metric_keys() {
  std::vector<std::string> keys;
  for (const Metric& metric : registered_metrics()) keys.push_back(metric.key);
  return keys;
}

bool is_metric(const std::string& key) {
  const std::vector<std::string> keys = metric_keys();
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

// METRIC=FILE, or a file that is called as its metric.
MapFile parse_map(const std::string& text) {
  const std::size_t equals = text.find('=');
  const MapFile map = equals == std::string::npos ? MapFile{std::filesystem::path(text).stem().string(), text}
                                                  : MapFile{text.substr(0, equals), text.substr(equals + 1)};
  if (is_metric(map.key)) return map;
  throw UsageError("--map", text,
                   fmt::format("`{}` is no metric; did you mean `{}`?", map.key, nearest_name(map.key, metric_keys())),
                   "METRIC=FILE, or a file called as the metric: flip.png");
}

// NAME=X,Y,WxH
Region parse_region(const std::string& text) {
  const std::size_t equals = text.find('=');
  PixelRect r;
  int end = 0;
  if (equals != std::string::npos && equals > 0 &&
      std::sscanf(text.c_str() + equals + 1, "%9d,%9d,%9dx%9d%n", &r.x, &r.y, &r.width, &r.height, &end) == 4 &&
      equals + 1 + static_cast<std::size_t>(end) == text.size())
    return {text.substr(0, equals), r};
  throw UsageError("--region", text, "not of the form NAME=X,Y,WxH", "e.g. fringe=400,120,200x80");
}

std::vector<Region> regions_of(const CompareVerb& o, int width, int height) {
  std::vector<Region> regions;
  if (!o.tiles.empty()) {
    int columns = 0, rows = 0, end = 0;
    if (std::sscanf(o.tiles.c_str(), "%6dx%6d%n", &columns, &rows, &end) != 2 ||
        static_cast<std::size_t>(end) != o.tiles.size())
      throw UsageError("--regions", o.tiles, "not of the form COLUMNSxROWS", "e.g. 4x3");
    regions = tile_regions(width, height, columns, rows);
  }
  for (const std::string& text : o.regions) regions.push_back(parse_region(text));
  return regions;
}

CompareOptions options_of(const CompareVerb& o, const std::vector<MapFile>& maps) {
  CompareOptions options;
  for (const std::string& key : o.metrics)
    if (!is_metric(key))
      throw UsageError("--metrics", key, fmt::format("no such metric; did you mean `{}`?", nearest_name(key, metric_keys())),
                       "see --list");
  options.metrics = o.metrics;
  for (const MapFile& map : maps) options.maps.push_back(map.key);
  if (!o.tone_map.empty()) options.tone_map = o.tone_map == "aces" ? ToneMap::kAces : ToneMap::kNone;
  options.pixels_per_degree = o.pixels_per_degree;
  if (o.exposures.size() >= 2) options.start_exposure = o.exposures[0], options.stop_exposure = o.exposures[1];
  if (o.exposures.size() == 3) options.exposures = static_cast<int>(o.exposures[2]);
  return options;
}

const char* name_of(Encoding domain) { return domain == Encoding::kLinear ? "linear" : "display"; }

void put_values(const std::vector<MetricValue>& values, Json& json) {
  for (const MetricValue& v : values) json[v.key] = v.value ? Json(*v.value) : Json();
}

void put_notes(const std::vector<MetricValue>& values, Json& json) {
  for (const MetricValue& v : values)
    if (!v.note.empty()) json["notes"][v.key] = v.note;
}

Json to_json(const RegionValues& region) {
  Json json{{"name", region.name},        {"x", region.rect.x},           {"y", region.rect.y},
            {"width", region.rect.width}, {"height", region.rect.height}, {"pixels", region.pixels}};
  put_values(region.values, json);
  return json;
}

Json to_json(const CompareVerb& o, const Comparison& c) {
  Json json{{"test", o.test},     {"reference", o.reference},    {"width", c.width},
            {"height", c.height}, {"domain", name_of(c.domain)}, {"mask", o.mask.empty() ? Json() : Json(o.mask)},
            {"pixels", c.pixels}};
  put_values(c.values, json);
  put_values(c.details, json);
  put_notes(c.values, json);
  for (const RegionValues& region : c.regions) json["regions"].push_back(to_json(region));
  json["warnings"] = c.warnings;
  return json;
}

Json to_json(const CompareVerb& o, const SequenceComparison& s) {
  const Comparison& first = s.frames.front();
  Json json{{"test", o.test},
            {"reference", o.reference},
            {"frames", s.frames.size()},
            {"width", first.width},
            {"height", first.height},
            {"domain", name_of(first.domain)},
            {"mask", o.mask.empty() ? Json() : Json(o.mask)}};
  put_values(s.mean, json);
  put_values(s.temporal, json);
  put_notes(s.mean, json);
  put_notes(s.temporal, json);
  for (std::size_t i = 0; i < s.frames.size(); ++i) {
    Json frame{{"pixels", s.frames[i].pixels}};
    put_values(s.frames[i].values, frame);
    if (i + 1 < s.frames.size()) {
      frame["adjacent_psnr"] = s.adjacent_psnr[i] ? Json(*s.adjacent_psnr[i]) : Json();
      frame["reference_adjacent_psnr"] = s.reference_adjacent_psnr[i] ? Json(*s.reference_adjacent_psnr[i]) : Json();
      frame["flicker"] = s.flicker[i];
    }
    json["per_frame"].push_back(std::move(frame));
  }
  json["warnings"] = first.warnings;
  return json;
}

std::string number(const MetricValue& v) { return v.value ? fmt::format("{:.6g}", *v.value) : "-"; }

const std::map<std::string, const char*> kContinuity = {
    {"continuity", "share of the length of flyaway strands in runs of 8 pixels or more without a gap"},
    {"continuity_shown", "share of that length that is shown at all"},
    {"continuity_gap", "mean length of a gap, pixels"},
    {"continuity_length", "length of flyaway strands that the reference shows, pixels"}};

void print_values(const std::vector<MetricValue>& values) {
  for (const MetricValue& v : values) {
    std::string text = v.note;
    for (const Metric& metric : registered_metrics())
      if (metric.key == v.key && text.empty()) text = metric.description;
    if (const auto found = kContinuity.find(v.key); found != kContinuity.end() && text.empty()) text = found->second;
    fmt::print("  {:<24} {:>12}{}{}\n", v.key, number(v), text.empty() ? "" : "  ", text);
  }
}

void print_regions(const Comparison& c) {
  if (c.regions.empty()) return;
  std::size_t name_width = 6;
  for (const RegionValues& region : c.regions) name_width = std::max(name_width, region.name.size());
  fmt::print("\n  {:<{}} {:>10}", "region", name_width, "pixels");
  for (const MetricValue& v : c.values) fmt::print(" {:>14}", v.key);
  fmt::print("\n");
  for (const RegionValues& region : c.regions) {
    fmt::print("  {:<{}} {:>10}", region.name, name_width, region.pixels);
    for (const MetricValue& v : region.values) fmt::print(" {:>14}", number(v));
    fmt::print("\n");
  }
}

void print_head(const CompareVerb& o, const Comparison& c, const std::string& what) {
  fmt::print("{} against {}: {}{} × {} pixels, {}", o.test, o.reference, what, c.width, c.height,
             c.domain == Encoding::kLinear ? "scene-linear" : "as a display shows them");
  if (!o.mask.empty()) fmt::print(", {} of {} counted ({})", c.pixels, c.width * c.height, o.mask);
  fmt::print("\n");
}

void warn(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) fmt::print(stderr, "pelage: {}\n", warning);
}

void write_map(const MapFile& file, const ErrorMap& map, float scale) {
  if (extension_of(file.path) == "exr") return write_image(file.path, map.error, true);
  write_image(file.path, color_error(map, scale > 0 ? scale : color_scale(map)));
}

Picture read_input(const CompareVerb& o, const std::string& path) {
  const Picture picture = read_picture(path);
  return o.background.empty() ? picture : over_background(picture, {o.background[0], o.background[1], o.background[2]});
}

/// The scene of --strands, seen at the size of the pictures.
Scene strand_scene(const CompareVerb& o, const Image& picture, const Progress& progress) {
  RenderOptions options = o.strands;
  options.size = fmt::format("{}x{}", picture.width, picture.height);
  std::vector<std::string> notes;
  Scene scene = make_scene(options, progress, notes);
  scene.settings.width = picture.width, scene.settings.height = picture.height;
  return scene;
}

/// Where the hair of `scene` is, exactly, as a picture with channel `coverage`.
Picture coverage_of(Scene scene, const Progress& progress) {
  scene.settings.view = View::kCoverage, scene.settings.method = Method::kMsaa, scene.settings.samples = 1;
  Picture picture{render(scene, progress).linear, Encoding::kLinear, "--strands"};
  picture.image.channels = {"coverage", "-", "-", "A"};
  return picture;
}

PixelMask mask_of(const CompareVerb& o, const Picture& source, std::string& note) {
  if (o.mask == "hair") return hair_mask(source, &note);
  if (o.mask == "flyaway") return flyaway_mask(source);
  return o.mask.empty() ? PixelMask() : mask_from_image(read_picture(o.mask));
}

void add_continuity(const Continuity& c, Comparison& comparison) {
  const std::string none = "no strand stands alone where the reference shows it";
  comparison.details.push_back({"continuity", c.connected, c.connected ? "" : none});
  comparison.details.push_back({"continuity_shown", c.shown, ""});
  comparison.details.push_back({"continuity_gap", c.mean_gap, ""});
  comparison.details.push_back({"continuity_length", c.length, ""});
}

void compare_pictures(const CompareVerb& o) {
  std::vector<MapFile> maps;
  for (const std::string& text : o.maps) maps.push_back(parse_map(text));
  for (const MapFile& map : maps) check_output(map.path);
  const Picture test = read_input(o, o.test), reference = read_input(o, o.reference);
  CompareOptions options = options_of(o, maps);
  options.regions = regions_of(o, reference.image.width, reference.image.height);
  std::string note;
  Comparison comparison;
  {
    ProgressLine line;
    options.progress = line.callback();
    if (o.strands.input.empty()) {
      options.mask = mask_of(o, reference, note);
      comparison = compare_images(test, reference, options);
    } else {
      const Scene scene = strand_scene(o, reference.image, options.progress);
      options.mask = mask_of(o, coverage_of(scene, options.progress), note);
      comparison = compare_images(test, reference, options);
      const FlyawayPaths paths = flyaway_paths(scene, kFlyawayCoverage, ContinuityOptions{}.least_run, options.progress);
      add_continuity(measure_continuity(test, reference, paths), comparison);
    }
  }
  if (!note.empty()) comparison.warnings.push_back(note);
  for (std::size_t i = 0; i < maps.size(); ++i) write_map(maps[i], comparison.maps[i], o.map_scale);
  warn(comparison.warnings);
  if (o.json) return fmt::print("{}\n", to_json(o, comparison).dump(2));
  print_head(o, comparison, "");
  print_values(comparison.values);
  print_values(comparison.details);
  print_regions(comparison);
}

void compare_frames(const CompareVerb& o, const FrameFiles& test, const FrameFiles& reference) {
  check_same_frames(o.test, test, o.reference, reference);
  if (!o.maps.empty() || !o.tiles.empty() || !o.regions.empty())
    throw UsageError("--map", "", "maps and regions are of single pictures", "compare one frame");
  if (!o.strands.input.empty() || !o.background.empty() || o.mask == "flyaway")
    throw UsageError("--strands", "", "strands, backgrounds and flyaway pixels are of single pictures", "compare one frame");
  CompareOptions options = options_of(o, {});
  if (!o.mask.empty() && o.mask != "hair") options.mask = mask_from_image(read_picture(o.mask));
  SequenceComparison sequence;
  {
    ProgressLine line;
    options.progress = line.callback();
    const auto reader = [](const FrameFiles& frames) {
      return [&frames](int i) { return read_picture(frames.files[static_cast<std::size_t>(i)]); };
    };
    sequence =
        compare_sequences(static_cast<int>(test.files.size()), reader(test), reader(reference), o.mask == "hair", options);
  }
  warn(sequence.frames.front().warnings);
  if (o.json) return fmt::print("{}\n", to_json(o, sequence).dump(2));
  print_head(o, sequence.frames.front(), fmt::format("{} frames of ", sequence.frames.size()));
  print_values(sequence.mean);
  print_values(sequence.temporal);
}

void compare_verb(const CompareVerb& o) {
  if (o.exposures.size() == 1) throw UsageError("--exposures", "", "one number", "START,STOP or START,STOP,COUNT");
  const auto test = frame_files(o.test), reference = frame_files(o.reference);
  if (test && reference) return compare_frames(o, *test, *reference);
  if (test || reference)
    throw UsageError(test ? o.test : o.reference, "",
                     fmt::format("a sequence, but {} is one picture", test ? o.reference : o.test),
                     "give two sequences or two pictures");
  compare_pictures(o);
}

void list_metrics() {
  for (const Metric& metric : registered_metrics())
    fmt::print("{:<16} {}{}\n", metric.key, metric.description, metric.has_map ? "; has a map" : "");
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("compare", "Measure how far a picture or a sequence is from a reference");
  auto o = std::make_shared<CompareVerb>();
  verb->add_option("TEST", o->test, "Picture (.png, .exr, .hdr), or frames: 'out.%04d.png', 'out.*.exr'")->type_name("FILE");
  verb->add_option("REFERENCE", o->reference, "What it should be")->type_name("FILE");
  verb->add_option("--mask", o->mask,
                   "Pixels that count: hair or flyaway (covered by less than 0.3) of the reference or --strands, or a "
                   "picture that is black elsewhere")
      ->type_name("hair|flyaway|FILE");
  verb->add_option(
          "--strands", o->strands.input,
          "Groom or scene that the pictures show: also measures how much of its flyaway strands can be followed without "
          "a gap. The camera's options are those of `pelage render`")
      ->type_name("FILE");
  verb->add_option("--background", o->background, "Lay transparent pictures over this linear color first")
      ->delimiter(',')
      ->expected(3)
      ->type_name("R,G,B");
  verb->add_option("--regions", o->tiles, "Also over tiles, e.g. 4x3")->type_name("NxM");
  verb->add_option("--region", o->regions, "Also over a rectangle; may be repeated")
      ->type_name("NAME=X,Y,WxH")
      ->allow_extra_args(false);
  verb->add_option("--metrics", o->metrics, "Only these, e.g. psnr,flip; see --list")->delimiter(',')->type_name("A,B");
  verb->add_option("--map", o->maps,
                   "Error per pixel: .png in color, .exr as it is; METRIC=FILE or METRIC.png; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb->add_option("--map-scale", o->map_scale, "Error at which the map's colors end")->check(CLI::PositiveNumber);
  verb->add_option("--tone-map", o->tone_map, "Compare as a display shows it, after this curve: aces, none")
      ->check(CLI::IsMember({"aces", "none"}))
      ->type_name("NAME");
  verb->add_option("--ppd", o->pixels_per_degree, "Pixels per degree of FLIP's viewer")->check(CLI::Range(1.0, 1000.0));
  verb->add_option("--exposures", o->exposures, "HDR-FLIP's first and last exposure in stops, and their number")
      ->delimiter(',')
      ->expected(1, 3)
      ->check(CLI::Range(-100.0, 100.0))
      ->type_name("A,B[,N]");
  verb->add_flag("--json", o->json, "Print JSON");
  verb->add_flag("--list", o->list, "Name the metrics and stop");
  add_camera_options(*verb, o->strands);
  add_machine_options(*verb);
  verb->footer(
      "Two scene-linear pictures (EXR, HDR) are compared as they are, PNG files by their sRGB values. docs/metrics.md says "
      "more.\n"
      "Examples:\n"
      "  pelage compare test.png reference.png --map flip.png\n"
      "  pelage compare test.exr reference.exr --mask hair --regions 4x3 --json\n"
      "  pelage compare link.exr truth.exr --strands groom.pelage --mask flyaway\n"
      "  pelage compare 'taa.%04d.png' 'truth.%04d.png' --metrics psnr,flip");
  verb->callback([o] {
    if (o->list) return list_metrics();
    if (o->test.empty()) throw CLI::RequiredError("TEST");
    if (o->reference.empty()) throw CLI::RequiredError("REFERENCE");
    compare_verb(*o);
  });
}

}  // namespace pelage::cli
