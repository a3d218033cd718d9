#include "grooms.h"

#include <pelage/io.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "bench.h"
#include "groom/benchmark_grooms.h"

namespace pelage::bench {
namespace {

constexpr const char* kSintel = "grooms/SintelHairOriginal-sintel_hair.16points.tfx";

StrandSet load(const std::string& name) {
  if (name != "sintel") return benchmark_groom(name);
  const char* data = std::getenv("PELAGE_DATA");
  const std::filesystem::path file = std::filesystem::path(data ? data : "../shared/data") / kSintel;
  if (!std::filesystem::exists(file)) throw Skip{file.string() + " is not there; PELAGE_DATA names its folder"};
  return read_strands(file.string());
}

}  // namespace

const std::vector<std::string>& groom_names() {
  static const std::vector<std::string> names{"straight50k", "curly50k", "curly200k", "sintel"};
  return names;
}

std::shared_ptr<const StrandSet> groom(const std::string& name) {
  static std::map<std::string, std::weak_ptr<const StrandSet>> made;
  std::shared_ptr<const StrandSet> strands = made[name].lock();
  if (!strands) made[name] = strands = std::make_shared<const StrandSet>(load(name));
  return strands;
}

Scene groom_scene(const std::string& name) {
  Scene scene;
  scene.grooms.emplace_back();
  scene.grooms[0].name = name;
  scene.grooms[0].strands = groom(name);
  scene.settings.width = 1920, scene.settings.height = 1080;
  scene.settings.subdivisions = 1;
  add_default_camera(scene);
  return scene;
}

}  // namespace pelage::bench
