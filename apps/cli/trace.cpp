// pelage trace: the truth of what pelage render draws.
#include <fmt/format.h>
#include <pelage/denoise.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/runtime.h>
#include <pelage/trace.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "frame/sample_positions.h"
#include "picture_file.h"
#include "render.h"
#include "stats_json.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

struct TraceOptions {
  RenderOptions scene;
  TraceSettings settings;
  std::string checkpoint;
  bool no_checkpoint = false, samples_given = false, lod = false;
};

const std::map<std::string, Integrator> kIntegrators{
    {"path", Integrator::kPath}, {"dual", Integrator::kDual}, {"single", Integrator::kSingle}};

const std::map<std::string, CurveShape> kShapes{{"flat", CurveShape::kFlat}, {"round", CurveShape::kRound}};

const std::map<std::string, TraceLayer> kLayers{{"variance", TraceLayer::kVariance}, {"coverage", TraceLayer::kCoverage},
                                                {"Z", TraceLayer::kDepth},           {"position", TraceLayer::kPosition},
                                                {"tangent", TraceLayer::kTangent},   {"normal", TraceLayer::kNormal},
                                                {"strand", TraceLayer::kStrand},     {"u", TraceLayer::kU},
                                                {"albedo", TraceLayer::kAlbedo},     {"motion", TraceLayer::kMotion},
                                                {"bounces", TraceLayer::kBounces},   {"lobes", TraceLayer::kLobes}};

std::vector<std::string> layer_names() {
  std::vector<std::string> names;
  for (const auto& [name, layer] : kLayers) names.push_back(name);
  names.emplace_back("all");
  return names;
}

// In the order of TraceLayer, each once.
std::vector<TraceLayer> layers_of(const std::vector<std::string>& names) {
  std::vector<TraceLayer> layers;
  for (const std::string& name : names)
    if (name == "all")
      for (const auto& [known, layer] : kLayers) layers.push_back(layer);
    else layers.push_back(kLayers.at(name));
  std::sort(layers.begin(), layers.end());
  layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
  return layers;
}

Image first_four(const Image& image) {
  Image result(image.width, image.height, {"R", "G", "B", "A"});
  const std::size_t n = image.channel_count();
  for (std::size_t p = 0; p * n < image.pixels.size(); ++p)
    std::copy_n(image.pixels.data() + p * n, 4, result.pixels.data() + p * 4);
  return result;
}

void write_output(const std::string& path, const Scene& scene, const TraceResult& result) {
  const Image beauty = first_four(result.linear);
  if (write_flat_picture(path, beauty, make_display(beauty, scene.settings.tone_map), scene.settings.transparent_background))
    return;
  write_image(path, result.linear, true);
}

void print_trace_json(const TraceOptions& o, const TraceResult& result) {
  nlohmann::ordered_json j;
  j["outputs"] = o.scene.outputs;
  j["width"] = result.linear.width;
  j["height"] = result.linear.height;
  j["samples"] = result.samples;
  j["resumed_samples"] = result.resumed_samples;
  j["noise"] = result.noise;
  j["seconds"] = result.seconds;
  j["threads"] = thread_count();
  j["hash"] = pixel_hash(result.linear);
  j["stages"] = stages_json(result.stats);
  fmt::print("{}\n", j.dump(2));
}

void print_trace_stats(const TraceResult& result) {
  for (const StageStat& s : result.stats)
    fmt::print("{:<8} {:>10.2f} s {:>10.1f} MiB {:>14} {}\n", s.stage, s.seconds, static_cast<double>(s.bytes) / (1 << 20),
               s.items, s.unit);
  const StageStat& tracing = result.stats.back();
  fmt::print("{} samples a pixel ({} resumed), {:.3f} M samples/s, relative standard error {:.4f}, {} threads\n",
             result.samples, result.resumed_samples,
             tracing.seconds > 0 ? static_cast<double>(tracing.items) / tracing.seconds * 1e-6 : 0, result.noise,
             thread_count());
}

// One sample a pixel of a picture that has as many pixels as there are samples.
void write_gbuffer(TraceOptions o) {
  check_gbuffer_output(o.scene.gbuffer);
  const int samples = o.samples_given ? o.settings.samples : 1;
  if (!is_link_sample_count(samples))
    throw UsageError("--spp", std::to_string(samples), "no square of visibility pixels", "use 1, 4, 9 or 16 with --gbuffer");
  const int side = static_cast<int>(std::lround(std::sqrt(samples)));
  o.settings.samples = 1;
  o.settings.layers = gbuffer_layers();
  std::vector<std::string> notes;
  {
    ProgressLine line;
    const Progress progress = line.callback();
    Scene scene = make_scene(o.scene, progress, notes);
    scene = at_chosen_frame(o.scene, std::move(scene));
    scene.settings.width *= side, scene.settings.height *= side;
    write_image(o.scene.gbuffer, trace(scene, o.settings, progress).linear, true);
  }
  for (const std::string& note : notes) fmt::print(stderr, "pelage: {}: {}\n", o.scene.input, note);
}

