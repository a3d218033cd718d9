// From a scene to a picture: what the pictures of a scene share, then the frames of each.
#include <pelage/error.h>
#include <pelage/lod.h>
#include <pelage/render.h>

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "assemble/assemble.h"
#include "composite/composite.h"
#include "composite/debug_view.h"
#include "composite/side_by_side.h"
#include "core/mesh_tracer.h"
#include "filter/motion.h"
#include "filter/oidn.h"
#include "frame/camera_view.h"
#include "frame/check_settings.h"
#include "frame/deferred_frame.h"
#include "frame/linked_frame.h"
#include "frame/methods.h"
#include "frame/one_frame.h"
#include "frame/sample_positions.h"
#include "light/light.h"
#include "lod/thick_hairs.h"

namespace pelage {
void check_settings(const RenderSettings& s) {
  const auto require = [](bool sound, const char* name, auto value, const char* range) {
    if (!sound) throw Error("settings", name, fmt::format("{} is out of range", value), range);
  };
  require(s.width >= 1 && s.width <= 16384, "width", s.width, "1…16384");
  require(s.height >= 1 && s.height <= 16384, "height", s.height, "1…16384");
  require(s.samples >= 1 && s.samples <= 4096, "samples", s.samples, "1…4096");
  require(s.method != Method::kMsaa || is_sample_count(s.samples), "samples", s.samples,
          "1, 2, 4, 8 or 16; others with method ssaa");
  require(!is_linking(s.method) || is_link_sample_count(s.samples), "samples", s.samples, "1, 4, 9 or 16 with method link");
  require(s.method != Method::kSwr || is_deferred_sample_count(s.samples), "samples", s.samples,
          "1, 2, 4 or 8 with method swr");
  require(s.thick_hairs.level >= -1 && s.thick_hairs.level < static_cast<int>(LodHierarchy::kMostLevels), "thick_hairs.level",
          s.thick_hairs.level, "-1…15");
  require(s.thick_hairs.pixels >= 0.1f && s.thick_hairs.pixels <= 64, "thick_hairs.pixels", s.thick_hairs.pixels, "0.1…64");
  require(s.thick_hairs.blend >= 0 && s.thick_hairs.blend <= 0.9f, "thick_hairs.blend", s.thick_hairs.blend, "0…0.9");
  if (s.thick_hairs.blend > 0 && (s.thick_hairs.shape != LodShape::kThickHairs || s.thick_hairs.level >= 0))
    throw Error("settings", "thick_hairs.blend", "thick hairs blend, other shapes and one level everywhere do not",
                "set it to 0");
  require(s.swr.points >= 3 && s.swr.points <= 127, "swr.points", s.swr.points, "3…127");
  require(s.swr.radius >= 1 && s.swr.radius <= 15, "swr.radius", s.swr.radius, "1…15");
  require(s.swr.s_parallel > 0, "swr.s_parallel", s.swr.s_parallel, "a positive number");
  require(s.swr.s_perpendicular > 0, "swr.s_perpendicular", s.swr.s_perpendicular, "a positive number");
  require(s.swr.sigma_color > 0, "swr.sigma_color", s.swr.sigma_color, "a positive number");
  require(s.link.kernel_size >= 0 && s.link.kernel_size <= 1, "link.kernel_size", s.link.kernel_size, "0…1");
  require(s.link.kernel_radius >= 0 && s.link.kernel_radius <= 64, "link.kernel_radius", s.link.kernel_radius, "0…64");
  require(s.link.falloff > 0, "link.falloff", s.link.falloff, "a positive number of half axes");
  require(s.link.sigma > 0, "link.sigma", s.link.sigma, "a positive number of pixels");
  require(s.frames >= 1 && s.frames <= 4096, "frames", s.frames, "1…4096");
  require(s.subdivisions >= 0 && s.subdivisions <= 64, "subdivisions", s.subdivisions, "0…64");
  require(s.opacity_map_size >= 64 && s.opacity_map_size <= 4096, "opacity_map_size", s.opacity_map_size, "64…4096");
  require(s.exposure >= -100 && s.exposure <= 100, "exposure", s.exposure, "-100…100");
  if (s.method == Method::kOidn) require_oidn();
  if (s.method != Method::kMsaa && s.alpha == AlphaSource::kAnalytic)
    throw Error("settings", "alpha", "analytic opacity goes with method msaa alone", "use samples");
}

namespace {

StageWork groom_work(const Scene& scene) {
  StageWork work;
  for (const GroomInstance& groom : scene.grooms) {
    if (groom.hair_mesh) work.bytes += resident_bytes(*groom.hair_mesh);
    if (groom.hair_mesh && !groom.strands) {
      work.items += groom.hair_mesh->vertex_count();
      continue;
    }
    if (!groom.strands) throw Error("scene", groom.name, "a groom without strands", "set GroomInstance::strands");
    work.items += groom.strands->point_count();
    work.bytes += resident_bytes(*groom.strands);
  }
  return work;
}

/// Whether the picture is made from hair meshes as they are; views other than beauty look at their strands.
bool draws_hair_meshes(const RenderSettings& settings) {
  return settings.method == Method::kSwr && settings.view == View::kBeauty;
}

/// Throws Error unless `moved` may be `scene` in another pose.
void check_same_things(const Scene& scene, const Scene& moved) {
  bool same = scene.grooms.size() == moved.grooms.size() && scene.meshes.size() == moved.meshes.size();
  for (std::size_t g = 0; same && g < scene.grooms.size(); ++g) {
    const GroomInstance &a = scene.grooms[g], &b = moved.grooms[g];
    same = (!a.lod) == (!b.lod) && (!b.strands || !a.strands || a.strands->offsets == b.strands->offsets);
    if (same && a.lod) same = a.lod->level_offsets == b.lod->level_offsets;
  }
  if (!same)
    throw Error("scene", "grooms", "they are others than those that the sequence began with",
                "give the same scene at another frame: at_frame()");
}

/// Where things were from the scene's previous camera.
DebugView render_motion_view(const FrameInputs& inputs, Stages& stages) {
  const RenderSettings& settings = inputs.scene.settings;
  Buffer<Vec3> way;
  const Buffer<float> depth = render_nearest(inputs, stages, &way);
  DebugView view;
  stages.run("filter.motion", "pixels", [&](const Progress&) {
    const Buffer<Vec2> motion = motion_vectors(inputs.view, inputs.previous.value_or(inputs.view), depth, way);
    view.data = motion_data(motion, depth, settings.width, settings.height);
    view.display = motion_display(motion, depth, settings.width, settings.height);
    return StageWork{motion.size(), motion.bytes()};
  });
  return view;
}

/// Any view but beauty.
DebugView render_unlit_view(const FrameInputs& inputs, Stages& stages) {
  switch (const View what = inputs.scene.settings.view) {
    case View::kMotion: return render_motion_view(inputs, stages);
    case View::kLinked:
    case View::kLinkAlpha: return render_link_view(inputs, what, stages);
    default: return render_debug_view(inputs, what, stages);
  }
}

}  // namespace

Scene with_thick_hairs(const Scene& scene) {
  check_settings(scene.settings);
  ThickHairs thick(scene);
  if (!thick.active()) return scene;
  const CameraView view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
  thick.choose(scene, view);
  return thick.drawn(scene, view);
}

struct PictureSequence::State {
  Scene scene;
  MeshTracer meshes;
  std::optional<LightRig> rig;
  DeferredGrooms grooms;             // of method swr, prepared once
  std::vector<MethodState> methods;  // one an eye
  std::optional<ThickHairs> thick;
  Scene drawn;                        // where thick hairs are active: this frame's grooms
  std::optional<Scene> before;        // where things have moved: as they were a frame ago
  std::optional<Scene> drawn_before;  // that as `drawn`, where thick hairs are active

