#include "reference/scene_check.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <cmath>

namespace pelage {
namespace {

bool finite(float v) { return std::isfinite(v); }
bool finite(Vec3 v) { return finite(v.x) && finite(v.y) && finite(v.z); }
bool finite(const Affine& a) {
  for (const auto& row : a.m)
    for (const float v : row)
      if (!finite(v)) return false;
  return true;
}

template <class T>
void require(const T& value, const std::string& where, const char* what) {
  if (!finite(value)) throw Error(where, what, "not finite", "");
}

void require_pixels(const std::shared_ptr<const Image>& image, const std::string& where) {
  if (!image) return;
  const std::size_t channels = image->channel_count();
  for (std::size_t i = 0; i < image->pixels.size(); ++i) {
    if (finite(image->pixels[i])) continue;
    const std::size_t p = i / channels, width = static_cast<std::size_t>(image->width);
    throw Error(where, fmt::format("pixel ({}, {}), channel {}", p % width, p / width, image->channels[i % channels]),
                fmt::format("{} is not finite", image->pixels[i]), "repair the picture");
  }
}

void check_camera(const Camera& c) {
  require(c.eye, "camera", "eye"), require(c.target, "camera", "target"), require(c.up, "camera", "up");
  require(c.fov_y, "camera", "fov_y"), require(c.height, "camera", "height"), require(c.near_plane, "camera", "near_plane");
}

void check_light(const Light& l, const std::string& where) {
  require(l.position, where, "position"), require(l.direction, where, "direction"), require(l.intensity, where, "intensity");
  require(l.inner_angle, where, "inner_angle"), require(l.outer_angle, where, "outer_angle");
}

void check_sections(const GroomInstance& g, const std::string& where) {
  const ThickSections& s = *g.sections;
  const std::size_t points = g.strands->point_count();
  if (s.major.size() != points || s.minor.size() != points || s.fibers.size() != points || s.diameters.size() != points ||
      s.spreads.size() != points || (!s.twists.empty() && s.twists.size() != points))
    throw Error(where, "sections", fmt::format("not as many as the {} points", points), "give every point a section");
  if (g.strands->basis == CurveBasis::kBezier)
    throw Error(where, "sections", "thick hairs are no Bézier curves", "use a basis with a point for every span");
  for (std::size_t i = 0; i < points; ++i) {
    const std::string place = fmt::format("section {}", i);
    require(s.major[i], where, place.c_str()), require(s.minor[i], where, place.c_str());
    if (!(s.fibers[i] > 0) || !finite(s.fibers[i]))
      throw Error(where, place, fmt::format("{} fibers", s.fibers[i]), "more than 0");
    if (!(s.spreads[i] >= 0) || !finite(s.spreads[i]))
      throw Error(where, place, fmt::format("a variance of {}", s.spreads[i]), "0 or more");
    if (!s.twists.empty() && !finite(s.twists[i]))
      throw Error(where, place, fmt::format("a twist of {}", s.twists[i]), "a number");
    if (!(s.diameters[i] >= 0) || !finite(s.diameters[i]))
      throw Error(where, place, fmt::format("a fiber's diameter of {}", s.diameters[i]), "0 or more");
  }
}

void check_groom(const GroomInstance& g, const std::string& where) {
  if (!g.strands) throw Error(where, "strands", "a groom without strands", "set GroomInstance::strands");
  validate(*g.strands, where);
  if (g.sections) check_sections(g, where);
  if (g.shares)
    throw Error(where, "shares", "levels of detail that blend are not traced", "set settings.thick_hairs.blend to 0");
  const HairMaterial& m = g.material;
  require(m.color, where, "color"), require(g.transform, where, "transform"), require(g.width_scale, where, "width_scale");
  for (const float v :
       {m.eumelanin, m.pheomelanin, m.eta, m.beta_longitudinal, m.beta_azimuthal, m.cuticle_tilt, m.specular_gain})
    require(v, where, "material");
}

void check_mesh(const MeshInstance& m, const std::string& where) {
  require(m.color, where, "color"), require(m.transform, where, "transform");
  require(m.specular, where, "specular"), require(m.roughness, where, "roughness");
  require_pixels(m.texture, where + " texture");
  if (!m.mesh) throw Error(where, "mesh", "an instance without a mesh", "set MeshInstance::mesh");
  for (std::size_t i = 0; i < m.mesh->positions.size(); ++i)
    if (!finite(m.mesh->positions[i])) throw Error(where, fmt::format("vertex {}", i), "not finite", "");
}

std::string numbered(const char* kind, std::size_t i, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, i) : fmt::format("{} {} ({})", kind, i, name);
}

}  // namespace

void check_scene(const Scene& scene) {
  const RenderSettings& s = scene.settings;
  if (s.width < 1 || s.width > 16384 || s.height < 1 || s.height > 16384)
    throw Error("settings", "size", fmt::format("{} × {} is out of range", s.width, s.height), "1…16384 each");
  if (!(s.exposure >= -100 && s.exposure <= 100))
    throw Error("settings", "exposure", fmt::format("{} is out of range", s.exposure), "-100…100");
  require(s.background, "settings", "background");
  check_camera(scene.camera);
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    check_light(scene.lights[i], numbered("light", i, scene.lights[i].name));
  require(scene.environment.radiance, "environment", "radiance"),
      require(scene.environment.rotation, "environment", "rotation");
  require_pixels(scene.environment.map, "environment map");
  for (std::size_t i = 0; i < scene.grooms.size(); ++i)
    check_groom(scene.grooms[i], numbered("groom", i, scene.grooms[i].name));
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) check_mesh(scene.meshes[i], numbered("mesh", i, scene.meshes[i].name));
}

}  // namespace pelage