void trace_verb(TraceOptions o) {
  for (const std::string& path : o.scene.outputs) check_output(path);
  // Until the picture is written, the state stands beside it; a state that was asked for stays.
  if (!o.no_checkpoint) o.settings.checkpoint = o.checkpoint.empty() ? o.scene.outputs.front() + ".checkpoint" : o.checkpoint;
  o.settings.layers = layers_of(o.scene.layers);
  std::vector<std::string> notes;
  TraceResult result;
  {
    ProgressLine line;
    const Progress progress = line.callback();
    Scene scene = make_scene(o.scene, progress, notes);
    scene = at_chosen_frame(o.scene, std::move(scene));
    if (o.scene.orbit) scene.previous_camera = turned(scene.camera, -*o.scene.orbit);
    scene.settings.thick_hairs.blend = 0;  // of a scene file: a truth of one frame has no levels to come from
    if (o.lod) scene = with_thick_hairs(scene);
    result = trace(scene, o.settings, progress);
    for (const std::string& path : o.scene.outputs) write_output(path, scene, result);
  }
  std::error_code ignored;
  if (o.checkpoint.empty() && !o.no_checkpoint) std::filesystem::remove(o.settings.checkpoint, ignored);
  for (const std::string& note : notes) fmt::print(stderr, "pelage: {}: {}\n", o.scene.input, note);
  if (result.resumed_samples > 0)
    fmt::print(stderr, "pelage: went on from {} samples a pixel in {}\n", result.resumed_samples, o.settings.checkpoint);
  if (o.scene.stats) print_trace_stats(result);
  if (o.scene.json) print_trace_json(o, result);
}

void add_trace_options(CLI::App& verb, TraceOptions& o) {
  verb.add_option("--spp", o.settings.samples, "Samples per pixel")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  verb.add_option("--time", o.settings.seconds, "Stop after so many seconds of tracing")->check(CLI::NonNegativeNumber);
  verb.add_option("--noise", o.settings.noise, "Stop at this relative standard error, e.g. 0.02")
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--integrator", o.settings.integrator,
                  "path, dual (dual scattering, strands on shadow rays counted) or single")
      ->transform(CLI::CheckedTransformer(kIntegrators))
      ->type_name("NAME");
  verb.add_option("--curves", o.settings.curve_shape, "flat (bands that face each ray, as render draws them) or round (tubes)")
      ->transform(CLI::CheckedTransformer(kShapes))
      ->type_name("NAME");
  verb.add_option("--bounces", o.settings.max_bounces, "Scattering events of a path at most")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb.add_option("--seed", o.settings.seed, "Of the random numbers")->check(CLI::NonNegativeNumber);
  CLI::Option* lod =
      verb.add_flag("--lod", o.lod, "Thick hairs as `render` draws them where the groom has them, instead of all strands");
  for (CLI::Option* option : add_thick_hair_options(verb, o.scene)) option->needs(lod);
  verb.add_flag("--raster-positions", o.settings.raster_positions, "Samples where those of `render --spp` with as many stand");
  add_frame_options(verb, o.scene);
  verb.add_option("--orbit", o.scene.orbit,
                  "Degrees that the camera came around the target since the frame before, for the layer motion")
      ->check(CLI::Range(-3600.0, 3600.0));
  verb.add_option("--layers", o.scene.layers, "More channels of EXR output; see docs/trace.md")
      ->delimiter(',')
      ->check(CLI::IsMember(layer_names()));
  verb.add_option("--checkpoint", o.checkpoint,
                  "Go on from this file where it exists, and keep the state there (default: OUTPUT.checkpoint, until done)")
      ->type_name("FILE");
  verb.add_option("--checkpoint-every", o.settings.checkpoint_seconds, "Seconds between two states")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.add_flag("--no-checkpoint", o.no_checkpoint, "Keep no state");
}

}  // namespace

void add_trace(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("trace", "Path trace a groom or a scene file: the truth beside render");
  auto o = std::make_shared<TraceOptions>();
  verb->add_option("INPUT", o->scene.input, "Groom file, or scene file (JSON)")->type_name("FILE")->required();
  CLI::Option* output = verb->add_option("-o,--output", o->scene.outputs,
                                         "Picture to write: .exr (32 bits a channel), .png or .hdr; may be repeated")
                            ->type_name("FILE")
                            ->allow_extra_args(false);
  CLI::Option* gbuffer =
      verb->add_option("--gbuffer", o->scene.gbuffer,
                       "EXR to write instead, with what `pelage denoise` reads: one sample a pixel, or --spp 4, 9, 16")
          ->type_name("FILE");
  output->excludes(gbuffer);
  add_scene_options(*verb, o->scene);
  add_trace_options(*verb, *o);
  verb->add_flag("--stats", o->scene.stats, "Print time and memory");
  verb->add_flag("--json", o->scene.json, "Print them as JSON");
  add_machine_options(*verb);
  verb->footer(
      "The same scene, camera, light and defaults as `pelage render`. Interrupted, it goes on where it was when called again.\n"
      "Examples:\n"
      "  pelage trace hair.tfx --mesh head.obj -o truth.exr --spp 1024\n"
      "  pelage trace scene.json -o quick.png --time 60\n"
      "  pelage trace scene.json -o noisy.exr --spp 1 --layers Z,position,tangent,strand,albedo\n"
      "  pelage trace scene.json -o dual.exr --integrator dual --checkpoint dual.state\n"
      "  pelage trace hair_lod.pelage -o thick.exr --lod --lod-pixels 2");
  verb->callback([o, verb] {
    if (o->scene.outputs.empty() && o->scene.gbuffer.empty()) throw CLI::RequiredError("--output");
    o->samples_given = verb->count("--spp") > 0;
    if (!o->scene.gbuffer.empty()) return write_gbuffer(*o);
    trace_verb(*o);
  });
}

}  // namespace pelage::cli
