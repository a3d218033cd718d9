// Deferred software rasterization of hair meshes (Lipp 2026): its table 1 on this machine.
//
// A frame is what makes the hair of a picture: lod, raster, shade and filter, from the cages to premultiplied color. Maps of light
// are made once, as in the paper; opaque meshes and the tone map are no part of it.
#include <pelage/hair_mesh_styles.h>
#include <pelage/metrics.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"
#include "composite/composite.h"
#include "core/mesh_tracer.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "filter/frame_mean.h"
#include "frame/deferred_frame.h"
#include "frame/sample_positions.h"
#include "frame/stages.h"
#include "groom/hairmesh/prepared.h"
#include "groom/hairmesh/strand_group.h"
#include "light/light.h"
#include "lod/bundle_lod.h"

namespace pelage::bench {
namespace {

/// A groom, and its height on a screen of 1080 rows.
struct Shot {
  const char* name;
  HairMeshStyle style;
  float pixels;
};
constexpr Shot kShots[] = {{"close", HairMeshStyle::kWavy, 1000},     {"mid", HairMeshStyle::kWavy, 350},
                           {"far", HairMeshStyle::kWavy, 70},         {"curls.close", HairMeshStyle::kCurls, 1000},
                           {"curls.mid", HairMeshStyle::kCurls, 350}, {"curls.far", HairMeshStyle::kCurls, 70}};

/// Heights at which hair with level of detail is compared with all of it.
constexpr int kLookHeights[] = {2000, 1400, 1000, 700, 500, 350, 200, 140, 100, 70, 50, 35, 20};

/// A kind of picture: 1 sample with and without the filter, or sample layers.
struct Kind {
  const char* name;
  int samples;
  bool filter;
};
constexpr Kind kKinds[] = {
    {"center", 1, false}, {"filter", 1, true}, {"msaa2", 2, false}, {"msaa4", 4, false}, {"msaa8", 8, false}};

/// 127k strands, made once and kept.
std::shared_ptr<const HairMesh> bench_mesh(HairMeshStyle style = HairMeshStyle::kWavy) {
  static std::map<HairMeshStyle, std::shared_ptr<const HairMesh>> kept;
  auto& mesh = kept[style];
  if (!mesh) mesh = std::make_shared<const HairMesh>(make_hair_mesh({.style = style}));
  return mesh;
}

/// The mesh from the front, so far away that it is as tall as the shot says.
Scene scene_of(const Shot& shot) {
  Scene scene;
  scene.grooms.emplace_back().hair_mesh = bench_mesh(shot.style);
  scene.settings.method = Method::kSwr, scene.settings.samples = 1;
  scene.settings.width = 1920, scene.settings.height = 1080;
  add_default_camera(scene);
  add_default_lights(scene);
  const Bounds box = bounds(expand(*bench_mesh(shot.style), {.points = 17, .share = 0.02f}));
  Camera& camera = scene.camera;
  const float distance = box.extent().y * 1080 / shot.pixels / (2 * std::tan(0.5f * camera.fov_y));
  const Vec3 back = normalize(camera.eye - camera.target);
  camera.target = box.center(), camera.eye = box.center() + back * (distance + 0.5f * box.extent().z);
  return scene;
}

/// Everything that frames of a scene share.
struct Input {
  Scene scene;
  MeshTracer meshes;
  DeferredGrooms grooms;
  LightRig rig;

  explicit Input(const Shot& shot)
      : scene(scene_of(shot)), meshes({}), grooms(prepare_deferred(scene)), rig(prepare_lights(light_stand_in(scene), meshes)) {
    grooms.materials = {scene, grooms.meshes, rig};
  }

  /// position: of the one sample of each pixel; view: instead of that of the scene's camera.
  HairPicture hair(const RenderSettings& settings, HairWork* work = nullptr, Vec2 position = {0.5f, 0.5f},
                   const CameraView* view = nullptr) const {
    Scene with = scene;
    with.settings = settings;
    FrameInputs inputs{with, meshes, rig, view ? *view : make_camera_view(scene.camera, settings.width, settings.height), {}};
    inputs.view.center_x += 0.5f - position.x, inputs.view.center_y += 0.5f - position.y;
    Stages stages({});
    return std::move(render_hair(std::span(&inputs, 1), grooms, {}, stages, work)[0]);
  }

  /// For the left and the right eye, which share their strands.
  std::vector<HairPicture> stereo_hair(const RenderSettings& settings) const {
    Scene with = scene;
    with.settings = settings;
    std::vector<FrameInputs> inputs;
    for (const Camera& eye : stereo_eyes())
      inputs.push_back({with, meshes, rig, make_camera_view(eye, settings.width, settings.height), {}});
    Stages stages({});
    return render_hair(inputs, grooms, {}, stages);
  }

