// What `pelage render --stats` and `--json` tell.
#include <fmt/format.h>
#include <pelage/runtime.h>
#include <sys/resource.h>

#include "render.h"
#include "stats_json.h"

namespace pelage::cli {
namespace {

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

std::uint64_t control_points(const Scene& scene) {
  std::uint64_t points = 0;
  for (const GroomInstance& groom : scene.grooms)
    if (groom.strands) points += groom.strands->point_count();  // those of hair meshes are never in memory
  return points;
}

double mebibytes(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

// What stays for a frame besides the G-buffer: all that the process holds at its peak, per control point.
double bytes_per_point(const Scene& scene, const RenderResult& result) {
  std::uint64_t gbuffer = 0;
  for (const StageStat& s : result.stats)
    if (s.stage == "raster") gbuffer = s.bytes;
  const std::uint64_t points = control_points(scene), peak = peak_resident_bytes();
  return points ? static_cast<double>(peak > gbuffer ? peak - gbuffer : 0) / static_cast<double>(points) : 0;
}

}  // namespace

void print_stats(const Scene& scene, const RenderResult& result, double seconds) {
  fmt::print("{:<13} {:>10} {:>12} {:>14}  {}\n", "stage", "ms", "MiB", "items", "unit");
  for (const StageStat& s : result.stats)
    fmt::print("{:<13} {:>10.1f} {:>12.1f} {:>14}  {}\n", s.stage, 1000 * s.seconds, mebibytes(s.bytes), s.items, s.unit);
  fmt::print("{:<13} {:>10.1f} {:>12.1f}                 peak of the process; {} threads, {}\n", "total", 1000 * seconds,
             mebibytes(peak_resident_bytes()), thread_count(), active_isa());
  if (control_points(scene))
    fmt::print("{:.1f} bytes per control point besides the G-buffer\n", bytes_per_point(scene, result));
}

void print_json(const Scene& scene, const RenderResult& result, const std::vector<std::string>& outputs, double seconds) {
  nlohmann::ordered_json j;
  j["outputs"] = outputs;
  j["width"] = result.linear.width;
  j["height"] = result.linear.height;
  j["samples"] = scene.settings.samples;
  j["points"] = control_points(scene);
  j["threads"] = thread_count();
  j["isa"] = active_isa();
  j["seconds"] = seconds;
  j["peak_bytes"] = peak_resident_bytes();
  j["bytes_per_point"] = bytes_per_point(scene, result);
  j["hash"] = pixel_hash(result.linear);
  j["stages"] = stages_json(result.stats);
  fmt::print("{}\n", j.dump(2));
}

}  // namespace pelage::cli
