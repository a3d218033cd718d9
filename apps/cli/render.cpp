// pelage render: a groom or a scene file becomes a picture.
#include "render.h"

#include <fmt/format.h>
#include <pelage/denoise.h>
#include <pelage/error.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "composite/side_by_side.h"
#include "core/check.h"
#include "frame/sample_positions.h"
#include "io/scene_tables.h"
#include "frame_list.h"
#include "picture_file.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

constexpr int kDefaultPictures = 16;  // of a sequence

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<std::string> channels_of_layer(const std::string& name) {
  if (name == "id" || name == "tangent" || name == "albedo") return {".R", ".G", ".B"};
  if (name == "motion") return {".X", ".Y"};
  return {""};
}

// Appends the channels of other views of the same scene, which was `before` a frame ago: their own passes, without light.
void append_layers(const Scene& before, const Scene& scene, const std::vector<std::string>& layers, const Progress& progress,
                   Image& image) {
  static const std::vector<std::pair<std::string, View>> kLayers{
      {"Z", View::kDepth},         {"coverage", View::kCoverage}, {"id", View::kStrandId},       {"u", View::kU},
      {"tangent", View::kTangent}, {"albedo", View::kAlbedo},     {"overdraw", View::kOverdraw}, {"motion", View::kMotion}};
  for (const std::string& name : layers) {
    const auto layer = std::find_if(kLayers.begin(), kLayers.end(), [&](const auto& l) { return l.first == name; });
    PELAGE_CHECK(layer != kLayers.end());
    Scene pass = scene;
    pass.settings.view = layer->second;
    Scene earlier = before;
    earlier.settings = pass.settings, earlier.previous_camera = pass.previous_camera;
    const Image data = PictureSequence(std::move(earlier)).next(std::move(pass), progress).linear;
    std::vector<std::string> names = image.channels;
    for (const std::string& suffix : channels_of_layer(name)) names.push_back(name + suffix);
    Image merged(image.width, image.height, names);
    const std::size_t n = image.channel_count(), m = names.size();
    for (std::size_t p = 0; p < data.pixels.size() / 4; ++p) {
      std::copy_n(image.pixels.data() + p * n, n, merged.pixels.data() + p * m);
      std::copy_n(data.pixels.data() + p * 4, m - n, merged.pixels.data() + p * m + n);
    }
    image = std::move(merged);
  }
}

// One file, or with %V in its name one for each eye.
void write_output(const std::string& path, const RenderOptions& options, const Scene& before, const Scene& scene,
                  const RenderResult& result, const Progress& progress) {
  const bool more = extension_of(path) == "exr" && !options.layers.empty();
  Image layered;
  if (more) layered = result.linear, append_layers(before, scene, options.layers, progress, layered);
  const Image& linear = more ? layered : result.linear;
  const auto write = [&](const std::string& file, const Image& data, const Image& display) {
    if (!write_flat_picture(file, data, display, scene.settings.transparent_background))
      write_image(file, data, options.full_float);
  };
  if (!is_for_each_eye(path)) return write(path, linear, result.display);
  for (const int eye : {0, 1}) write(of_eye(path, eye), part_of(linear, eye, 2), part_of(result.display, eye, 2));
}

void add_stats(std::vector<StageStat>& total, const std::vector<StageStat>& stats) {
  for (const StageStat& s : stats) {
    const auto same = std::find_if(total.begin(), total.end(), [&](const StageStat& t) { return t.stage == s.stage; });
    if (same == total.end()) {
      total.push_back(s);
      continue;
    }
    same->seconds += s.seconds, same->items += s.items, same->bytes = std::max(same->bytes, s.bytes);
  }
}

