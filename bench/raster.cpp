// raster: segments per second from the strands in memory to the finished layer, clearing included; 1920 × 1080.
#include "raster/raster.h"

#include <fmt/format.h>

#include <cmath>

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
      : scene(groom_scene(groom)), view(make_camera_view(scene.camera, scene.settings.width, scene.settings.height)),
        numbering(number_segments(scene, view)), job(make_assemble_job(scene, view, numbering, 0)) {}

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

/// Mean coverage against 256 samples a pixel: the sample layer of 16 at four times the width and height, at a quarter of
/// the benchmark's size. Says what is wrong where pixels differ by more than 0.03 in the mean, or the means by 1 %.
std::string check_analytic(Input& in) {
  const int width = in.view.width / 4, height = in.view.height / 4;
  const CameraView view = make_camera_view(in.scene.camera, width, height);
  const CameraView fine_view = make_camera_view(in.scene.camera, 4 * width, 4 * height);
  GBuffer g, fine;
  raster_strands(in.scene, view, in.numbering, {.center = false, .analytic = true}, g);
  raster_strands(in.scene, fine_view, in.numbering, {.center = false, .samples = 16}, fine);
  double error = 0, analytic = 0, exact = 0;
  std::size_t touched = 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      int hits = 0;
      for (std::size_t i = 0; i < 256; ++i) {
        const std::size_t at = (4 * y + i / 64) * 4 * static_cast<std::size_t>(width) + 4 * x + i / 16 % 4;
        hits += fine.sample_keys[at * 16 + i % 16] != kEmptyPixel;
      }
      const double found = analytic_coverage(g, y * static_cast<std::size_t>(width) + x), wanted = hits / 256.0;
      if (found == 0 && wanted == 0) continue;
      ++touched, error += std::fabs(found - wanted), analytic += found, exact += wanted;
    }
  if (touched == 0) return "nothing is covered";
  if (error / static_cast<double>(touched) > 0.03)
    return fmt::format("mean absolute error {:.4f}", error / static_cast<double>(touched));
  return std::fabs(analytic / exact - 1) > 0.01 ? fmt::format("mean coverage is off by {:.4f}", analytic / exact - 1) : "";
}

Workload layer_workload(const std::string& groom, const RasterLayers& layers, const std::function<std::string(Input&)>& check) {
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
    add("analytic." + groom, [groom] { return layer_workload(groom, {.center = false, .analytic = true}, check_analytic); });
    suite.ratios.push_back({"raster.speedup." + groom, {"raster.centre." + groom}, {"raster.naive." + groom}});
    suite.ratios.push_back({"raster.msaa8_share." + groom, {"raster.msaa8." + groom}, {"raster.centre." + groom}});
    suite.ratios.push_back({"raster.scaling." + groom, {"raster.centre." + groom, 2}, {"raster.centre." + groom, 1}});
  }
}

}  // namespace pelage::bench
