// From the options of `pelage render` to a scene.
#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>
#include <pelage/lod.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "core/nearest.h"
#include "frame/sample_positions.h"
#include "frame_list.h"
#include "io/byte_source.h"
#include "io/file_kind.h"
#include "io/hair_mesh_formats.h"
#include "render.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

constexpr float kDegree = 3.14159265f / 180;

template <class T>
T by_name(const char* option, const std::string& name, const std::map<std::string, T>& values) {
  if (const auto found = values.find(name); found != values.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, value] : values) names.push_back(known);
  throw UsageError(option, name, "unknown value", fmt::format("did you mean `{}`?", nearest_name(name, names)));
}

// Numbers separated by `separator`, all of the text; throws Error unless there are `count`.
std::vector<float> numbers(const char* option, const std::string& text, char separator, std::size_t count) {
  std::vector<float> values;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end + 1) {
    values.push_back(std::strtof(at, &end));
    if (end == at || !std::isfinite(values.back())) break;
    if (*end == '\0' && values.size() == count) return values;
    if (*end != separator) break;
  }
  throw UsageError(option, text, "not understood",
                   count == 1 ? "give a number" : fmt::format("give {} numbers separated by `{}`", count, separator));
}

Vec3 vector(const char* option, const std::string& text) {
  const std::vector<float> v = numbers(option, text, ',', 3);
  return {v[0], v[1], v[2]};
}

Vec3 vector(const std::vector<float>& v) { return {v[0], v[1], v[2]}; }