  std::vector<Camera> stereo_eyes() const {
    Camera both = scene.camera;
    both.stereo = Stereo();
    return eyes(both);
  }
};

/// One input a shot, kept while cases use it.
std::shared_ptr<const Input> input_of(const Shot& shot) {
  static std::map<std::pair<HairMeshStyle, float>, std::weak_ptr<const Input>> kept;
  std::weak_ptr<const Input>& last = kept[{shot.style, shot.pixels}];
  if (auto known = last.lock()) return known;
  auto made = std::make_shared<const Input>(shot);
  last = made;
  return made;
}

RenderSettings settings_of(const Input& in, const Kind& kind, bool lod) {
  RenderSettings s = in.scene.settings;
  s.samples = kind.samples, s.swr.filter = kind.filter, s.swr.lod = lod;
  return s;
}

// The reference is the same frame, smaller, made by one thread without SIMD.
std::string check_frame(const Input& in, RenderSettings settings) {
  settings.width = 480, settings.height = 270;
  const HairPicture fast = in.hair(settings);
  const int threads = thread_count();
  const std::string isa = active_isa();
  set_thread_count(1);
  set_isa(available_isas().back());
  const HairPicture slow = in.hair(settings);
  set_thread_count(threads);
  set_isa(isa);
  const bool same = fast.color.size() == slow.color.size() &&
                    std::memcmp(fast.color.data(), slow.color.data(), fast.color.size() * sizeof(Vec4)) == 0;
  return same ? "" : "not the bits of one thread without SIMD";
}

Workload frame_workload(const Shot& shot, const Kind& kind, bool lod) {
  auto in = input_of(shot);
  const RenderSettings settings = settings_of(*in, kind, lod);
  return {.check = [in, settings] { return check_frame(*in, settings); }, .run = [in, settings] { in->hair(settings); }};
}

bool same_bits(const HairPicture& a, const HairPicture& b) {
  return a.left == b.left && a.top == b.top && a.width == b.width && a.color.size() == b.color.size() &&
         std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(Vec4)) == 0;
}

// The reference is a frame of each eye alone, at full detail: strands that level of detail selects are those of both eyes.
std::string check_stereo(const Input& in, RenderSettings settings) {
  settings.width = 480, settings.height = 270, settings.swr.lod = false;
  const std::vector<HairPicture> both = in.stereo_hair(settings);
  const std::vector<Camera> cameras = in.stereo_eyes();
  for (std::size_t e = 0; e < cameras.size(); ++e) {
    const CameraView view = make_camera_view(cameras[e], settings.width, settings.height);
    if (!same_bits(both[e], in.hair(settings, nullptr, {0.5f, 0.5f}, &view))) return "not the bits of a frame of each eye";
  }
  return "";
}

/// Two eyes, each as many pixels as the one of the other cases.
Workload stereo_workload(const Shot& shot, bool lod) {
  auto in = input_of(shot);
  const RenderSettings settings = settings_of(*in, kKinds[1], lod);
  return {.check = [in, settings] { return check_stereo(*in, settings); },
          .run = [in, settings] { in->stereo_hair(settings); }};
}

/// Hair over nothing: linear, premultiplied, of the size of the settings.
Image picture_of(const HairPicture& hair, const RenderSettings& s) {
  Backdrop nothing;
  nothing.alpha = 0;
  return hair_over(hair, {}, nothing, s.width, s.height, 0);
}

/// 64 samples a pixel at full detail: frames of one sample each, shaded where it is, without the filter.
const Picture& reference_of(const Shot& shot) {
  static std::map<std::string, Picture> kept;
  Picture& reference = kept[shot.name];
  if (!reference.image.pixels.empty()) return reference;
  const auto in = input_of(shot);
  const RenderSettings s = settings_of(*in, kKinds[0], false);
  FrameMean mean;
  for (const Vec2 position : pixel_sample_positions(64)) mean.add(picture_of(in->hair(s, nullptr, position), s));
  reference.image = mean.take();
  return reference;
}

/// Error of a picture against that, over its hair, before a gray background.
Workload quality_workload(const Shot& shot, const Kind& kind, bool lod, const std::string& metric) {
  return {.check = [] { return std::string(); },
          .measure =
              [=] {
                const auto in = input_of(shot);
                const RenderSettings s = settings_of(*in, kind, lod);
                const Picture& reference = reference_of(shot);
                const Picture gray = over_background(reference, s.background);
                const Comparison c = compare_images(over_background({picture_of(in->hair(s), s)}, s.background), gray,
                                                    {.metrics = {metric}, .mask = hair_mask(reference)});
                return c.value(metric).value();
              }};
}

/// Eq. 1 and 2 once more, bundle by bundle, in doubles: what level of detail chose.
std::string check_selection(const Input& in) {
  const CameraView view = make_camera_view(in.scene.camera, 1920, 1080);
  const PreparedHairMesh& prepared = *in.grooms.meshes[0].mesh;
  for (const BundleDraw& draw : select_lod(in.scene, in.grooms.meshes, std::span(&view, 1)).bundles) {
    const HairMesh::Bundle& bundle = prepared.mesh->bundles[draw.bundle];
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    for (const std::uint32_t column : bundle.columns)
      for (std::uint32_t v = prepared.mesh->column_offsets[column]; v < prepared.mesh->column_offsets[column + 1]; ++v) {
        const Vec2 at = project(view, transform_point(view.world_to_camera, prepared.mesh->positions[v]));
        low[0] = std::fmin(low[0], at.x), low[1] = std::fmin(low[1], at.y);
        high[0] = std::fmax(high[0], at.x), high[1] = std::fmax(high[1], at.y);
      }
    const double size = std::hypot(high[0] - low[0], high[1] - low[1]) / view.height * in.scene.grooms[0].lod_lambda;
    const double widest = static_cast<double>(kernel::kLodWidestStrand * prepared.across[draw.bundle]);
    const double wanted = std::fmax(std::fmin(size, 1) * (bundle.strands + static_cast<double>(prepared.stagger[draw.bundle])),
                                    bundle.strands * static_cast<double>(prepared.mesh->width) / widest);
    if (std::fabs(std::fmin(wanted, bundle.strands) - draw.strands) > 1.01)
      return "a bundle of " + std::to_string(bundle.strands) + " has " + std::to_string(draw.strands) + " strands, not " +
             std::to_string(wanted);
  }
  return "";
}

/// Share of the strands that level of detail draws.
Workload strands_workload(const Shot& shot) {
  auto in = input_of(shot);
  return {.check = [in] { return check_selection(*in); },
          .measure =
              [in] {
                HairWork work;
                in->hair(settings_of(*in, kKinds[0], true), &work);
                return static_cast<double>(work.strands) / static_cast<double>(strand_count(*in->grooms.meshes[0].mesh->mesh));
              }};
}

Workload prepass_workload(const Shot& shot) {
  auto in = input_of(shot);
  return {.check = [in] { return check_selection(*in); },
          .run = [in, view = make_camera_view(in->scene.camera, 1920,
                                              1080)] { select_lod(in->scene, in->grooms.meshes, std::span(&view, 1)); }};
}

/// What a frame shows of the hair, in sum over all pixels.
struct HairSums {
  double coverage = 0, luminance = 0;
};

HairSums sums_of(const HairPicture& hair) {
  HairSums sums;
  for (const Vec4& c : hair.color) {
    sums.coverage += static_cast<double>(c.w);
    sums.luminance += 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
  }
  return sums;
}

/// Σ over / Σ under of pairs of frames, and its standard error as that of a ratio estimator (Cochran 1977, §6.4).
struct FrameRatio {
  std::vector<double> over, under;
  double value() const {
    return std::accumulate(over.begin(), over.end(), 0.0) / std::accumulate(under.begin(), under.end(), 0.0);
  }
  double error() const {
    const double ratio = value(), n = static_cast<double>(over.size());
    double squares = 0;
    for (std::size_t i = 0; i < over.size(); ++i) squares += (over[i] - ratio * under[i]) * (over[i] - ratio * under[i]);
    return std::sqrt(squares * n / (n - 1)) / std::accumulate(under.begin(), under.end(), 0.0);
  }
};

/// Hair with level of detail over hair at full detail.
struct Look {
  FrameRatio coverage, luminance;
};

/// Known to better than kLookError. A bundle's level of detail depends on its share of the screen and not on its pixels, so a frame
/// with n times the rows and columns shows what n² frames do that are shifted by parts of a pixel.
constexpr double kLookError = 0.004;
const Look& look_of(const Shot& shot) {
  constexpr int kLeastFrames = 4, kMostFrames = 32;
  static std::map<std::pair<HairMeshStyle, float>, Look> kept;
  Look& look = kept[{shot.style, shot.pixels}];
  if (!look.coverage.over.empty()) return look;
  const auto in = input_of(shot);
  RenderSettings s[2] = {settings_of(*in, kKinds[0], false), settings_of(*in, kKinds[0], true)};
  const int finer = std::clamp(static_cast<int>(1000 / shot.pixels), 1, 8);
  for (RenderSettings& with : s) with.width *= finer, with.height *= finer;
  const auto noisy = [&] { return std::max(look.coverage.error(), look.luminance.error()) > kLookError; };
  for (int i = 0; i < kLeastFrames || (i < kMostFrames && noisy()); ++i) {
    const Vec2 position = jitter_position(static_cast<std::uint32_t>(i));
    const HairSums full = sums_of(in->hair(s[0], nullptr, position)), lod = sums_of(in->hair(s[1], nullptr, position));
    look.coverage.under.push_back(full.coverage), look.coverage.over.push_back(lod.coverage);
    look.luminance.under.push_back(full.luminance), look.luminance.over.push_back(lod.luminance);
  }
  return look;
}

/// Coverage, or the mean radiance of what is covered, over that of full detail.
Workload look_workload(const Shot& shot, bool radiance) {
  const auto check = [shot] {
    const Look& look = look_of(shot);
    const double error = std::max(look.coverage.error(), look.luminance.error());
    return error <= kLookError ? std::string() : "the standard error is " + std::to_string(error);
  };
  return {.check = check, .measure = [shot, radiance] {
            const Look& look = look_of(shot);
            return radiance ? look.luminance.value() / look.coverage.value() : look.coverage.value();
          }};
}

/// A dolly away from the hair. The slow one moves so little from frame to frame that whatever pops stands out.
struct Path {
  const char* name;
  float from, to;  // pixels of height
};
constexpr Path kPaths[] = {{"dolly", 600, 60}, {"slow_dolly", 120, 105}};

/// PSNR between neighboring frames of a dolly, with the filter, at full detail and with level of detail.
struct Dolly {
  std::vector<double> psnr[2];
};

const Dolly& dolly_of(const Path& path, HairMeshStyle style) {
  constexpr int kFrames = 60;
  static std::map<std::pair<std::string, HairMeshStyle>, Dolly> kept;
  Dolly& dolly = kept[{path.name, style}];
  if (!dolly.psnr[0].empty()) return dolly;
  const Input in({path.name, style, path.from});
  Picture before[2];
  for (int i = 0; i < kFrames; ++i) {
    const float pixels = path.from * std::pow(path.to / path.from, static_cast<float>(i) / (kFrames - 1));
    const Scene there = scene_of({path.name, style, pixels});
    const CameraView view = make_camera_view(there.camera, there.settings.width, there.settings.height);
    for (const bool lod : {false, true}) {
      const RenderSettings s = settings_of(in, kKinds[1], lod);
      Picture frame = over_background({picture_of(in.hair(s, nullptr, {0.5f, 0.5f}, &view), s)}, s.background);
      if (i > 0) dolly.psnr[lod].push_back(compare_images(frame, before[lod], {.metrics = {"psnr"}}).value("psnr").value());
      before[lod] = std::move(frame);
    }
  }
  return dolly;
}

/// Means over its frames, and the least that level of detail has over full detail: below 0 something pops.
double dolly_value(const Dolly& dolly, const std::string& metric) {
  const auto mean = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  };
  if (metric == "psnr_full") return mean(dolly.psnr[0]);
  if (metric == "psnr_lod") return mean(dolly.psnr[1]);
  double least = INFINITY;
  for (std::size_t i = 0; i < dolly.psnr[0].size(); ++i) least = std::min(least, dolly.psnr[1][i] - dolly.psnr[0][i]);
  return least;
}

