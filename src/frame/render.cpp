// From a scene to a picture: what the pictures of a scene share, then the frames of each.
#include <pelage/error.h>
#include <pelage/render.h>

#include <fmt/format.h>

#include <utility>

#include "assemble/assemble.h"
#include "composite/composite.h"
#include "composite/debug_view.h"
#include "core/mesh_tracer.h"
#include "filter/motion.h"
#include "frame/camera_view.h"
#include "frame/methods.h"
#include "frame/one_frame.h"
#include "frame/sample_positions.h"
#include "light/light.h"

namespace pelage {
namespace {

void check_settings(const RenderSettings& s) {
  const auto require = [](bool sound, const char* name, auto value, const char* range) {
    if (!sound) throw Error("settings", name, fmt::format("{} is out of range", value), range);
  };
  require(s.width >= 1 && s.width <= 16384, "width", s.width, "1…16384");
  require(s.height >= 1 && s.height <= 16384, "height", s.height, "1…16384");
  require(s.samples >= 1 && s.samples <= 4096, "samples", s.samples, "1…4096");
  require(s.method != Method::kMsaa || is_sample_count(s.samples), "samples", s.samples,
          "1, 2, 4, 8 or 16; others with method ssaa");
  require(s.frames >= 1 && s.frames <= 4096, "frames", s.frames, "1…4096");
  require(s.subdivisions >= 0 && s.subdivisions <= 64, "subdivisions", s.subdivisions, "0…64");
  require(s.opacity_map_size >= 64 && s.opacity_map_size <= 4096, "opacity_map_size", s.opacity_map_size, "64…4096");
  require(s.exposure >= -100 && s.exposure <= 100, "exposure", s.exposure, "-100…100");
  if (s.method != Method::kMsaa && s.alpha == AlphaSource::kAnalytic)
    throw Error("settings", "alpha", "analytic opacity goes with method msaa alone", "use samples");
}

StageWork groom_work(const Scene& scene) {
  StageWork work;
  for (const GroomInstance& groom : scene.grooms) {
    if (!groom.strands) throw Error("scene", groom.name, "a groom without strands", "set GroomInstance::strands");
    work.items += groom.strands->point_count();
    work.bytes += resident_bytes(*groom.strands);
  }
  return work;
}

/// Where things were from the scene's previous camera.
DebugView render_motion_view(const FrameInputs& inputs, Stages& stages) {
  const RenderSettings& settings = inputs.scene.settings;
  const Buffer<float> depth = render_nearest(inputs, stages);
  DebugView view;
  stages.run("filter.motion", "pixels", [&](const Progress&) {
    const Camera& before = inputs.scene.previous_camera ? *inputs.scene.previous_camera : inputs.scene.camera;
    const Buffer<Vec2> motion = motion_vectors(inputs.view, make_camera_view(before, settings.width, settings.height), depth);
    view.data = motion_data(motion, depth, settings.width, settings.height);
    view.display = motion_display(motion, depth, settings.width, settings.height);
    return StageWork{motion.size(), motion.bytes()};
  });
  return view;
}

}  // namespace

RenderResult render(const Scene& scene, const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  check_settings(settings);
  Stages stages(progress);
  stages.note("groom", "points", groom_work(scene));
  const CameraView view = make_camera_view(scene.camera, settings.width, settings.height);
  const MeshTracer meshes(scene.meshes);
  LightRig rig;

  RenderResult result;
  if (settings.view == View::kBeauty) {
    stages.run("light", "maps", [&](const Progress&) {
      rig = prepare_lights(scene, meshes);
      return StageWork{rig.lights.size(), resident_bytes(rig)};
    });
    FrameInputs inputs{scene, meshes, rig, view, number_segments(scene, view)};
    result.linear = render_beauty(inputs, stages);
    stages.run("display", "pixels", [&](const Progress&) {
      result.display = make_display(result.linear, settings.tone_map);
      return StageWork{result.display.pixels.size() / 4, result.display.pixels.size() * sizeof(float)};
    });
  } else {
    const FrameInputs inputs{scene, meshes, rig, view, number_segments(scene, view)};
    DebugView debug =
        settings.view == View::kMotion ? render_motion_view(inputs, stages) : render_debug_view(inputs, settings.view, stages);
    result.linear = std::move(debug.data);
    result.display = std::move(debug.display);
  }
  result.stats = stages.take();
  return result;
}

}  // namespace pelage
