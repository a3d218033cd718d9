// assemble: points per second from the strands in memory to projected blocks.
#include "assemble/assemble.h"

#include <fmt/format.h>

#include "bench.h"
#include "core/parallel.h"
#include "frame/camera_view.h"
#include "grooms.h"
#include "naive_raster.h"

namespace pelage::bench {
namespace {

struct Input {
  Scene scene;
  AssembleJob job;
  Input(const std::string& groom, std::uint32_t parts) : scene(groom_scene(groom)) {
    scene.settings.subdivisions = static_cast<int>(parts);
    const CameraView view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
    job = make_assemble_job(scene, view, number_segments(scene, view), 0);
  }
  void run() const {
    parallel_for(job.strands->strand_count(), 256, [&](std::size_t begin, std::size_t end) {
      thread_local ScreenBlock block;
      for (std::size_t s = begin; s < end;) s = assemble_strands(job, s, end, block);
    });
  }
};

/// Every point of every strand, in lanes and plainly: the same bits.
std::string check(const Input& in) {
  ScreenBlock block;
  std::vector<NaivePoint> points;
  for (std::size_t s = 0, end; s < in.job.strands->strand_count(); s = end) {
    end = assemble_strands(in.job, s, in.job.strands->strand_count(), block);
    std::size_t at = 0;
    for (std::size_t strand = s; strand < end; ++strand) {
      naive_points(in.job, strand, points);
      naive_caps(points);
      for (const NaivePoint& p : points) {
        if (p.x != block.x[at] || p.y != block.y[at] || p.depth != block.depth[at] || p.radius != block.radius[at] ||
            p.cap.x != block.cap_x[at] || p.cap.y != block.cap_y[at])
          return fmt::format("strand {}: point {} of its block differs", strand, at);
        ++at;
      }
    }
    if (at != block.count) return fmt::format("strand {}: {} points, not {}", s, block.count, at);
  }
  return "";
}

Workload workload(const std::string& groom, std::uint32_t parts) {
  auto in = std::make_shared<Input>(groom, parts);
  return {.check = [in] { return check(*in); },
          .run = [in] { in->run(); },
          .items = static_cast<double>(in->job.strands->point_count()) * parts};
}

}  // namespace

void add_assemble_cases(Suite& suite) {
  for (const std::string& groom : groom_names()) {
    suite.cases.push_back({"assemble.points." + groom, "points_per_second", "1/s", [groom] { return workload(groom, 1); }});
    suite.cases.push_back({"assemble.refined." + groom, "points_per_second", "1/s", [groom] { return workload(groom, 4); }});
  }
}

}  // namespace pelage::bench