  explicit State(Scene s) : scene(std::move(s)), meshes(scene.meshes) {
    // Strands of hair meshes are only made where something looks at strands.
    if (draws_hair_meshes(scene.settings)) grooms = prepare_deferred(scene);
    else expand_hair_meshes(scene);
    thick.emplace(scene);
  }

  /// The scene in another pose, which was checked.
  void move(Scene moved) {
    for (std::size_t g = 0; g < moved.grooms.size(); ++g)
      if (!moved.grooms[g].strands) moved.grooms[g].strands = scene.grooms[g].strands;
    moved.settings = scene.settings, moved.previous_camera = scene.previous_camera;
    before = std::exchange(scene, std::move(moved));
    if (!scene.meshes.empty()) meshes = MeshTracer(scene.meshes);
    rig.reset();
    thick->move(scene);
  }

  /// The scene as its levels of detail show it to the eye that `view` is of; both eyes see the same.
  const Scene& draw(const CameraView& view, Stages& stages) {
    if (!thick->active() || draws_hair_meshes(scene.settings)) return scene;
    stages.run("lod.choose", "frames", [&](const Progress&) {
      thick->choose(scene, view);
      return StageWork{1, 0};
    });
    stages.run("lod", "segments", [&](const Progress&) {
      drawn = thick->drawn(scene, view);
      if (thick->changed()) rig.reset();  // what casts shadows is what is seen
      if (before && thick->can_draw_alike()) drawn_before = thick->drawn(*before, view);
      else drawn_before.reset();
      return StageWork{drawn_segments(drawn), 0};
    });
    return drawn;
  }

