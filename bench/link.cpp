// Strand linking: what it costs beside the raster pass that it repairs.
#include <pelage/grow.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "assemble/assemble.h"
#include "bench.h"
#include "core/mesh_tracer.h"
#include "filter/alpha_fix.h"
#include "filter/anisotropic.h"
#include "filter/link.h"
#include "filter/strand_curves.h"
#include "frame/camera_view.h"
#include "frame/linked_frame.h"
#include "grooms.h"
#include "light/light.h"
#include "raster/raster.h"

namespace pelage::bench {
namespace {

/// A groom on the screen, and the samples of it that linking starts from.
struct Linkable {
  Scene scene;
  CameraView view;
  SegmentNumbering numbering;
  StrandLayer layer;

  Linkable(Scene hair, int width, int height) : scene(std::move(hair)) {
    add_default_lights(scene);
    scene.settings.width = width, scene.settings.height = height;
    scene.settings.subdivisions = RenderSettings().subdivisions;  // the curves that a picture shows, not their chords
    view = make_camera_view(scene.camera, width, height);
    numbering = number_segments(scene, view);
    const MeshTracer meshes(scene.meshes);
    const LightRig rig = prepare_lights(scene, meshes);
    Stages stages{Progress()};
    layer = render_strand_layer({scene, meshes, rig, view, numbering}, 1, false, stages).layer;
  }

  std::size_t hair_pixels() const { return layer.hair.count(); }

  struct Repaired {
    Matte matte;
    Buffer<Vec4> color;
  };
  /// Links, alpha fix, filter; the layer is as before afterwards.
  Repaired repair() {
    const Links links = link_strands(layer, GroomCurves(scene, view), scene.settings.link);
    const AnisotropicKernel kernel = kernel_for(screen_box(layer), layer.side, scene.settings.link);
    AlphaStats stats;
    Matte matte = fix_alpha(layer, links, LinkAlpha::kCount, kernel.reach(), stats);
    extend_tangents(matte, layer);
    for (const Fill& fill : links.fills) {
      layer.visibility[fill.pixel] = {}, layer.depth[fill.pixel] = INFINITY, layer.color[fill.pixel] = {};
      layer.hair.remove(fill.pixel);
    }
    Buffer<Vec4> color = filter_anisotropic(matte, kernel);
    return {std::move(matte), std::move(color)};
  }
};

/// What is wrong with the repair by several threads; "" when it has the bits of one.
std::string check_repair(Linkable& input) {
  const Linkable::Repaired many = input.repair();
  const int threads = thread_count();
  set_thread_count(1);
  const Linkable::Repaired one = input.repair();
  set_thread_count(threads);
  bool same = one.matte.hair.count() == many.matte.hair.count();
  one.matte.hair.for_each(0, static_cast<std::size_t>(one.matte.height), [&](int x, int y) {
    same = same && one.color[one.matte.index(x, y)] == many.color[one.matte.index(x, y)];
  });
  return same ? "" : "not the bits of one thread";
}

/// Items are pixels that show hair: time has to grow with them, and with nothing else.
Workload repair_workload(const std::string& groom, int width, int height) {
  const auto input = std::make_shared<Linkable>(groom_scene(groom), width, height);
  return {.check = [input] { return check_repair(*input); },
          .run = [input] { input->repair(); },
          .items = static_cast<double>(input->hair_pixels())};
}

/// `strands` strands of straight50k's style, as much wider or thinner as they are fewer or more: the same coverage.
Scene scene_of_same_coverage(int strands) {
  constexpr int kUsual = 50000;
  Scene scene = groom_scene("straight50k");
  if (strands == kUsual) return scene;
  GrowSettings settings = grow_defaults(HairStyle::kStraight);
  settings.strands = strands, settings.points = 64;
  scene.grooms[0].strands = std::make_shared<const StrandSet>(grow(settings, mannequin_head()));
  scene.grooms[0].width_scale = static_cast<float>(kUsual) / static_cast<float>(strands);
  return scene;
}

/// Seconds a frame: of how many strands the hair pixels are must not matter.
Workload strand_count_workload(int strands) {
  const auto input = std::make_shared<Linkable>(scene_of_same_coverage(strands), 1920, 1080);
  const auto check = [input]() -> std::string {
    const double usual = static_cast<double>(Linkable(groom_scene("straight50k"), 1920, 1080).hair_pixels());
    const double share = static_cast<double>(input->hair_pixels()) / usual;
    if (std::fabs(share - 1) > 0.05) return "hair pixels are " + std::to_string(share) + " of those of 50,000 strands";
    return check_repair(*input);
  };
  return {.check = check, .run = [input] { input->repair(); }};
}

/// The center layer of the same frame; as many items, so that the ratio is one of times.
Workload raster_workload(const std::string& groom, int width, int height) {
  const auto input = std::make_shared<Linkable>(groom_scene(groom), width, height);
  const auto hair = static_cast<std::ptrdiff_t>(input->hair_pixels());
  const auto g = std::make_shared<GBuffer>();
  const auto run = [input, g] { raster_strands(input->scene, input->view, input->numbering, {}, *g); };
  const auto check = [run, g, hair]() -> std::string {
    run();
    const auto hit = std::count_if(g->center.begin(), g->center.end(), [](PixelKey key) { return key != kEmptyPixel; });
    return hit == hair ? "" : "not the pixels that linking starts from";
  };
  return {.check = check, .run = run, .items = static_cast<double>(hair)};
}

}  // namespace

void add_link_cases(Suite& suite) {
  for (const std::string& groom :
       {std::string("straight50k"), std::string("curly50k"), std::string("curly200k"), std::string("sintel")}) {
    const std::string repair = "link.repair." + groom, raster = "link.raster." + groom;
    suite.cases.push_back({repair, "hair_pixels_per_second", "1/s", [groom] { return repair_workload(groom, 1920, 1080); }});
    suite.cases.push_back({raster, "hair_pixels_per_second", "1/s", [groom] { return raster_workload(groom, 1920, 1080); }});
    suite.ratios.push_back({"link.share." + groom, {raster, 2}, {repair, 2}});
    suite.ratios.push_back({"link.scaling." + groom, {repair, 2}, {repair, 1}});
  }
  for (const auto& [name, width, height] : {std::tuple{"480p", 854, 480}, std::tuple{"4k", 3840, 2160}}) {
    const std::string repair = std::string("link.repair.curly50k_") + name;
    suite.cases.push_back(
        {repair, "hair_pixels_per_second", "1/s", [w = width, h = height] { return repair_workload("curly50k", w, h); }});
    suite.ratios.push_back({std::string("link.linear.") + name, {repair}, {"link.repair.curly50k"}});
  }
  for (const int thousands : {10, 50, 200}) {
    const std::string of = "link.strand_count." + std::to_string(thousands) + "k";
    suite.cases.push_back({of, "seconds_per_frame", "s", [=] { return strand_count_workload(1000 * thousands); }});
    if (thousands != 50)
      suite.ratios.push_back({"link.strand_count_ratio." + std::to_string(thousands) + "k", {of}, {"link.strand_count.50k"}});
  }
}

}  // namespace pelage::bench
