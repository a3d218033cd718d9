// raster: segments per second from the strands in memory to the finished layer, clearing included; 1920 × 1080.
#include "raster/raster.h"

#include <fmt/format.h>

#include <cstring>

#include "bench.h"
#include "frame/camera_view.h"
#include "grooms.h"
#include "naive_raster.h"
#include "raster/gbuffer.h"

namespace pelage::bench {
namespace {

/// A groom ready to be rasterized over and over.
struct Input {
  Scene scene;
  CameraView view;
  SegmentNumbering numbering;
  AssembleJob job;
  GBuffer out;

  explicit Input(const std::string& groom)
      : scene(groom_scene(groom)),
        view(make_camera_view(scene.camera, scene.settings.width, scene.settings.height)),
        numbering(number_segments(scene, view)),
        job(make_assemble_job(scene, view, numbering, 0)) {}

  double segments() const {
    const StrandSet& set = *job.strands;
    double sum = 0;
    for (std::size_t s = 0; s < set.strand_count(); ++s)
      sum += span_count(set.basis, set.offsets[s + 1] - set.offsets[s]) * job.subdivisions;
    return sum;
  }
  void fast(const RasterLayers& layers) { raster_strands(scene, view, numbering, layers, out); }
  void naive(GBuffer& g) const {
    clear_gbuffer(view, {.center = true}, g);
    naive_center(job, g.center);
  }
};

std::string compare(const Buffer<PixelKey>& wanted, const Buffer<PixelKey>& found) {
  if (wanted.size() != found.size()) return "layers differ in size";
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i] != found[i]) return fmt::format("key {} is {:#x}, not {:#x}", i, found[i], wanted[i]);
  return "";
}

std::string check_center(Input& in) {
  GBuffer g;
  in.naive(g);
  in.fast({.center = true});
  return compare(g.center, in.out.center);
}

std::string check_samples(Input& in, int samples) {
  GBuffer g;
  clear_gbuffer(in.view, {.center = false, .samples = samples}, g);
  naive_samples(in.job, samples, g.sample_keys);
  in.fast({.center = false, .samples = samples});
  return compare(g.sample_keys, in.out.sample_keys);
}

Workload layer_workload(const std::string& groom, const RasterLayers& layers,
                        const std::function<std::string(Input&)>& check) {
  auto in = std::make_shared<Input>(groom);
  return {.check = [in, check] { return check(*in); }, .run = [in, layers] { in->fast(layers); }, .items = in->segments()};
}

Workload naive_workload(const std::string& groom) {
  auto in = std::make_shared<Input>(groom);
  return {.check = [in] { return check_center(*in); }, .run = [in] { in->naive(in->out); }, .items = in->segments()};
}

}  // namespace

void add_raster_cases(Suite& suite) {
  const auto add = [&](const std::string& name, std::function<Workload()> prepare) {
    suite.cases.push_back({"raster." + name, "segments_per_second", "1/s", std::move(prepare)});
  };
  for (const std::string& groom : groom_names()) {
    add("naive." + groom, [groom] { return naive_workload(groom); });
    add("centre." + groom, [groom] { return layer_workload(groom, {.center = true}, check_center); });
    add("msaa8." + groom, [groom] {
      return layer_workload(groom, {.center = false, .samples = 8}, [](Input& in) { return check_samples(in, 8); });
    });
    suite.ratios.push_back({"raster.speedup." + groom, {"raster.centre." + groom}, {"raster.naive." + groom}});
    suite.ratios.push_back({"raster.msaa8_share." + groom, {"raster.msaa8." + groom}, {"raster.centre." + groom}});
    suite.ratios.push_back(
        {"raster.scaling." + groom, {"raster.centre." + groom, 2}, {"raster.centre." + groom, 1}});
  }
}

}  // namespace pelage::bench
