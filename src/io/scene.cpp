// Scene files: what the JSON says, then what it names.
#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>
#include <pelage/lod.h>

#include <filesystem>

#include "core/nearest.h"
#include "frame/material_map.h"
#include "io/byte_source.h"
#include "io/file_kind.h"
#include "io/scene_tables.h"

namespace pelage {
namespace {

using namespace io;

// Loads what a scene file names, and tells an error there with the scene file's name in front.
class Loader {
 public:
  Loader(const std::string& path, const Progress& progress)
      : path_(path), folder_(std::filesystem::path(path).parent_path()), progress_(progress) {}

  Scene load(const SceneText& text) {
    Scene scene;
    scene.settings = text.settings;
    for (std::size_t i = 0; i < text.meshes.size(); ++i) scene.meshes.push_back(load_mesh(text.meshes[i], i));
    for (std::size_t i = 0; i < text.grooms.size(); ++i) scene.grooms.push_back(load_groom(text.grooms[i], i, scene.meshes));
    if (text.camera) scene.camera = *text.camera;
    else add_default_camera(scene);
    if (!text.lights && !text.environment) add_default_lights(scene);
    if (text.environment) scene.environment = load_environment(*text.environment);
    if (text.lights)
      for (std::size_t i = 0; i < text.lights->size(); ++i) scene.lights.push_back(checked_light((*text.lights)[i], i));
    return scene;
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& problem, const std::string& remedy) const {
    throw Error(path_, place, problem, remedy);
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  void require_one(const std::string& place, const char* a, bool has_a, const char* b, bool has_b) const {
    if (has_a != has_b) return;
    fail(place, fmt::format("{} `{}` and `{}`", has_a ? "both" : "neither", a, b), "give exactly one of them");
  }

  MeshInstance load_mesh(const MeshText& text, std::size_t i) const {
    const std::string place = fmt::format("/meshes/{}", i);
    require_one(place, "file", !text.file.empty(), "shape", !text.shape.empty());
    if (!text.shape.empty() && text.shape != "mannequin")
      fail(place + "/shape", fmt::format("unknown value `{}`", text.shape), "did you mean `mannequin`?");
    MeshInstance mesh = text.instance;
    mesh.mesh =
        std::make_shared<TriangleMesh>(text.file.empty() ? mannequin_head() : read_mesh(file(text.file), text.scale, text.up));
    if (!text.texture.empty()) mesh.texture = std::make_shared<Image>(read_image(file(text.texture)));
    mesh.transform = to_affine(text.transform);
    return mesh;
  }

  GroomInstance load_groom(const GroomText& text, std::size_t i, const std::vector<MeshInstance>& meshes) const {
    const std::string place = fmt::format("/grooms/{}", i);
    require_one(place, "file", !text.file.empty(), "grow", text.grow || text.hair_mesh);
    GroomInstance groom = text.instance;
    groom.transform = to_affine(text.transform);
    if (text.grow)
      groom.strands =
          std::make_shared<StrandSet>(grow(text.grow->settings, surface(text.grow->surface, place, meshes), progress_));
    else if (text.hair_mesh) groom.hair_mesh = std::make_shared<HairMesh>(make_hair_mesh(*text.hair_mesh, progress_));
    else if (file_kind(ByteSource::open(file(text.file))).content == FileContent::kHairMesh)
      groom.hair_mesh = std::make_shared<HairMesh>(read_hair_mesh(file(text.file)));
    else {
      groom.strands = std::make_shared<StrandSet>(read_strands(file(text.file), text.import, nullptr, progress_));
      groom.lod = read_chain(file(text.file), *groom.strands, progress_);
    }
    groom.color_map = load_map(text.color_map, place + "/color_map");
    groom.color_along = load_map(text.color_along, place + "/color_along");
    groom.roughness_map = load_factors(text.roughness_map, place + "/roughness_map");
    groom.roughness_along = load_factors(text.roughness_along, place + "/roughness_along");
    groom.tilt_map = load_factors(text.tilt_map, place + "/tilt_map");
    groom.tilt_along = load_factors(text.tilt_along, place + "/tilt_along");
    return groom;
  }

  /// An image with colors; null for no name.
  std::shared_ptr<const Image> load_map(const std::string& name, const std::string& place) const {
    if (name.empty()) return nullptr;
    auto map = std::make_shared<Image>(read_image(file(name)));
    if (map->channel_count() < 3) fail(place, "the image has no red, green and blue", "");
    return map;
  }

  /// An image with numbers in its first channel, 0…kMostFinish; null for no name.
  std::shared_ptr<const Image> load_factors(const std::string& name, const std::string& place) const {
    if (name.empty()) return nullptr;
    auto map = std::make_shared<Image>(read_image(file(name), false));
    for (std::size_t i = 0; i < map->pixels.size(); i += map->channel_count()) {
      const float value = map->pixels[i];
      if (value >= 0 && value <= kMostFinish) continue;
      const std::size_t p = i / map->channel_count(), width = static_cast<std::size_t>(map->width);
      fail(place, fmt::format("pixel ({}, {}) is {}", p % width, p / width, value), fmt::format("from 0 to {}", kMostFinish));
    }
    return map;
  }

  TriangleMesh surface(const std::string& name, const std::string& place, const std::vector<MeshInstance>& meshes) const {
    std::vector<std::string> known{"mannequin"};
    for (const MeshInstance& mesh : meshes) {
      if (mesh.name == name) return *mesh.mesh;
      known.push_back(mesh.name);
    }
    if (name != "mannequin")
      fail(place + "/grow/surface", fmt::format("no mesh has the name `{}`", name),
           fmt::format("did you mean `{}`?", nearest_name(name, known)));
    return mannequin_head();
  }

  Environment load_environment(const EnvironmentText& text) const {
    Environment environment = text.environment;
    if (text.map.empty()) return environment;
    environment.map = std::make_shared<Image>(read_image(file(text.map)));
    if (environment.map->channel_count() < 3) fail("/environment/map", "the image has no red, green and blue", "");
    return environment;
  }

  Light checked_light(Light light, std::size_t i) const {
    const std::string place = fmt::format("/lights/{}", i);
    if (light.type != Light::Type::kPoint && !(length(light.direction) > 0)) fail(place + "/direction", "no direction", "");
    if (light.type == Light::Type::kSpot && light.outer_angle <= light.inner_angle)
      fail(place + "/outer_angle", "not greater than inner_angle", "");
    light.direction = normalize(light.direction);
    return light;
  }

  std::string path_;
  std::filesystem::path folder_;
  Progress progress_;
};

}  // namespace

Scene read_scene(const std::string& path, const Progress& progress) {
  constexpr std::uint64_t kMostBytes = 64u << 20;
  const ByteSource source = ByteSource::open(path);
  if (source.size() == 0) throw Error(path, "", "the file is empty", "a scene file is a JSON object");
  if (source.size() > kMostBytes) throw Error(path, "", "more than 64 MiB of JSON", "grooms stand in files of their own");
  return Loader(path, progress).load(read_scene_text(path, source.read_all()));
}

}  // namespace pelage
