// Scene files: what they may say, what happens when they say something else, and that the published schema agrees.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "io/scene_tables.h"

namespace pelage {
namespace {

class SceneFile : public testing::Test {
 protected:
  SceneFile() {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("scene_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  ~SceneFile() override { std::filesystem::remove_all(folder_); }

  Scene read(const std::string& json) {
    path_ = (folder_ / "scene.json").string();
    std::ofstream(path_) << json;
    return read_scene(path_);
  }
  // What the error says after the file's name; "" when there is none.
  std::string error(const std::string& json) {
    try {
      read(json);
    } catch (const Error& e) {
      EXPECT_EQ(e.where(), path_) << e.what();
      return std::string(e.what()).substr(path_.size() + 2);
    }
    return "";
  }

  std::filesystem::path folder_;
  std::string path_;
};

constexpr char kTinyGroom[] = R"({"grooms": [{"grow": {"style": "curly", "strands": 20, "points": 8}}]})";

TEST_F(SceneFile, AFewWordsMakeAWholeScene) {
  const Scene scene = read(kTinyGroom);
  ASSERT_EQ(scene.grooms.size(), 1u);
  EXPECT_EQ(scene.grooms[0].strands->strand_count(), 20u);
  EXPECT_EQ(scene.grooms[0].strands->point_count(), 160u);
  EXPECT_EQ(scene.lights.size(), 3u) << "three-point light";
  EXPECT_GT(length(scene.camera.eye - scene.camera.target), 0.1f);
}

TEST_F(SceneFile, MakesAHairMesh) {
  if (hair_mesh_style_names().empty()) GTEST_SKIP() << "a build without hair meshes";
  const Scene scene = read(R"({"grooms": [
    {"grow": {"hair_mesh": "curls", "strands": 3000, "seed": 4, "width": 1e-4, "length_scale": 0.75, "parting": 0.01}},
    {"grow": {"hair_mesh": "bob", "occlusion": false}}], "settings": {"method": "swr", "swr": {"occlusion": false}}})");
  ASSERT_EQ(scene.grooms.size(), 2u);
  EXPECT_EQ(scene.grooms[0].strands, nullptr) << "method swr makes them as it draws";
  const HairMesh& made = *scene.grooms[0].hair_mesh;
  const HairMesh expected = make_hair_mesh(
      {.style = HairMeshStyle::kCurls, .seed = 4, .strands = 3000, .width = 1e-4f, .length = 0.75f, .parting = 0.01f});
  EXPECT_EQ(made.positions, expected.positions);
  EXPECT_EQ(made.occlusion, expected.occlusion);
  EXPECT_EQ(made.width, 1e-4f);
  EXPECT_EQ(strand_count(made), 3000u);
  EXPECT_TRUE(scene.grooms[1].hair_mesh->occlusion.empty());
  EXPECT_EQ(strand_count(*scene.grooms[1].hair_mesh), HairMeshSettings{}.strands);
  EXPECT_FALSE(scene.settings.swr.occlusion);
  const std::pair<const char*, const char*> mistakes[] = {
      {R"({"grooms": [{"grow": {"hair_mesh": "curl"}}]})",
       "line 1: /grooms/0/grow/hair_mesh: unknown value `curl` (did you mean `curls`?)"},
      {R"({"grooms": [{"grow": {"hair_mesh": "bob", "strands": 10}}]})",
       "line 1: /grooms/0/grow/strands: 10 is out of range (from 1000 to 1000000)"},
      {R"({"grooms": [{"grow": {"hair_mesh": "bob", "length_scale": 2}}]})",
       "line 1: /grooms/0/grow/length_scale: 2 is out of range (from 0.5 to 1.5)"},
      {R"({"grooms": [{"grow": {"hair_mesh": "bob", "partin": 0}}]})",
       "line 1: /grooms/0/grow/partin: unknown key `partin` (did you mean `parting`?)"},
      {R"({"grooms": [{"grow": {"hairmesh": "bob"}}]})",
       "line 1: /grooms/0/grow/hairmesh: unknown key `hairmesh` (did you mean `hair_mesh`?)"},
      {R"({"grooms": [{"grow": {"hair_mesh": "bob", "style": "curly"}}]})",
       "line 1: /grooms/0/grow: both `style` and `hair_mesh` (give exactly one of them)"},
      {R"({"grooms": [{"grow": {"seed": 1}}]})",
       "line 1: /grooms/0/grow: neither `style` nor `hair_mesh` (give exactly one of them)"},
      {R"({"grooms": [{"grow": "bob"}]})", "line 1: /grooms/0/grow: string where an object is expected"},
      {R"({"grooms": [{"grow": {"hair_mesh": "bob"}, "file": "bob.hairmesh"}]})",
       "/grooms/0: both `file` and `grow` (give exactly one of them)"},
  };
  for (const auto& [json, expected_error] : mistakes) EXPECT_EQ(error(json), expected_error) << json;
}

TEST_F(SceneFile, MapsAreColorsOrNumbers) {
  Image gray(2, 1, {"Y"}), wild(2, 1, {"Y"});
  gray.pixels = {0.5f, 1}, wild.pixels = {1, -3};
  write_image((folder_ / "gray.png").string(), gray);
  write_image((folder_ / "wild.exr").string(), wild);
  const auto with = [](const std::string& keys) {
    return R"({"grooms": [{"grow": {"style": "curly", "strands": 2}, )" + keys + "}]}";
  };
  const GroomInstance groom =
      read(
          with(
              R"("roughness_map": "gray.png", "roughness_along": "gray.png", "tilt_map": "gray.png", "tilt_along": "gray.png")"))
          .grooms.at(0);
  for (const auto& map : {groom.roughness_map, groom.roughness_along, groom.tilt_map, groom.tilt_along}) {
    ASSERT_TRUE(map);
    EXPECT_EQ(map->pixels, (std::vector<float>{128 / 255.f, 1})) << "as they stand in the file";
  }
  EXPECT_EQ(groom.color_map, nullptr);
  EXPECT_EQ(error(with(R"("tilt_along": "wild.exr")")), "/grooms/0/tilt_along: pixel (1, 0) is -3 (from 0 to 16)");
  EXPECT_EQ(error(with(R"("color_map": "gray.png")")), "/grooms/0/color_map: the image has no red, green and blue");
}

TEST_F(SceneFile, MaterialsOfChiangAndSadeghi) {
  const Scene scene = read(R"({"grooms": [
    {"grow": {"style": "straight", "strands": 2}, "material": {"model": "chiang", "beta_m": 0.3, "beta_n": 0.4}},
    {"grow": {"style": "straight", "strands": 2}, "material": {"model": "sadeghi", "artist": {
       "r": {"intensity": 0.2, "color": [0.9, 0.8, 0.7], "shift": -5, "width": 6}, "tt": {"intensity": 0.3}, "trt": {"shift": 7},
       "tt_azimuthal_width": 12, "glint_intensity": 0.15, "glint_angle": 40, "glint_width": 5}}}]})");
  const HairMaterial& chiang = scene.grooms.at(0).material;
  EXPECT_EQ(chiang.model, HairMaterial::Model::kChiang);
  EXPECT_NEAR(chiang.beta_longitudinal, 0.5 * (0.726 * 0.3 + 0.812 * 0.09), 1e-5) << "half of the root of Chiang 2016, eq. 7";
  EXPECT_NEAR(chiang.beta_azimuthal, 0.626657 * (0.265 * 0.4 + 1.194 * 0.16) * 1.813799, 1e-5) << "Chiang 2016, eq. 8";
  const HairMaterial& sadeghi = scene.grooms.at(1).material;
  EXPECT_EQ(sadeghi.model, HairMaterial::Model::kSadeghi);
  const ArtistLobes& a = sadeghi.artist;
  EXPECT_EQ(a.r.intensity, 0.2f);
  EXPECT_EQ(a.r.color, Vec3(0.9f, 0.8f, 0.7f));
  EXPECT_NEAR(a.r.shift, -0.0872665f, 1e-6f);
  EXPECT_NEAR(a.r.width, 0.1047198f, 1e-6f);
  EXPECT_EQ(a.tt.intensity, 0.3f);
  EXPECT_EQ(a.tt.width, ArtistLobes{}.tt.width) << "what is not said stays";
  EXPECT_NEAR(a.trt.shift, 0.122173f, 1e-6f);
  EXPECT_NEAR(a.tt_azimuthal_width, 0.20944f, 1e-5f);
  EXPECT_EQ(a.glint_intensity, 0.15f);
  EXPECT_NEAR(a.glint_angle, 0.698132f, 1e-5f);
  EXPECT_NEAR(a.glint_width, 0.0872665f, 1e-6f);
}