  /// As draw(), a frame ago; null where nothing has moved. After draw().
  const Scene* seen_before() const {
    if (!before || draws_hair_meshes(scene.settings)) return nullptr;
    if (!thick->active()) return &*before;
    return drawn_before ? &*drawn_before : nullptr;
  }

  RenderResult picture(const Camera& camera, const Progress& progress);

  /// Of the scene as it is drawn. Made at the first call, and where levels of detail have changed.
  const LightRig& lights(const Scene& seen, Stages& stages) {
    if (rig) return *rig;
    stages.run("light", "maps", [&](const Progress&) {
      const bool hair_meshes = draws_hair_meshes(scene.settings);
      rig = prepare_lights(hair_meshes ? light_stand_in(scene) : seen, meshes);
      if (hair_meshes) grooms.materials = {scene, grooms.meshes, *rig};
      return StageWork{rig->lights.size(), resident_bytes(*rig)};
    });
    return *rig;
  }
};

PictureSequence::PictureSequence(Scene scene) {
  check_settings(scene.settings);
  groom_work(scene);  // names a groom without strands
  state_ = std::make_unique<State>(std::move(scene));
}
PictureSequence::~PictureSequence() = default;
PictureSequence::PictureSequence(PictureSequence&&) noexcept = default;
PictureSequence& PictureSequence::operator=(PictureSequence&&) noexcept = default;

RenderResult PictureSequence::State::picture(const Camera& camera, const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  const std::vector<Camera> now = eyes(camera), earlier = eyes(scene.previous_camera.value_or(camera));
  scene.camera = camera;
  Stages stages(progress);
  stages.note("groom", draws_hair_meshes(settings) ? "vertices" : "points", groom_work(scene));
  const bool beauty = settings.view == View::kBeauty;
  const Scene& seen = draw(make_camera_view(now[0], settings.width, settings.height), stages);
  const LightRig dark, &lit = beauty ? lights(seen, stages) : dark;
  std::vector<FrameInputs> views;
  for (std::size_t e = 0; e < now.size(); ++e) {
    const CameraView view = make_camera_view(now[e], settings.width, settings.height);
    views.push_back({seen, meshes, lit, view, draws_hair_meshes(settings) ? SegmentNumbering() : number_segments(seen, view)});
    if (earlier.size() == now.size()) views[e].previous = make_camera_view(earlier[e], settings.width, settings.height);
    views[e].before = seen_before();
  }
  methods.resize(now.size());

  std::vector<Image> linear, display;
  if (beauty)
    for (Beauty& picture : render_beauty(views, methods, grooms, stages))
      linear.push_back(std::move(picture.linear)), display.push_back(std::move(picture.display));
  else
    for (const FrameInputs& view : views) {
      DebugView picture = render_unlit_view(view, stages);
      linear.push_back(std::move(picture.data)), display.push_back(std::move(picture.display));
    }
  scene.previous_camera = camera;
  return {side_by_side(std::move(linear)), side_by_side(std::move(display)), stages.take()};
}

RenderResult PictureSequence::next(const Camera& camera, const Progress& progress) {
  state_->before.reset();
  return state_->picture(camera, progress);
}

RenderResult PictureSequence::next(Scene moved, const Progress& progress) {
  check_same_things(state_->scene, moved);
  const Camera camera = moved.camera;
  state_->move(std::move(moved));
  return state_->picture(camera, progress);
}

RenderResult render(const Scene& scene, const Progress& progress) {
  return PictureSequence(scene).next(scene.camera, progress);
}

}  // namespace pelage
