// raster: segments per second from the strands in memory to the finished layer, clearing included; 1920 × 1080.
#include "raster/raster.h"

#include <fmt/format.h>

#include <algorithm>
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

/// `view` with k × k pixels for each of its own, of rows `first` … `first` + `rows` − 1.
CameraView magnify(const CameraView& view, int k, int first, int rows) {
  CameraView fine = view;
  const float scale = static_cast<float>(k);
  fine.focal *= scale, fine.center_x *= scale;
  fine.center_y = (view.center_y - static_cast<float>(first)) * scale;
  fine.width = k * view.width, fine.height = k * rows;
  return fine;
}

/// Analytic coverage against 256 samples a pixel: the sample layer of 16 at four times the width and height.
struct CoverageError {
  double absolute = 0;  ///< mean over the pixels that either touches
  double mean = 0;      ///< of the mean coverage, relative
  std::string verdict() const {
    if (!(absolute <= 0.03)) return fmt::format("mean absolute error {:.4f}", absolute);
    return std::fabs(mean) <= 0.01 ? "" : fmt::format("mean coverage is off by {:.4f}", mean);
  }
};

CoverageError coverage_error(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering) {
  constexpr int kStrip = 32;  // rows; all samples at once would not fit into memory
  const std::size_t width = static_cast<std::size_t>(view.width);
  GBuffer g, fine;
  raster_strands(scene, view, numbering, {.center = false, .analytic = true}, g);
  double error = 0, analytic = 0, exact = 0, touched = 0;
  const auto count_hits = [&](std::size_t x, std::size_t y) {
    int hits = 0;
    for (std::size_t i = 0; i < 256; ++i)
      hits += fine.sample_keys[((4 * y + i / 64) * 4 * width + 4 * x + i / 16 % 4) * 16 + i % 16] != kEmptyPixel;
    return hits;
  };
  for (int first = 0; first < view.height; first += kStrip) {
    const int rows = std::min(kStrip, view.height - first);
    raster_strands(scene, magnify(view, 4, first, rows), numbering, {.center = false, .samples = 16}, fine);
    for (std::size_t y = 0; y < static_cast<std::size_t>(rows); ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const double found = analytic_coverage(g, (static_cast<std::size_t>(first) + y) * width + x);
        const double wanted = count_hits(x, y) / 256.0;
        if (found == 0 && wanted == 0) continue;
        ++touched, error += std::fabs(found - wanted), analytic += found, exact += wanted;
      }
  }
  return {error / touched, analytic / exact - 1};
}

/// At a quarter of the benchmark's size.
std::string check_analytic(Input& in) {
  const CameraView view = make_camera_view(in.scene.camera, in.view.width / 4, in.view.height / 4);
  return coverage_error(in.scene, view, in.numbering).verdict();
}

/// The default view of a scene, on an image as high as makes its groom `groom_height` pixels high.
CameraView view_of_height(const Scene& scene, int groom_height) {
  constexpr int kTrial = 1000;
  const CameraView trial = make_camera_view(scene.camera, kTrial, kTrial);
  float top = INFINITY, bottom = -INFINITY;
  for (const Vec3& p : scene.grooms[0].strands->points) {
    const float y = project(trial, transform_point(trial.world_to_camera, p)).y;
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  const int height = static_cast<int>(std::lround(static_cast<float>(kTrial * groom_height) / (bottom - top)));
  return make_camera_view(scene.camera, height * 16 / 9, height);
}

/// The mean absolute error of a whole groom's coverage.
Workload coverage_workload(const std::string& groom, int groom_height) {
  struct Coverage {
    Scene scene;
    CameraView view;
    CoverageError error;
  };
  auto c = std::make_shared<Coverage>();
  c->scene = groom_scene(groom), c->view = view_of_height(c->scene, groom_height);
  return {.check =
              [c] {
                c->error = coverage_error(c->scene, c->view, number_segments(c->scene, c->view));
                return c->error.verdict();
              },
          .measure = [c] { return c->error.absolute; }};
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
    if (groom == "straight50k" || groom == "curly50k")
      for (const int height : {10, 40, 160, 640, 2000})
        suite.cases.push_back({fmt::format("raster.coverage_error.{}.{}", groom, height), "mean_absolute_error", "1",
                               [groom, height] { return coverage_workload(groom, height); }});
    suite.ratios.push_back({"raster.speedup." + groom, {"raster.centre." + groom}, {"raster.naive." + groom}});
    suite.ratios.push_back({"raster.msaa8_share." + groom, {"raster.msaa8." + groom}, {"raster.centre." + groom}});
    suite.ratios.push_back({"raster.scaling." + groom, {"raster.centre." + groom, 2}, {"raster.centre." + groom, 1}});
  }
}

}  // namespace pelage::bench
