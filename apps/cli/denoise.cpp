// pelage denoise: the G-buffer of any renderer, one sample a pixel, becomes a picture with whole strands.
#include <fmt/format.h>
#include <pelage/metrics.h>
#include <pelage/pelage.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "picture_file.h"
#include "render.h"
#include "stats_json.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct DenoiseVerb {
  RenderOptions scene;  // input: the groom
  std::string gbuffer, reference, method = "link", alpha = "count", tone_map = "aces";
  std::vector<std::string> names;
  DenoiseSettings settings;
};

/// Error of the picture of one sample, and of what it became, over the pixels with hair: those that a sample met or that changed.
struct Gain {
  std::size_t pixels = 0;
  double mse[2] = {}, psnr[2] = {};  ///< before, after; linear, and of what a display shows
};

struct Outcome {
  DenoiseResult result;
  std::optional<Gain> gain;
};

// FIELD=NAME
std::pair<std::string, std::string> parse_name(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw UsageError("--channel", text, "not of the form FIELD=NAME", "e.g. position=ViewLayer.Position");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// Means of the squares of samples that make a pixel, of the first channels `names`.
Image averaged(const Image& fine, int side, const std::vector<std::string>& names) {
  Image mean(fine.width / side, fine.height / side, names);
  std::vector<std::size_t> at;
  for (const std::string& name : names)
    at.push_back(static_cast<std::size_t>(std::find(fine.channels.begin(), fine.channels.end(), name) - fine.channels.begin()));
  const float share = 1 / static_cast<float>(side * side);
  for (int y = 0; y < mean.height * side; ++y)
    for (int x = 0; x < mean.width * side; ++x)
      for (std::size_t c = 0; c < at.size(); ++c) mean.at(x / side, y / side)[c] += fine.at(x, y)[at[c]] * share;
  return mean;
}

/// The names of the file's channels of a field that has been found.
std::vector<std::string> names_of(const DenoiseVerb& verb, const Image& gbuffer, const std::string& field) {
  const auto& fields = gbuffer_fields();
  const auto known = std::find_if(fields.begin(), fields.end(), [&](const GBufferField& f) { return f.name == field; });
  const auto renamed = verb.settings.names.find(field);
  std::vector<std::string> names;
  for (const std::string& component : known->components.empty() ? std::vector<std::string>{""} : known->components) {
    std::string name = component.empty() ? field : component;
    if (renamed != verb.settings.names.end()) name = renamed->second + (component.empty() ? "" : "." + component);
    if (!std::count(gbuffer.channels.begin(), gbuffer.channels.end(), name)) name = renamed->second + ".X";
    names.push_back(name);
  }
  return names;
}

Gain measure(const DenoiseVerb& verb, const Image& gbuffer, const Image& after) {
  const Picture reference = read_picture(verb.reference);
  const int side = gbuffer.width / after.width;
  Image before = averaged(gbuffer, side, names_of(verb, gbuffer, "color"));
  before.channels = {"R", "G", "B"};
  const Image strands = averaged(gbuffer, side, names_of(verb, gbuffer, "strand"));
  Image now = averaged(after, 1, {"R", "G", "B"});
  CompareOptions options;
  options.mask.resize(strands.pixels.size());
  Gain gain;
  for (std::size_t p = 0; p < options.mask.size(); ++p) {
    options.mask[p] = strands.pixels[p] != 0 ||
                      !std::equal(now.pixels.data() + 3 * p, now.pixels.data() + 3 * p + 3, before.pixels.data() + 3 * p);
    gain.pixels += options.mask[p];
  }
  const Image* const pictures[2] = {&before, &now};
  for (int i = 0; i < 2; ++i) {
    options.metrics = {"mse"}, options.tone_map = {};
    gain.mse[i] = compare_images({*pictures[i]}, reference, options).value("mse").value_or(0);
    options.metrics = {"psnr"}, options.tone_map = ToneMap::kAces;
    gain.psnr[i] = compare_images({*pictures[i]}, reference, options).value("psnr").value_or(INFINITY);
  }
  return gain;
}

/// The groom as the G-buffer's camera saw it.
Scene groom_scene(const DenoiseVerb& verb, const Image& gbuffer, int side, const Progress& progress,
                  std::vector<std::string>& notes) {
  RenderOptions options = verb.scene;
  options.size = fmt::format("{}x{}", gbuffer.width / side, gbuffer.height / side);
  return make_scene(options, progress, notes);
}

Outcome run(const DenoiseVerb& verb, const Progress& progress, std::vector<std::string>& notes) {
  const Image gbuffer = read_image(verb.gbuffer);
  DenoiseSettings settings = verb.settings;
  Scene scene;
  if (!verb.scene.input.empty()) {
    const int side = static_cast<int>(std::lround(std::sqrt(static_cast<float>(settings.samples))));
    scene = groom_scene(verb, gbuffer, side, progress, notes);
    settings.scene = &scene;
  }
  Outcome outcome;
  try {
    outcome.result = denoise(gbuffer, settings, progress);
  } catch (const Error& e) {
    if (e.where() != "G-buffer") throw;
    throw Error(verb.gbuffer, e.place(), e.problem(), e.remedy());
  }
  if (!verb.reference.empty()) outcome.gain = measure(verb, gbuffer, outcome.result.linear);
  return outcome;
}

void print_table(const Outcome& o, bool stats) {
  if (stats) {
    for (const StageStat& s : o.result.stats)
      fmt::print("{:<20} {:>8.1f} ms {:>10.1f} MiB {:>12} {}\n", s.stage, 1e3 * s.seconds,
                 static_cast<double>(s.bytes) / (1 << 20), s.items, s.unit);
    fmt::print("{} pixels of hair, {} strands", o.result.hair_pixels, o.result.strands);
    if (o.result.camera_error) fmt::print(", camera {:.2f} pixels from its samples", *o.result.camera_error);
    fmt::print("\nnoise of colors {:.2f}, filter {:.1f} pixels to either side, {:.1f} for color\n", o.result.noise,
               o.result.radius, o.result.color_radius);
  }
  if (!o.gain) return;
  fmt::print("{:>22} {:>10} {:>10}   {} pixels of hair\n", "", "before", "after", o.gain->pixels);
  fmt::print("{:>22} {:>10.3g} {:>10.3g}\n", "mse, linear", o.gain->mse[0], o.gain->mse[1]);
  fmt::print("{:>22} {:>10.2f} {:>10.2f}\n", "psnr, displayed", o.gain->psnr[0], o.gain->psnr[1]);
}

void print_json(const DenoiseVerb& verb, const Outcome& o) {
  Json j{{"outputs", verb.scene.outputs},       {"width", o.result.linear.width},       {"height", o.result.linear.height},
         {"hair_pixels", o.result.hair_pixels}, {"strands", o.result.strands},          {"noise", o.result.noise},
         {"radius", o.result.radius},           {"color_radius", o.result.color_radius}};
  if (o.result.camera_error) j["camera_error"] = *o.result.camera_error;
  if (o.gain)
    for (int i = 0; i < 2; ++i) j[i == 0 ? "before" : "after"] = {{"mse", o.gain->mse[i]}, {"psnr", o.gain->psnr[i]}};
  j["hash"] = pixel_hash(o.result.linear);
  j["stages"] = stages_json(o.result.stats);
  fmt::print("{}\n", j.dump(2));
}

void denoise_verb(DenoiseVerb verb) {
  for (const std::string& path : verb.scene.outputs) check_output(path);
  for (const std::string& text : verb.names) verb.settings.names.insert(parse_name(text));
  verb.settings.link.link = verb.method == "link";
  verb.settings.link.alpha = verb.alpha == "count" ? LinkAlpha::kCount : LinkAlpha::kCoverage;
  std::vector<std::string> notes;
  Outcome outcome;
  {
    ProgressLine line;
    outcome = run(verb, line.callback(), notes);
    const Image display = make_display(outcome.result.linear, verb.tone_map == "aces" ? ToneMap::kAces : ToneMap::kNone);
    for (const std::string& path : verb.scene.outputs)
      if (!write_flat_picture(path, outcome.result.linear, display, true))
        write_image(path, outcome.result.linear, verb.scene.full_float);
  }
  for (const std::string& note : notes) fmt::print(stderr, "pelage: {}: {}\n", verb.scene.input, note);
  if (verb.scene.json) print_json(verb, outcome);
  else print_table(outcome, verb.scene.stats);
}

void add_strand_options(CLI::App& verb, DenoiseVerb& o) {
  verb.add_option("--groom", o.scene.input,
                  "Groom or scene file that the G-buffer shows: its strands instead of what the samples tell of them")
      ->type_name("FILE");
  add_camera_options(verb, o.scene);
  verb.add_option("--reach", o.settings.reach, "Pixels that a strand goes on beyond its last samples")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.add_option("--piece", o.settings.piece, "Pixels of a strand that its opacity is counted over")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

void add_filter_options(CLI::App& verb, DenoiseVerb& o) {
  verb.add_option("--method", o.method, "link, or filter-only: smooth the samples that are there")
      ->check(CLI::IsMember({"link", "filter-only"}))
      ->capture_default_str();
  verb.add_option("--samples", o.settings.samples,
                  "Samples a pixel of the result: 1, 4, 9 or 16; 4: the G-buffer is twice as wide and high")
      ->check(CLI::IsMember({1, 4, 9, 16}))
      ->capture_default_str();
  verb.add_option("--kernel-radius", o.settings.link.kernel_radius,
                  "Half of the filter's length for opacity; colors take more the noisier they are")
      ->check(CLI::Range(0.0, 64.0))
      ->type_name("PIXELS")
      ->capture_default_str();
  verb.add_option("--kernel-size,--k", o.settings.link.kernel_size,
                  "Half of the filter's length over the size of the hair, for all; 0: --kernel-radius")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--aspect", o.settings.link.aspect, "The filter's width over its length")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--alpha", o.alpha, "Opacity of linked strands: count (of hit and filled pixels) or coverage (a channel)")
      ->check(CLI::IsMember({"count", "coverage"}))
      ->capture_default_str();
}

std::string channel_help() {
  std::string text = "Channels of the G-buffer (docs/denoise.md):\n";
  for (const GBufferField& f : gbuffer_fields()) {
    std::string names = f.components.empty() ? f.name : "";
    const bool bare = f.name == "color" || f.name == "alpha" || f.name == "depth";
    for (const std::string& c : f.components) names += (names.empty() ? "" : " ") + (bare ? c : f.name + "." + c);
    text += fmt::format("  {:<12} {:<36} {}{}\n", f.name, names, f.required ? "" : "optional: ", f.meaning);
  }
  return text;
}

}  // namespace

void add_denoise(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("denoise", "Link and smooth the hair of a G-buffer with one sample a pixel, of any renderer");
  auto o = std::make_shared<DenoiseVerb>();
  verb->add_option("--gbuffer", o->gbuffer, "EXR with the channels below; `render --gbuffer` and `trace --gbuffer` write such")
      ->type_name("FILE")
      ->required();
  verb->add_option("-o,--output", o->scene.outputs, "Picture to write: .exr, .png or .hdr; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->required();
  verb->add_option("--channel", o->names, "What a channel, or several, are called in the G-buffer; may be repeated")
      ->type_name("FIELD=NAME")
      ->allow_extra_args(false);
  add_strand_options(*verb, *o);
  add_filter_options(*verb, *o);
  verb->add_option("--tone-map", o->tone_map, "Curve of PNG output")
      ->check(CLI::IsMember({"aces", "none"}))
      ->capture_default_str();
  verb->add_flag("--float", o->scene.full_float, "EXR with 32 bits a channel instead of 16");
  verb->add_option("--reference", o->reference, "Picture of many samples: print the error before and after")->type_name("FILE");
  verb->add_flag("--stats", o->scene.stats, "Print time and memory of every stage");
  verb->add_flag("--json", o->scene.json, "Print them as JSON");
  add_machine_options(*verb);
  verb->footer(
      channel_help() +
      "Examples:\n"
      "  pelage trace hair.pelage --gbuffer noisy.exr\n"
      "  pelage denoise --gbuffer noisy.exr -o clean.png\n"
      "  pelage denoise --gbuffer noisy.exr -o clean.exr --groom hair.pelage --reference truth.exr\n"
      "  pelage denoise --gbuffer cycles.exr -o clean.png --channel color=ViewLayer.Combined --channel "
      "depth=ViewLayer.Depth\\\n"
      "    --channel position=ViewLayer.Position --channel tangent=ViewLayer.tangent --channel strand=ViewLayer.strand\\\n"
      "    --channel u=ViewLayer.u");
  verb->callback([o] { denoise_verb(*o); });
}

}  // namespace pelage::cli