TEST_F(SceneFile, CamerasMayHaveTwoEyesAndAShiftedLens) {
  const auto camera_with = [&](const std::string& keys) {
    return read(R"({"camera": {"eye": [0, 0, 1], "target": [0, 0, 0])" + keys + "}}").camera;
  };
  EXPECT_FALSE(camera_with("").stereo);
  EXPECT_EQ(camera_with(R"(, "stereo": {})").stereo->separation, 0.063f);
  const Camera camera = camera_with(R"(, "stereo": {"separation": 0.07, "convergence": 1.5}, "shift_x": 0.2, "shift_y": -0.1)");
  EXPECT_EQ(camera.stereo->separation, 0.07f);
  EXPECT_EQ(camera.stereo->convergence, 1.5f);
  EXPECT_EQ(camera.shift_x, 0.2f);
  EXPECT_EQ(camera.shift_y, -0.1f);
  EXPECT_THROW(camera_with(R"(, "stereo": {"separation": 0})"), Error);
  EXPECT_THROW(camera_with(R"(, "stereo": {"convergence": -1})"), Error);
  EXPECT_THROW(camera_with(R"(, "shift_x": 11)"), Error);
}

TEST_F(SceneFile, EveryValueArrives) {
  std::ofstream(folder_ / "strand.obj") << "v 0 0 0\nv 0 0.1 0\nv 0.1 0 0\nf 1 2 3\n";
  const Scene scene = read(R"({
    "$schema": "scene.schema.json",
    "camera": {"projection": "orthographic", "eye": [1, 2, 3], "target": [0, 0.5, 0], "up": [0, 0, 1], "fov": 90, "height": 0.7, "near": 0.25},
    "lights": [{"type": "spot", "name": "key", "position": [4, 5, 6], "direction": [0, 0, -2], "intensity": [7, 8, 9],
                "inner_angle": 10, "outer_angle": 20, "casts_shadow": false}],
    "environment": {"radiance": [0.1, 0.2, 0.3], "rotation": 180, "visible": true},
    "meshes": [{"name": "tile", "file": "strand.obj", "scale": 2, "color": [0.1, 0.2, 0.3], "specular": 0.5, "roughness": 0.25,
                "transform": {"translate": [1, 0, 0], "rotate": [0, 90, 0], "scale": 3}}],
    "grooms": [{"name": "fur", "grow": {"style": "coat", "surface": "tile", "strands": 5, "points": 4, "seed": 9, "length": 0.01},
                "material": {"model": "zhu", "color": [0.4, 0.5, 0.6], "eumelanin": 2, "eta": 1.4, "beta_longitudinal": 9, "cuticle_tilt": 1},
                "width_scale": 2}],
    "settings": {"width": 320, "height": 200, "samples": 50, "method": "ssaa", "alpha": "analytic", "view": "u", "exposure": -1.5, "tone_map": "none",
                 "background": [1, 2, 3], "transparent_background": true, "subdivisions": 3, "shadows": false,
                 "dual_scattering": false, "opacity_map_size": 256}
  })");
  EXPECT_EQ(scene.camera.projection, Camera::Projection::kOrthographic);
  EXPECT_EQ(scene.camera.eye, Vec3(1, 2, 3));
  EXPECT_EQ(scene.camera.up, Vec3(0, 0, 1));
  EXPECT_NEAR(scene.camera.fov_y, 1.5708f, 1e-4f);
  EXPECT_EQ(scene.camera.height, 0.7f);
  EXPECT_EQ(scene.camera.near_plane, 0.25f);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].type, Light::Type::kSpot);
  EXPECT_EQ(scene.lights[0].direction, Vec3(0, 0, -1)) << "of unit length";
  EXPECT_EQ(scene.lights[0].intensity, Vec3(7, 8, 9));
  EXPECT_NEAR(scene.lights[0].outer_angle, 0.349f, 1e-3f);
  EXPECT_FALSE(scene.lights[0].casts_shadow);
  EXPECT_EQ(scene.environment.radiance, Vec3(0.1f, 0.2f, 0.3f));
  EXPECT_NEAR(scene.environment.rotation, 3.14159f, 1e-4f);
  EXPECT_TRUE(scene.environment.visible);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].mesh->positions[1], Vec3(0, 0.2f, 0)) << "in meters";
  const Vec3 moved = transform_point(scene.meshes[0].transform, {0, 0, 1});
  EXPECT_NEAR(moved.x, 4, 1e-5f) << "+Z turns to +X about +Y";
  EXPECT_NEAR(moved.z, 0, 1e-5f);
  const GroomInstance& groom = scene.grooms.at(0);
  EXPECT_EQ(groom.strands->strand_count(), 5u);
  EXPECT_EQ(groom.material.model, HairMaterial::Model::kZhu);
  EXPECT_EQ(groom.material.color_source, HairMaterial::ColorSource::kRgb) << "a color is meant";
  EXPECT_EQ(groom.material.color, Vec3(0.4f, 0.5f, 0.6f));
  EXPECT_EQ(groom.width_scale, 2);
  const RenderSettings& s = scene.settings;
  EXPECT_EQ(s.width, 320);
  EXPECT_EQ(s.method, Method::kSsaa);
  EXPECT_EQ(s.samples, 50);
  EXPECT_EQ(s.alpha, AlphaSource::kAnalytic);
  EXPECT_EQ(s.view, View::kU);
  EXPECT_EQ(s.exposure, -1.5f);
  EXPECT_EQ(s.tone_map, ToneMap::kNone);
  EXPECT_TRUE(s.transparent_background);
  EXPECT_EQ(s.subdivisions, 3);
  EXPECT_FALSE(s.shadows);
  EXPECT_FALSE(s.dual_scattering);
  EXPECT_EQ(s.opacity_map_size, 256);
}

