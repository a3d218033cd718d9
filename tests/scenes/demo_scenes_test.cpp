// Every scene of assets/scenes reads, with fewer strands, and holds what it shows.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pelage/hair_mesh_styles.h>
#include <pelage/io.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace pelage {
namespace {

namespace fs = std::filesystem;

/// The scene of `file` with 300 strands (1000, of a hair mesh), its mesh files named absolutely, so that it can be read from anywhere.
nlohmann::json thinned(const fs::path& file) {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(file));
  for (auto& groom : scene["grooms"]) {
    auto& grow = groom["grow"];
    if (grow.contains("hair_mesh")) grow["strands"] = 1000;
    else grow["strands"] = 300, grow["clumps"] = 60;
  }
  for (auto& mesh : scene["meshes"])
    if (mesh.contains("file"))
      mesh["file"] = fs::weakly_canonical(file.parent_path() / mesh["file"].get<std::string>()).string();
  return scene;
}

TEST(DemoScenes, AllRead) {
  int read = 0;
  for (const auto& entry : fs::directory_iterator(PELAGE_SOURCE_DIR "/assets/scenes")) {
    const nlohmann::json text = thinned(entry.path());
    const nlohmann::json& mesh = text["meshes"][0];
    if (mesh.contains("file") && !fs::exists(mesh["file"].get<std::string>())) {
      std::printf("skipped %s: %s is not there\n", entry.path().c_str(), mesh["file"].get<std::string>().c_str());
      continue;
    }
    const bool hair_mesh = text["grooms"][0]["grow"].contains("hair_mesh");
    if (hair_mesh && hair_mesh_style_names().empty()) continue;  // a build without them
    const fs::path copy = fs::path(testing::TempDir()) / ("demo_" + entry.path().filename().string());
    std::ofstream(copy) << text;
    const Scene scene = read_scene(copy.string());
    fs::remove(copy);
    ASSERT_EQ(scene.grooms.size(), 1u) << entry.path();
    ASSERT_EQ(scene.meshes.size(), 1u) << entry.path();
    if (hair_mesh) EXPECT_EQ(strand_count(*scene.grooms[0].hair_mesh), 1000u) << entry.path();
    else EXPECT_EQ(scene.grooms[0].strands->strand_count(), 300u) << entry.path();
    EXPECT_EQ(scene.lights.size(), 3u) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 6);
}

}  // namespace
}  // namespace pelage