using MakeStrands = void (*)(const BundleCage&, std::uint32_t, std::size_t, std::uint32_t, StrandGroup&);

/// All strands of the mesh at full detail, made and forgotten.
void make_all(const PreparedHairMesh& mesh, MakeStrands make) {
  parallel_for(mesh.cages.size(), 1, [&](std::size_t begin, std::size_t end) {
    thread_local StrandGroup group;
    for (std::size_t b = begin; b < end; ++b)
      for (std::uint32_t s = 0; s < mesh.cages[b].bundle->strands; s += StrandGroup::kLanes)
        make(mesh.cages[b], s, std::min<std::size_t>(StrandGroup::kLanes, mesh.cages[b].bundle->strands - s), kHairMeshPoints,
             group);
  });
}

std::string check_strands(const PreparedHairMesh& mesh) {
  StrandGroup a, b;
  for (const BundleCage& cage : mesh.cages) {
    make_strands(cage, 0, 16, kHairMeshPoints, a), make_strands_scalar(cage, 0, 16, kHairMeshPoints, b);
    const std::size_t bytes = kHairMeshPoints * StrandGroup::kLanes * sizeof(float);
    for (const auto member : {&StrandGroup::x, &StrandGroup::y, &StrandGroup::z, &StrandGroup::tx, &StrandGroup::width})
      if (std::memcmp((a.*member).data(), (b.*member).data(), bytes) != 0)
        return "strands differ from those of the scalar target";
  }
  return "";
}