// Whether it is JSON, but not that of a hair mesh.
bool is_scene_file(const std::string& path) {
  if (io::hair_mesh_file(io::ByteSource::open(path)) == io::HairMeshFile::kText) return false;
  std::ifstream file(path, std::ios::binary);
  char c = 0;
  while (file.get(c))
    if (!std::isspace(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 0x80) return c == '{';
  return false;
}

// "directional:0,-1,0:3,3,3", "point:0,1,1:2,2,2"; intensity as in scene files.
Light parse_light(const std::string& text) {
  const std::size_t first = text.find(':'), second = text.find(':', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos)
    throw UsageError("--light", text, "not understood", "directional:DX,DY,DZ:R,G,B or point:X,Y,Z:R,G,B");
  Light light;
  light.type = by_name<Light::Type>("--light", text.substr(0, first),
                                    {{"directional", Light::Type::kDirectional}, {"point", Light::Type::kPoint}});
  const Vec3 place = vector("--light", text.substr(first + 1, second - first - 1));
  light.intensity = vector("--light", text.substr(second + 1));
  if (light.type == Light::Type::kPoint) light.position = place;
  else if (!(length(place) > 0)) throw UsageError("--light", text, "no direction", "");
  else light.direction = normalize(place);
  return light;
}

// A head of hair as people name it. Melanin alone makes black to blond; it never reads as red, whose photographs show four
// times as much red as green where pheomelanin's absorption allows half of that, nor as gray, which is a mixture of hairs:
// these two are given by the color of a dense tuft.
struct HairColor {
  Vec2 melanin;  // eumelanin, pheomelanin
  Vec3 tuft;     // linear; black: the melanin counts
};

void apply_hair_color(const std::string& name, HairMaterial& m) {
  const HairColor hair = by_name<HairColor>("--hair", name,
                                            {{"black", {{6, 0}, {}}},
                                             {"brown", {{0.7f, 0.2f}, {}}},
                                             {"light-brown", {{0.28f, 0.15f}, {}}},
                                             {"blond", {{0.08f, 0.1f}, {}}},
                                             {"red", {{}, {0.28f, 0.062f, 0.016f}}},
                                             {"gray", {{}, {0.2f, 0.2f, 0.205f}}},
                                             {"white", {{0.01f, 0}, {}}}});
  const bool melanin = hair.tuft == Vec3(0, 0, 0);
  m.color_source = melanin ? HairMaterial::ColorSource::kMelanin : HairMaterial::ColorSource::kRgb;
  if (melanin) m.eumelanin = hair.melanin.x, m.pheomelanin = hair.melanin.y;
  else m.color = hair.tuft;
}

void read_groom_scene(const RenderOptions& options, const Progress& progress, std::vector<std::string>& notes, Scene& scene) {
  ImportReport report;
  GroomInstance& groom = scene.grooms.emplace_back();
  if (io::file_kind(io::ByteSource::open(options.input)).content == io::FileContent::kHairMesh) {
    groom.hair_mesh = std::make_shared<HairMesh>(read_hair_mesh(options.input));
  } else {
    groom.strands = std::make_shared<StrandSet>(read_strands(options.input, options.import, &report, progress));
    groom.lod = read_chain(options.input, *groom.strands, progress);
    if (!groom.lod && !read_lod(options.input).empty())
      report.notes.push_back(
          "its thick hairs are left out: the groom is not as the file holds it (scaled, turned or repaired)");
    if (!groom.strands->colors.empty()) groom.material.color_source = HairMaterial::ColorSource::kStrand;
  }
  notes = report.notes;
  if (!report.repairs.clean()) notes.push_back(report.repairs.summary());
  // Meshes that belong to a groom come in its units and axes.
  for (const std::string& path : options.meshes)
    scene.meshes.emplace_back().mesh = std::make_shared<TriangleMesh>(read_mesh(path, report.scale, report.up));
  if (options.meshes.empty() && !options.no_head &&
      (groom.hair_mesh ? grown_on_mannequin(*groom.hair_mesh) : grown_on_mannequin(*groom.strands))) {
    scene.meshes.emplace_back().mesh = std::make_shared<TriangleMesh>(mannequin_head());
    notes.push_back("with the mannequin it was grown on; --no-head leaves it away");
  }
}

/// After the shape and the level.
void set_blend(const RenderOptions& o, ThickHairSettings& s) {
  if (o.lod_blend) s.blend = *o.lod_blend;
  if (o.lod_blend && s.blend > 0) s.level = -1;  // of a scene file
  if (s.shape == LodShape::kThickHairs) return;
  if (o.lod_blend && s.blend > 0)
    throw UsageError("--lod-blend", fmt::format("{:g}", *o.lod_blend), "only thick hairs blend", "leave --lod-as away");
  s.blend = 0;
}

void apply_settings(const RenderOptions& o, RenderSettings& s) {
  if (o.size) {
    const std::vector<float> v = numbers("--size", *o.size, 'x', 2);
    s.width = static_cast<int>(v[0]), s.height = static_cast<int>(v[1]);
    if (s.width < 1 || s.height < 1 || s.width > 16384 || s.height > 16384)
      throw UsageError("--size", *o.size, "out of range", "from 1x1 to 16384x16384");
  }
  if (o.method)
    s.method = by_name<Method>("--method", *o.method,
                               {{"msaa", Method::kMsaa},
                                {"ssaa", Method::kSsaa},
                                {"taa", Method::kTaa},
                                {"fxaa", Method::kFxaa},
                                {"smaa", Method::kSmaa},
                                {"link", Method::kLink},
                                {"link-taa", Method::kLinkTaa},
                                {"oidn", Method::kOidn},
                                {"swr", Method::kSwr}});
  if (o.method && (is_linking(s.method) || s.method == Method::kSwr)) s.samples = 1;
  if (o.frames && !makes_sequence(o)) s.frames = *o.frames;
  if (o.samples) s.samples = *o.samples;
  if (s.method == Method::kMsaa && !is_sample_count(s.samples))
    throw UsageError("--spp", std::to_string(s.samples), "no pattern of msaa", "use 1, 2, 4, 8 or 16, or --method ssaa");
  if (is_linking(s.method) && !is_link_sample_count(s.samples))
    throw UsageError("--spp", std::to_string(s.samples), "no square of visibility pixels",
                     "use 1, 4, 9 or 16 with --method link");
  if (s.method == Method::kSwr && !is_deferred_sample_count(s.samples))
    throw UsageError("--spp", std::to_string(s.samples), "no sample layer of method swr", "use 1, 2, 4 or 8 with --method swr");
  if (o.alpha && s.method == Method::kSwr)
    s.swr.alpha = by_name<SwrAlpha>(
        "--alpha", *o.alpha, {{"kernel", SwrAlpha::kKernel}, {"ratio", SwrAlpha::kRatio}, {"coverage", SwrAlpha::kCoverage}});
  else if (o.alpha && is_linking(s.method))
    s.link.alpha = by_name<LinkAlpha>(
        "--alpha", *o.alpha, {{"count", LinkAlpha::kCount}, {"coverage", LinkAlpha::kCoverage}, {"none", LinkAlpha::kNone}});
  else if (o.alpha)
    s.alpha =
        by_name<AlphaSource>("--alpha", *o.alpha, {{"samples", AlphaSource::kSamples}, {"analytic", AlphaSource::kAnalytic}});
  if (o.kernel_size) s.link.kernel_size = *o.kernel_size;
  if (o.kernel_radius) s.link.kernel_radius = *o.kernel_radius;
  if (o.depth_sigma) s.link.depth_sigma = *o.depth_sigma;
  if (o.no_linking) s.link.link = false;
  if (o.no_filter) s.link.filter = s.swr.filter = false;
  if (o.no_lod) s.swr.lod = s.thick_hairs.on = false;
  if (o.lod_pixels) s.thick_hairs.pixels = *o.lod_pixels, s.thick_hairs.error = 0;  // of a scene file
  if (o.lod_error) s.thick_hairs.error = *o.lod_error;
  if (o.lod_level) s.thick_hairs.level = *o.lod_level, s.thick_hairs.blend = 0;  // of a scene file
  if (o.lod_as)
    s.thick_hairs.shape =
        by_name<LodShape>("--lod-as", *o.lod_as,
                          {{"thick", LodShape::kThickHairs}, {"strands", LodShape::kStrands}, {"cards", LodShape::kCards}});
  if (o.lod_error && s.thick_hairs.error > 0 && s.thick_hairs.shape == LodShape::kCards)
    throw UsageError("--lod-error", fmt::format("{:g}", *o.lod_error), "no prediction for cards",
                     "use --lod-pixels with --lod-as cards");
  set_blend(o, s.thick_hairs);
  if (o.lod_scattering)
    s.thick_hairs.scattering =
        by_name<ThickScattering>("--lod-scattering", *o.lod_scattering,
                                 {{"aggregate", ThickScattering::kAggregate}, {"fiber", ThickScattering::kFiber}});
  if (o.no_occlusion) s.swr.occlusion = false;
  if (o.view)
    s.view = by_name<View>("--view", *o.view,
                           {{"beauty", View::kBeauty},
                            {"strand-id", View::kStrandId},
                            {"u", View::kU},
                            {"tangent", View::kTangent},
                            {"depth", View::kDepth},
                            {"coverage", View::kCoverage},
                            {"overdraw", View::kOverdraw},
                            {"albedo", View::kAlbedo},
                            {"motion", View::kMotion},
                            {"linked", View::kLinked},
                            {"alpha", View::kLinkAlpha},
                            {"lod", View::kLod}});
  if (o.tone_map)
    s.tone_map = by_name<ToneMap>("--tone-map", *o.tone_map, {{"aces", ToneMap::kAces}, {"none", ToneMap::kNone}});
  if (o.exposure) s.exposure = *o.exposure;
  if (o.subdivisions) s.subdivisions = *o.subdivisions;
  if (o.opacity_map_size) s.opacity_map_size = *o.opacity_map_size;
  if (o.no_shadows) s.shadows = false;
  if (o.environment_lighting)
    s.environment_lighting =
        by_name<EnvironmentLighting>("--environment-lighting", *o.environment_lighting,
                                     {{"pieces", EnvironmentLighting::kPieces}, {"probe", EnvironmentLighting::kProbe}});
  if (o.no_dual_scattering) s.dual_scattering = false;
  if (o.background && *o.background == "transparent") s.transparent_background = true;
  else if (o.background) s.background = vector("--background", *o.background), s.transparent_background = false;
}

void apply_material(const RenderOptions& o, HairMaterial& m) {
  using Source = HairMaterial::ColorSource;
  if (o.model)
    m.model = by_name<HairMaterial::Model>("--model", *o.model,
                                           {{"kajiya-kay", HairMaterial::Model::kKajiyaKay},
                                            {"marschner", HairMaterial::Model::kMarschner},
                                            {"zhu", HairMaterial::Model::kZhu},
                                            {"chiang", HairMaterial::Model::kChiang},
                                            {"sadeghi", HairMaterial::Model::kSadeghi},
                                            {"pelekis", HairMaterial::Model::kPelekis}});
  if (o.hair) apply_hair_color(*o.hair, m);
  if (!o.melanin.empty())
    m.eumelanin = o.melanin[0], m.pheomelanin = o.melanin.size() > 1 ? o.melanin[1] : 0, m.color_source = Source::kMelanin;
  if (!o.color.empty()) m.color = vector(o.color), m.color_source = Source::kRgb;
}

void apply_camera(const RenderOptions& o, Camera& camera) {
  if (o.fov) {
    // Keeps the subject's size: a wider angle from nearer.
    const float nearer = std::tan(camera.fov_y / 2) / std::tan(*o.fov * kDegree / 2);
    if (o.eye.empty()) camera.eye = camera.target + (camera.eye - camera.target) * nearer;
    camera.fov_y = *o.fov * kDegree;
  }
  if (o.orthographic) camera.projection = Camera::Projection::kOrthographic;
  if (!o.eye.empty()) camera.eye = vector(o.eye);
  if (!o.target.empty()) camera.target = vector(o.target);
  if (o.turn) camera = turned(camera, *o.turn);
  if (o.stereo) {
    Stereo stereo = camera.stereo.value_or(Stereo());
    stereo.separation = numbers("--stereo", *o.stereo, ',', 1)[0];
    camera.stereo = stereo.separation == 0 ? std::optional<Stereo>() : stereo;
  }
  if (o.convergence && !camera.stereo) throw UsageError("--convergence", "", "a picture of one eye has none", "add --stereo");
  if (o.convergence) camera.stereo->convergence = *o.convergence;
}

void apply_environment(const RenderOptions& o, Environment& environment) {
  if (o.environment) {
    environment.map = std::make_shared<Image>(read_image(*o.environment));
    if (environment.map->channel_count() < 3) throw Error(*o.environment, "", "the image has no red, green and blue", "");
    environment.radiance = {1, 1, 1};
  }
  if (o.environment_rotation) environment.rotation = *o.environment_rotation * kDegree;
  if (o.environment_visible) environment.visible = true;
}

}  // namespace

