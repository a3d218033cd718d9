// What a picture depends on, as one number.
#include <pelage/runtime.h>

#include <type_traits>

#include "io/xxh64.h"
#include "reference/checkpoint.h"

namespace pelage {
namespace {

/// Hashes values one by one: structs have padding, whose bytes mean nothing.
class Fingerprint {
 public:
  template <class... T>
  void add(const T&... values) {
    (add_one(values), ...);
  }
  template <class T>
  void add_array(const std::vector<T>& values) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, float> || std::is_same_v<T, Vec2> ||
                  std::is_same_v<T, Vec3>);
    add_one(values.size());
    hash_.add(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return hash_.value(); }

 private:
  template <class T>
  void add_one(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    hash_.add(&value, sizeof value);
  }
  void add_one(const Vec3& v) { add(v.x, v.y, v.z); }
  void add_one(const Affine& a) {
    for (const auto& row : a.m)
      for (const float v : row) add(v);
  }
  // Bindings name every field: a struct that gets another one no longer compiles here.
  void add_one(const Camera& camera) {
    const auto& [projection, eye, target, up, fov_y, height, near_plane, shift_x, shift_y, stereo] = camera;
    add(projection, eye, target, up, fov_y, height, near_plane, shift_x, shift_y);  // one eye is traced
  }
  void add_one(const Light& light) {
    const auto& [type, name, position, direction, intensity, inner_angle, outer_angle, casts_shadow] = light;
    add(type, position, direction, intensity, inner_angle, outer_angle, casts_shadow);
  }
  void add_one(const ArtistLobe& lobe) {
    const auto& [intensity, color, shift, width] = lobe;
    add(intensity, color, shift, width);
  }
  void add_one(const ArtistLobes& lobes) {
    const auto& [r, tt, trt, tt_azimuthal_width, glint_intensity, glint_angle, glint_width] = lobes;
    add(r, tt, trt, tt_azimuthal_width, glint_intensity, glint_angle, glint_width);
  }
  void add_one(const HairMaterial& material) {
    const auto& [model, color_source, eumelanin, pheomelanin, color, eta, beta_longitudinal, beta_azimuthal, tilt, gain,
                 artist] = material;
    add(model, color_source, eumelanin, pheomelanin, color, eta, beta_longitudinal, beta_azimuthal, tilt, gain, artist);
  }
  void add_one(const std::shared_ptr<const Image>& image) {
    add(image != nullptr);
    if (!image) return;
    add(image->width, image->height, image->channel_count());
    add_array(image->pixels);
  }
  void add_one(const StrandSet& s) {
    add(s.basis);
    add_array(s.points), add_array(s.widths), add_array(s.offsets), add_array(s.colors);
  }
  void add_one(const GroomInstance& groom) {
    const auto& [name, strands, hair_mesh, lod, only, sections, shares, lod_lambda, material, color_map, color_along,
                 roughness_map, roughness_along, tilt_map, tilt_along, transform, width_scale] = groom;
    add(material, color_map, color_along, roughness_map, roughness_along, tilt_map, tilt_along, transform, width_scale);
    add(strands != nullptr);
    if (strands) add(*strands);
    add(only != nullptr), add(sections != nullptr);
    if (only) add_array(*only);
    if (sections)
      add_array(sections->major), add_array(sections->minor), add_array(sections->fibers), add_array(sections->diameters),
          add_array(sections->spreads), add_array(sections->twists), add_array(sections->levels);
  }
  void add_one(const TriangleMesh& m) { add_array(m.positions), add_array(m.normals), add_array(m.uv), add_array(m.triangles); }
  void add_one(const MeshInstance& instance) {
    const auto& [name, mesh, texture, color, specular, roughness, transform] = instance;
    add(texture, color, specular, roughness, transform, mesh != nullptr);
    if (mesh) add(*mesh);
  }

  io::Xxh64 hash_;
};

}  // namespace

std::uint64_t fingerprint(const Scene& scene, const TraceSettings& settings) {
  Fingerprint f;
  for (const char c : std::string(version())) f.add(c);
  f.add(settings.integrator, settings.curve_shape, settings.max_bounces, settings.seed, settings.raster_positions);
  if (settings.raster_positions) f.add(settings.samples);
  f.add(scene.settings.width, scene.settings.height, scene.settings.shadows, scene.settings.dual_scattering,
        scene.settings.thick_hairs.scattering);
  f.add(scene.camera, scene.previous_camera.has_value());
  if (scene.previous_camera) f.add(*scene.previous_camera);
  for (const Light& light : scene.lights) f.add(light);
  f.add(scene.environment.radiance, scene.environment.map, scene.environment.rotation, scene.environment.visible);
  for (const GroomInstance& groom : scene.grooms) f.add(groom);
  for (const MeshInstance& mesh : scene.meshes) f.add(mesh);
  return f.value();
}

}  // namespace pelage