Workload strand_workload(MakeStrands make) {
  auto mesh = std::make_shared<const PreparedHairMesh>(bench_mesh());
  return {.check = [mesh] { return check_strands(*mesh); },
          .run = [mesh, make] { make_all(*mesh, make); },
          .items = static_cast<double>(strand_count(*bench_mesh())) * kHairMeshPoints};
}

}  // namespace

void add_swr_cases(Suite& suite) {
  suite.cases.push_back({"swr.strands.wide", "points_per_second", "1/s", [] { return strand_workload(make_strands); }});
  suite.cases.push_back(
      {"swr.strands.scalar", "points_per_second", "1/s", [] { return strand_workload(make_strands_scalar); }});
  suite.ratios.push_back({"swr.strands.speedup", {"swr.strands.wide"}, {"swr.strands.scalar"}});
  suite.ratios.push_back({"swr.strands.scaling", {"swr.strands.wide", 2}, {"swr.strands.wide", 1}});
  for (const Shot& shot : kShots) {
    const std::string at = std::string("swr.") + shot.name + ".";
    for (const Kind& kind : kKinds)
      for (const bool lod : {false, true})
        suite.cases.push_back({at + kind.name + (lod ? ".lod" : ".full"), "seconds_per_frame", "s",
                               [shot, kind, lod] { return frame_workload(shot, kind, lod); }});
    for (const Kind& kind : kKinds)
      for (const bool lod : {false, true})
        for (const char* metric : {"flip", "mse"})
          suite.cases.push_back({at + "quality." + kind.name + (lod ? ".lod" : ".full"), metric, "1",
                                 [=] { return quality_workload(shot, kind, lod, metric); }});
    for (const bool lod : {false, true})
      suite.cases.push_back({at + (lod ? "stereo.lod" : "stereo.full"), "seconds_per_frame", "s",
                             [shot, lod] { return stereo_workload(shot, lod); }});
    suite.cases.push_back({at + "prepass", "seconds_per_frame", "s", [shot] { return prepass_workload(shot); }});
    suite.cases.push_back({at + "strands", "share", "1", [shot] { return strands_workload(shot); }});
    suite.ratios.push_back({at + "lod_gain", {at + "filter.full"}, {at + "filter.lod"}});
    suite.ratios.push_back({at + "filter_over_msaa2", {at + "filter.full"}, {at + "msaa2.full"}});
    suite.ratios.push_back({at + "filter_over_msaa2.lod", {at + "filter.lod"}, {at + "msaa2.lod"}});
    suite.ratios.push_back({at + "conservative_share", {at + "filter.full"}, {at + "center.full"}});
    suite.ratios.push_back({at + "stereo_over_single", {at + "stereo.full"}, {at + "filter.full"}});
    suite.ratios.push_back({at + "stereo_over_single.lod", {at + "stereo.lod"}, {at + "filter.lod"}});
    suite.ratios.push_back({at + "prepass_share", {at + "prepass"}, {at + "filter.lod"}});
  }
  for (const Path& path : kPaths)
    for (const std::string style : {"long-wavy", "curls"})
      for (const std::string metric : {"psnr_full", "psnr_lod", "least_gain"})
        suite.cases.push_back(
            {"swr." + std::string(path.name) + "." + style, metric, "dB", [path, style, metric] {
               return Workload{
                   .check = [] { return std::string(); },
                   .measure = [path, style,
                               metric] { return dolly_value(dolly_of(path, hair_mesh_style_from_name(style)), metric); }};
             }});
  for (const std::string& style : hair_mesh_style_names())
    for (const int pixels : kLookHeights) {
      const Shot shot{"look", hair_mesh_style_from_name(style), static_cast<float>(pixels)};
      for (const bool radiance : {false, true})
        suite.cases.push_back({"swr.look." + style + "." + std::to_string(pixels), radiance ? "radiance" : "coverage", "1",
                               [shot, radiance] { return look_workload(shot, radiance); }});
    }
}

}  // namespace pelage::bench