TEST_F(SceneFile, UnknownKeysNameTheNearestWithTheirLine) {
  EXPECT_EQ(error("{\n \"settings\": {\n  \"width\": 64,\n  \"hieght\": 64\n }\n}"),
            "line 4: /settings/hieght: unknown key `hieght` (did you mean `height`?)");
  EXPECT_EQ(error("{\"grooms\": [\n{\"grow\": {\"style\": \"curly\"}},\n{\"flie\": \"a.hair\"}]}"),
            "line 3: /grooms/1/flie: unknown key `flie` (did you mean `file`?)");
  EXPECT_EQ(error("{\"camra\": {}}"), "line 1: /camra: unknown key `camra` (did you mean `camera`?)");
}

TEST_F(SceneFile, WrongValuesAreTold) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"settings": {"width": 0}})", "line 1: /settings/width: 0 is out of range (from 1 to 16384)"},
      {R"({"settings": {"width": 1.5}})", "line 1: /settings/width: number where a whole number is expected"},
      {R"({"settings": {"width": 99999999999999999999}})", "line 1: /settings/width: number where a whole number is expected"},
      {R"({"settings": {"width": 18446744073709551615}})",
       "line 1: /settings/width: 18446744073709551615 is out of range (from 1 to 16384)"},
      {R"({"settings": {"samples": 3}})",
       "line 1: /settings/samples: 3 samples per pixel (1, 2, 4, 8 or 16; others with method ssaa)"},
      {R"({"settings": {"view": "dept"}})", "line 1: /settings/view: unknown value `dept` (did you mean `depth`?)"},
      {R"({"settings": {"shadows": 1}})", "line 1: /settings/shadows: number where true or false is expected"},
      {R"({"settings": {"background": [1, 2]}})", "line 1: /settings/background: 2 elements where 3 numbers are expected"},
      {R"({"settings": {"background": [1, 2, "x"]}})", "line 1: /settings/background/2: string where a number is expected"},
      {R"({"settings": []})", "line 1: /settings: array where an object is expected"},
      {R"({"camera": {"eye": [0, 0, 1]}})", "line 1: /camera: the key `target` is missing"},
      {R"({"lights": [{"type": "directional", "direction": [0, 0, 0]}]})", "/lights/0/direction: no direction"},
      {R"({"lights": [{"type": "spot", "inner_angle": 30, "outer_angle": 20}]})",
       "/lights/0/outer_angle: not greater than inner_angle"},
      {R"({"grooms": [{}]})", "/grooms/0: neither `file` and `grow` (give exactly one of them)"},
      {R"({"grooms": [{"grow": {"style": "curly", "surface": "hed"}}], "meshes": [{"name": "head", "shape": "mannequin"}]})",
       "/grooms/0/grow/surface: no mesh has the name `hed` (did you mean `head`?)"},
      {R"({"meshes": [{"shape": "manequin"}]})", "/meshes/0/shape: unknown value `manequin` (did you mean `mannequin`?)"},
      {R"([])", "line 1: /: array where an object is expected"},
      {"{\"settings\": {},\n \"settings\": {}}", "line 2: /settings: this key is given twice (keep one)"},
  };
  for (const auto& [json, expected] : cases) EXPECT_EQ(error(json), expected) << json;
}