Camera turned(Camera camera, float degrees) {
  const float c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  const Vec3 d = camera.eye - camera.target;
  camera.eye = camera.target + Vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
  return camera;
}

void add_frame_options(CLI::App& verb, RenderOptions& o) {
  verb.add_option("--frame", o.frame, "Frame of hair that moves (pelage simulate), by its number; else it is at rest")
      ->type_name("N");
  verb.add_flag("--still-meshes", o.still_meshes, "Meshes stay when hair moves; else they go with its head");
}

Scene at_chosen_frame(const RenderOptions& options, Scene scene) {
  if (!options.frame) return scene;
  check_frames("--frame", scene, {*options.frame, *options.frame});
  return at_frame(scene, *options.frame, options.still_meshes);
}

Scene make_scene(const RenderOptions& options, const Progress& progress, std::vector<std::string>& notes) {
  Scene scene;
  const bool from_file = is_scene_file(options.input);
  if (from_file) {
    scene = read_scene(options.input, progress);
    const float scale = options.import.scale > 0 ? options.import.scale : 1;
    const UpAxis up = options.import.up == UpAxis::kZ ? UpAxis::kZ : UpAxis::kY;
    for (const std::string& path : options.meshes)
      scene.meshes.emplace_back().mesh = std::make_shared<TriangleMesh>(read_mesh(path, scale, up));
    apply_settings(options, scene.settings);
  } else {
    apply_settings(options, scene.settings);  // before the camera, which frames for the picture's shape
    read_groom_scene(options, progress, notes, scene);
    add_default_camera(scene);
  }
  apply_camera(options, scene.camera);
  if (!from_file && options.lights.empty() && !options.environment) add_default_lights(scene);
  if (!options.lights.empty()) scene.lights.clear();
  for (const std::string& light : options.lights) scene.lights.push_back(parse_light(light));
  apply_environment(options, scene.environment);
  for (GroomInstance& groom : scene.grooms) {
    apply_material(options, groom.material);
    if (options.width_scale) groom.width_scale *= *options.width_scale;
  }
  return scene;
}

}  // namespace pelage::cli