// The pictures that the options ask for: cameras and, of hair that moves, frames, by their numbers.
class Shots {
 public:
  Shots(const RenderOptions& options, const Scene& rest) : rest_(rest), options_(options) {
    const std::optional<FrameRange> moving = animated_frames(rest);
    const int all = moving ? moving->last - moving->first + 1 : kDefaultPictures;
    count_ = makes_sequence(options) ? options.frames.value_or(all) : 1;
    first_ = moving ? moving->first : 1;
    if (options.frame_range) first_ = options.frame_range->first, count_ = options.frame_range->last - first_ + 1;
    if (options.frame) first_ = *options.frame, count_ = 1;
    moves_ = moving && (makes_sequence(options) || options.frame);
    if (options.frame || (moving && options.frame_range))
      check_frames(options.frame ? "--frame" : "--frames", rest, {first_, last()});
  }

  int count() const { return count_; }
  bool moves() const { return moves_; }
  int number(int i) const { return first_ + i; }
  /// Picture i, −1 for what was there before the first.
  Scene scene(int i) const {
    Scene scene = moves_ ? at_frame(rest_, number(i), options_.still_meshes) : rest_;
    scene.camera = camera(i);
    scene.previous_camera = i > 0 ? camera(i - 1) : rest_.previous_camera;
    return scene;
  }

 private:
  int last() const { return first_ + count_ - 1; }
  Camera camera(int i) const { return turned(rest_.camera, options_.orbit.value_or(0.f) * static_cast<float>(std::max(i, 0))); }

  const Scene& rest_;
  const RenderOptions& options_;
  int first_ = 1, count_ = 1;
  bool moves_ = false;
};

// Renders the pictures that the options ask for, one after another, and writes each. Numbered files take every picture,
// others the last; methods that take nothing over from picture to picture skip what nobody asked for.
RenderResult render_pictures(const RenderOptions& options, const Scene& rest, const Progress& progress) {
  const bool all = rest.settings.method == Method::kTaa || rest.settings.method == Method::kLinkTaa ||
                   std::any_of(options.outputs.begin(), options.outputs.end(), is_numbered);
  const Shots shots(options, rest);
  std::vector<StageStat> stats;
  StageStat writing{"io.write", 0, 0, 0, "files"};
  RenderResult result;
  const int first = all ? 0 : shots.count() - 1;
  Scene before = shots.scene(first - 1);
  before.previous_camera = shots.scene(first).previous_camera;
  PictureSequence sequence(before);
  for (int i = first; i < shots.count(); ++i) {
    Scene scene = shots.scene(i);
    result = shots.moves() ? sequence.next(scene, progress) : sequence.next(scene.camera, progress);
    add_stats(stats, result.stats);
    const auto wrote = std::chrono::steady_clock::now();
    for (const std::string& path : options.outputs) {
      if (i + 1 < shots.count() && !is_numbered(path)) continue;
      write_output(numbered(path, shots.number(i)), options, before, scene, result, progress);
      writing.items += is_for_each_eye(path) ? 2 : 1;
    }
    writing.seconds += seconds_since(wrote);
    before = std::move(scene);
  }
  result.stats = std::move(stats);
  result.stats.push_back(writing);
  return result;
}

// What method link starts from; its samples stand as pixels.
void write_gbuffer(const RenderOptions& options, const Scene& scene, const Progress& progress) {
  Scene linked = scene;
  if (!is_linking(linked.settings.method)) linked.settings.samples = options.samples.value_or(1);
  write_image(options.gbuffer, render_gbuffer(linked, progress), true);
}

void check_eyes(const RenderOptions& options, const Camera& camera) {
  for (const std::string& path : options.outputs)
    if (is_for_each_eye(path) && !camera.stereo)
      throw UsageError("--output", path, "%V stands for left or right, and there is one eye", "add --stereo");
}

void render_verb(const RenderOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& path : options.outputs)
    for (const int eye : {0, 1}) check_output(of_eye(numbered(path, 1), eye));
  if (!options.gbuffer.empty()) check_gbuffer_output(options.gbuffer);
  std::vector<std::string> notes;
  RenderResult result;
  Scene scene;
  {
    ProgressLine line;
    const Progress progress = line.callback();
    scene = make_scene(options, progress, notes);
    check_eyes(options, scene.camera);
    const double read_seconds = seconds_since(start);
    if (!options.gbuffer.empty()) write_gbuffer(options, at_chosen_frame(options, scene), progress);
    if (!options.outputs.empty()) result = render_pictures(options, scene, progress);
    result.stats.insert(result.stats.begin(), {"io.read", read_seconds, 0, scene.grooms.size() + scene.meshes.size(), "files"});
  }
  for (const std::string& note : notes) fmt::print(stderr, "pelage: {}: {}\n", options.input, note);
  if (options.stats) print_stats(scene, result, seconds_since(start));
  if (options.json) print_json(scene, result, options.outputs, seconds_since(start));
}