TEST_F(SceneFile, BrokenJsonNamesItsLine) {
  EXPECT_EQ(error("{\n\"settings\": {\"view\": " + std::string(70, '[') + "\n" + std::string(70, ']') + "}}"),
            "line 2: objects and arrays nested too deep (a scene file is flat)");
  EXPECT_NE(error("{\n\"camera\": \n}").find("line 3"), std::string::npos);
  EXPECT_NE(error("").find("the file is empty"), std::string::npos);
  EXPECT_FALSE(error("{\"settings\": {\"exposure\": 1e999}}").empty());
  EXPECT_FALSE(error(std::string(100000, '[')).empty());
  EXPECT_FALSE(error("\xff\xfe").empty());
}

// Every prefix of a good file is an error, never a crash or a scene.
TEST_F(SceneFile, TruncationAtEveryLengthIsAnError) {
  const std::string whole = kTinyGroom;
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_FALSE(error(whole.substr(0, n)).empty()) << n;
}

TEST_F(SceneFile, MissingFilesNameThemselves) {
  try {
    read(R"({"grooms": [{"file": "nowhere.hair"}]})");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), (folder_ / "nowhere.hair").string()) << "found relative to the scene file";
  }
  EXPECT_THROW(read_scene((folder_ / "none.json").string()), Error);
  EXPECT_THROW(read_scene(folder_.string()), Error);
}

TEST(SceneSchema, ThePublishedFileIsWhatTheReaderReads) {
  if (hair_mesh_style_names().empty()) GTEST_SKIP() << "a build without hair meshes, whose styles the published one names";
  std::ifstream file(PELAGE_SOURCE_DIR "/docs/scene.schema.json");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), io::scene_schema()) << "make it again: pelage render --schema > docs/scene.schema.json";
}

TEST(SceneSchema, NoEmptyDescriptionAndNoOpenObject) {
  const std::function<void(const nlohmann::json&)> visit = [&](const nlohmann::json& schema) {
    if (schema.contains("properties")) {
      EXPECT_EQ(schema["additionalProperties"], false);
      for (const auto& [key, part] : schema["properties"].items()) {
        EXPECT_GT(part.value("description", "").size(), 3u) << key;
        visit(part);
      }
    }
    if (schema.contains("items")) visit(schema["items"]);
    if (schema.contains("oneOf"))
      for (const auto& choice : schema["oneOf"]) visit(choice);
  };
  visit(nlohmann::json::parse(io::scene_schema()));
}

}  // namespace
}  // namespace pelage
