// What a scene file says, word for word, before anything that it names is loaded.
#pragma once

#include <pelage/grow.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>
#include <pelage/scene.h>

#include <optional>
#include <string>
#include <vector>

#include "io/scene_json.h"

namespace pelage::io {

struct TransformText {
  Vec3 translate{0, 0, 0};  // metres
  Vec3 rotate{0, 0, 0};     // degrees about X, then Y, then Z
  float scale = 1;
};
Affine to_affine(const TransformText& transform);

struct EnvironmentText {
  EnvironmentText() { environment.radiance = {1, 1, 1}; }
  Environment environment;
  std::string map;  // file, "" none
};

struct MeshText {
  MeshInstance instance;
  std::string file, shape, texture;  // exactly one of file and shape
  float scale = 1;
  UpAxis up = UpAxis::kY;
  TransformText transform;
};

struct GrowText {
  GrowSettings settings;
  std::string surface = "mannequin";  // or the name of a mesh of the scene
};

struct GroomText {
  GroomInstance instance;
  std::string file, color_map, color_along, roughness_map, roughness_along, tilt_map, tilt_along;
  std::optional<GrowText> grow;               // exactly one of file, grow
  std::optional<HairMeshSettings> hair_mesh;  // and this, which `grow` may say as well
  ImportOptions import;
  TransformText transform;
};

struct SceneText {
  std::string schema;
  std::optional<Camera> camera;
  std::optional<std::vector<Light>> lights;
  std::optional<EnvironmentText> environment;
  std::vector<MeshText> meshes;
  std::vector<GroomText> grooms;
  RenderSettings settings;
};

/// Throws Error that names line and key. Loads nothing.
SceneText read_scene_text(const std::string& name, std::vector<char> json);

/// The keys of a scene file.
const Fields<SceneText>& scene_fields();

/// The JSON schema of scene files, from the same tables: docs/scene.schema.json.
std::string scene_schema();

}  // namespace pelage::io