void add_picture_options(CLI::App& verb, RenderOptions& o) {
  verb.add_option(
          "--method", o.method,
          "Anti-aliasing: msaa (samples of one frame share shading), ssaa (each is shaded), taa, fxaa, smaa, "
          "link (one sample, then strands are linked and smoothed), link-taa, oidn, or swr (hair meshes, made on the fly)")
      ->type_name("NAME");
  verb.add_option("--spp", o.samples,
                  "Samples per pixel; msaa: 1, 2, 4, 8 or 16; link: 1, 4, 9 or 16; swr: 1, 2, 4 or 8; ssaa: any number")
      ->check(CLI::Range(1, 4096));
  verb.add_option_function<std::string>(
          "--frames",
          [&o](const std::string& text) {
            const FrameList list = parse_frames("--frames", text);
            o.frames = list.count, o.frame_range = list.range;
          },
          "Pictures of a sequence (an output like out.####.exr, or --orbit): how many, or the first and the last frame of hair "
          "that "
          "moves; else frames that taa blends")
      ->type_name("N or A-B");
  add_frame_options(verb, o);
  verb.add_option("--orbit", o.orbit, "Degrees that the camera goes around the target from picture to picture")
      ->check(CLI::Range(-360.0, 360.0));
  verb.add_flag("--stereo{0.063}", o.stereo,
                "Two eyes, 0.063 or so many meters apart: their pictures side by side, the left eye's on the left, or "
                "in files of their own where an output has %V (left, right) in its name; 0: one eye")
      ->type_name("[=METERS]");
  verb.add_option("--convergence", o.convergence,
                  "Meters from the eyes to what lies in the plane of the stereo picture; else as far as the target")
      ->check(CLI::PositiveNumber);
  verb.add_option("--view", o.view,
                  "beauty, strand-id, u, tangent, depth, coverage, overdraw, albedo, motion, lod (levels of thick hairs); of "
                  "strand linking: "
                  "linked (pixels that were hit and filled), alpha (opacity before the filter)")
      ->type_name("NAME");
  verb.add_option("--alpha", o.alpha,
                  "Opacity from covered samples or exact area: samples, analytic; of link: count, coverage or none; of swr: "
                  "kernel, ratio or coverage")
      ->type_name("NAME");
  verb.add_option("--kernel-radius", o.kernel_radius,
                  "link: half of the filter's length for thin hair; it adapts to other hair; 7")
      ->check(CLI::Range(0.0, 64.0))
      ->type_name("PIXELS");
  verb.add_option("--kernel-size", o.kernel_size,
                  "link: half of the filter's length over the size of the hair, for all pixels; not given: --kernel-radius")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_option("--depth-sigma", o.depth_sigma,
                  "link: of strands that fit, those this share of the distance behind the nearest count less; 0: not at all")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("SHARE");
  verb.add_flag("--no-linking", o.no_linking, "link: missed pixels of strands stay empty");
  verb.add_flag("--no-filter", o.no_filter, "link, swr: hair is not smoothed along its strands");
  verb.add_flag("--no-lod", o.no_lod,
                "All strands, however small they are on the screen: no thick hairs, and hair meshes whole (swr)");
  add_thick_hair_options(verb, o);
  verb.add_option("--lod-blend", o.lod_blend,
                  "Thick hairs wider than 1 - B of --lod-pixels fade out while finer ones fade in (try 0.25); 0: at once")
      ->check(CLI::Range(0.0, 0.9))
      ->excludes("--lod-level")
      ->type_name("B");
  verb.add_option("--lod-as", o.lod_as, "What stands for clusters: thick hairs, as many of their strands made wider, or cards")
      ->type_name("thick|strands|cards");
  verb.add_flag("--no-occlusion", o.no_occlusion, "swr: baked occlusion of hair meshes does not dim the light of the probe");
  verb.add_option("--layers", o.layers, "More channels of EXR output")
      ->delimiter(',')
      ->check(CLI::IsMember({"Z", "coverage", "id", "u", "tangent", "albedo", "overdraw", "motion"}));
  verb.add_flag("--float", o.full_float, "EXR with 32 bits a channel instead of 16");
  verb.add_option("--subdivisions", o.subdivisions, "Segments per span; 0 chooses")->check(CLI::Range(0, 64));
  verb.add_option("--environment-lighting", o.environment_lighting,
                  "Environment on strands: pieces (16 lights with opacity maps), probe (prefiltered, no shadows)")
      ->type_name("NAME");
  verb.add_flag("--no-dual-scattering", o.no_dual_scattering,
                "Single scattering only; with --model pelekis a Lambertian term stands for the rest");
  verb.add_option("--opacity-map", o.opacity_map_size, "Texels a side of a light's map")->check(CLI::Range(64, 4096));
}

}  // namespace

