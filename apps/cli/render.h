// The options of `pelage render`, and what becomes of them.
#pragma once

#include <pelage/animation.h>
#include <pelage/io.h>
#include <pelage/render.h>
#include <pelage/scene.h>

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pelage::cli {

/// As typed; what was not typed is empty and keeps the scene's value.
struct RenderOptions {
  std::string input, gbuffer;
  std::vector<std::string> outputs, meshes, lights;
  ImportOptions import;
  std::optional<std::string> size, method, view, alpha, tone_map, model, hair, background, environment, environment_lighting,
      lod_as, lod_scattering;
  std::optional<std::string> stereo;  // meters
  std::optional<float> kernel_size, kernel_radius, depth_sigma;
  std::optional<int> samples, frames, subdivisions, opacity_map_size, lod_level;
  std::optional<FrameRange> frame_range;  // by numbers, where `frames` counts
  std::optional<int> frame;
  std::optional<float> lod_pixels, lod_error, lod_blend, exposure, fov, turn, orbit, convergence, width_scale,
      environment_rotation;
  std::vector<float> eye, target, color, melanin;
  std::vector<std::string> layers;
  bool environment_visible = false, no_shadows = false, no_dual_scattering = false, orthographic = false;
  bool no_head = false, full_float = false, no_linking = false, no_filter = false, no_lod = false, no_occlusion = false,
       still_meshes = false, stats = false, json = false, schema = false;
};

/// Adds the options that say what stands in a scene, and from where it is seen.
void add_camera_options(CLI::App& verb, RenderOptions& options);
/// Adds the options that say what is seen and how it is shown: size, camera, light, hair, display.
void add_scene_options(CLI::App& verb, RenderOptions& options);

/// Adds the options that say which thick hairs are drawn, and what they scatter.
std::vector<CLI::Option*> add_thick_hair_options(CLI::App& verb, RenderOptions& options);

/// Reads the groom or scene file and applies the options to it. What the reader assumed is told in `notes`.
Scene make_scene(const RenderOptions& options, const Progress& progress, std::vector<std::string>& notes);

/// Adds --frame and --still-meshes.
void add_frame_options(CLI::App& verb, RenderOptions& options);
/// The scene at the frame that --frame asks for; as it is where it asks for none.
Scene at_chosen_frame(const RenderOptions& options, Scene scene);

/// Whether the options ask for several pictures: a camera that goes around, numbered frames, or a file name with a place for a number.
bool makes_sequence(const RenderOptions& options);

/// The eye goes around the target about the vertical axis, counter-clockwise from above.
Camera turned(Camera camera, float degrees);

/// `render --stats` and `--json`.
void print_stats(const Scene& scene, const RenderResult& result, double seconds);
void print_json(const Scene& scene, const RenderResult& result, const std::vector<std::string>& outputs, double seconds);

}  // namespace pelage::cli
