// Writes the files that the fuzzers start from: fuzz_corpus FOLDER makes FOLDER/<target>/*.
#include <pelage/io.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "kit/hair_mesh_kit.h"
#include "kit/lod_kit.h"

namespace {

using namespace pelage;

StrandSet groom(std::uint32_t strands, std::uint32_t points, bool everything) {
  StrandSet set;
  set.offsets = {0};
  set.widths = {8e-5f};
  for (std::uint32_t s = 0; s < strands; ++s) {
    for (std::uint32_t i = 0; i < points; ++i)
      set.points.emplace_back(0.01f * static_cast<float>(s), -0.02f * static_cast<float>(i), 0.001f * static_cast<float>(i));
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  if (!everything) return set;
  set.widths.assign(set.point_count(), 7e-5f);
  set.colors.assign(set.point_count(), Vec3(0.2f, 0.1f, 0.05f));
  set.transparency.assign(set.point_count(), 0.5f);
  set.root_uv.assign(strands, Vec2(0.25f, 0.75f));
  set.strand_id.assign(strands, 5);
  set.guide_id.assign(strands, -1);
  set.group.assign(strands, 2);
  set.comment = "corpus";
  return set;
}

TriangleMesh quad() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

void spill(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string glb() {
  const auto u = [](std::size_t value) {
    const auto v = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&v), 4);
  };
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"translation":[1,2,3]},)"
      R"({"mesh":0,"scale":[2,2,2],"rotation":[0,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
      R"("indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},)"
      R"({"buffer":0,"byteOffset":36,"byteLength":3}],"buffers":[{"byteLength":40}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string binary = std::string(reinterpret_cast<const char*>(points), 36) + std::string("\0\1\2\0", 4);
  const std::string chunks = u(json.size()) + "JSON" + json + u(binary.size()) + std::string("BIN\0", 4) + binary;
  return "glTF" + u(2) + u(12 + chunks.size()) + chunks;
}

// Every kind of field once; the named files are only names here.
constexpr const char* kScene = R"({"$schema": "scene.schema.json",
  "camera": {"projection": "perspective", "eye": [0, 1.6, 2], "target": [0, 1.5, 0], "up": [0, 1, 0], "fov": 30, "near": 0.01},
  "lights": [{"type": "spot", "name": "key", "position": [1, 2, 3], "direction": [0, -1, 0], "intensity": [1, 1, 1],
              "inner_angle": 10, "outer_angle": 20, "casts_shadow": false}],
  "environment": {"radiance": [0.1, 0.1, 0.1], "map": "sky.exr", "rotation": 90, "visible": true},
  "meshes": [{"name": "head", "shape": "mannequin", "color": [0.4, 0.3, 0.2], "transform": {"rotate": [0, 90, 0], "scale": 2}}],
  "grooms": [{"name": "hair", "grow": {"style": "curly", "strands": 100, "points": 8, "surface": "head"},
              "material": {"model": "zhu", "eumelanin": 1}},
             {"file": "a.hair", "import": {"scale": 0.01, "up": "z"}}],
  "settings": {"width": 64, "height": 48, "samples": 4, "view": "depth", "background": [0, 0, 0], "exposure": -1}})";

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::string root = argv[1];
  const auto folder = [&](const std::string& name) {
    std::filesystem::create_directories(root + "/" + name);
    return root + "/" + name + "/";
  };
  const std::pair<const char*, const char*> formats[] = {
      {"cyhair", "cyhair"}, {"pelage", "pelage"}, {"tressfx", "tressfx"}, {"usc", "usc"}};
  for (const auto& [target, format] : formats) {
    const std::string at = folder(target);
    write_strands(at + "small", groom(2, 3, false), format);
    write_strands(at + "full", groom(3, 4, true), format);
  }
  write_lod(folder("pelage") + "lod.pelage", groom(3, 4, true), kit::small_lod(groom(3, 4, true)));
  std::string old(296, '\0');  // TressFX 3: two strands of two points
  old[2] = old[3] = 0x40, old[4] = 2, old[8] = 2, old[144] = 0x28, old[145] = 1;
  const float points[12] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0};
  spill(folder("tressfx3") + "small", old + std::string(reinterpret_cast<const char*>(points), sizeof points));
#if PELAGE_HAIRMESH
  write_hair_mesh(folder("hair_mesh") + "small.hairmesh", kit::two_bundles(2));
  write_hair_mesh(folder("hair_mesh") + "exact.hairmesh", kit::two_bundles(),
                  {.float_positions = true, .wide_attributes = true});
  write_hair_mesh(folder("hair_mesh_text") + "small.json", kit::two_bundles(2));
#endif
  write_mesh(folder("mesh_obj") + "quad.obj", quad());
  write_mesh(folder("mesh_ply") + "quad.ply", quad());
  spill(folder("mesh_ply") + "ascii",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  spill(folder("mesh_glb") + "triangle", glb());
  spill(folder("mesh_tfxmesh") + "triangle",
        "numOfBones 1\n0 root\nnumOfVertices 3\n0 0 0 0 0 0 1\n1 1 0 0 0 0 1\n2 0 1 0 0 0 1\nnumOfTriangles 1\n0 0 1 2\n");
  spill(folder("scene") + "everything", kScene);
  Image image(5, 3, {"R", "G", "B", "A"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i % 7) / 7;
  write_image(folder("image_png") + "small.png", image);
  write_image(folder("image_png") + "sixteen.png", image, true);
  write_image(folder("image_exr") + "half.exr", image);
  write_image(folder("image_exr") + "float.exr", image, true);
  write_image(folder("image_hdr") + "runs.hdr", Image(9, 2, {"R", "G", "B"}));
  spill(folder("image_hdr") + "repeated", "#?RADIANCE\nEXPOSURE=2\n\n-Y 2 +X 2\n\x80\x40\x20\x81\1\1\1\3");
  return 0;
}