bool makes_sequence(const RenderOptions& options) {
  return options.orbit || options.frame_range || std::any_of(options.outputs.begin(), options.outputs.end(), is_numbered);
}

void add_render(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("render", "Render a groom or a scene file");
  auto o = std::make_shared<RenderOptions>();
  verb->add_option("INPUT", o->input, "Groom file, hair mesh, or scene file (JSON)")->type_name("FILE");
  verb->add_option("-o,--output", o->outputs, "Picture to write: .exr, .png or .hdr; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb->add_option("--gbuffer", o->gbuffer,
                   "EXR to write with what `pelage denoise` reads, one sample a pixel, or --spp 4, 9, 16")
      ->type_name("FILE");
  add_scene_options(*verb, *o);
  add_picture_options(*verb, *o);
  verb->add_flag("--stats", o->stats, "Print time and memory of every stage");
  verb->add_flag("--json", o->json, "Print them as JSON");
  verb->add_flag("--schema", o->schema, "Print the JSON schema of scene files and stop");
  add_machine_options(*verb);
  verb->footer(
      "Without options: framed, three lights, brown hair; below hair of `pelage grow`, the mannequin.\n"
      "Examples:\n"
      "  pelage render hair.tfx --mesh head.obj -o hair.png\n"
      "  pelage render hair.tfx -o hair.exr --size 1920x1080 --spp 16 --hair blond --stats\n"
      "  pelage render hair.tfx -o reference.exr --method ssaa --spp 64\n"
      "  pelage render hair.tfx -o turn.####.exr --method taa --orbit 0.5 --frames 48 --layers motion\n"
      "  pelage render hair.tfx -o linked.png --method link --alpha coverage\n"
      "  pelage render hair_lod.pelage -o away.png --lod-pixels 2.3 --lod-blend 0.25\n"
      "  pelage render curls.hairmesh -o curls.png --method swr\n"
      "  pelage render bob.hairmesh -o eye.%V.png --method swr --stereo=0.07\n"
      "  pelage render scene.json -o picture.png -o picture.exr --layers Z,coverage\n"
      "A scene file may make hair: {\"grooms\": [{\"grow\": {\"style\": \"curly\"}}]}, or, as a hair mesh for --method swr,\n"
      "{\"grooms\": [{\"grow\": {\"hair_mesh\": \"curls\", \"strands\": 127000, \"seed\": 1}}]}; --schema prints all keys.");
  verb->callback([o] {
    if (o->schema) return fmt::print("{}", io::scene_schema());
    if (o->input.empty()) throw CLI::RequiredError("INPUT");
    if (o->outputs.empty() && o->gbuffer.empty()) throw CLI::RequiredError("--output");
    render_verb(*o);
  });
}

}  // namespace pelage::cli
