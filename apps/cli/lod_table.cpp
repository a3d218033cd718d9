#include "lod_table.h"

#include <fmt/format.h>

namespace pelage::cli {

using Json = nlohmann::ordered_json;

Json lod_json(const LodHierarchy& lod, const StrandSet& strands) {
  Json levels = Json::array();
  for (const LodLevelSummary& s : summarize(lod))
    levels.push_back({{"hairs", s.hairs},
                      {"segments", s.segments},
                      {"mean_fibers", s.mean_fibers},
                      {"most_fibers", s.most_fibers},
                      {"mean_width_m", s.mean_width},
                      {"mean_area_m2", s.mean_area},
                      {"mean_density", s.mean_density},
                      {"bytes", s.bytes}});
  const std::size_t groom = strands.points.size() * sizeof(Vec3) + strands.widths.size() * sizeof(float);
  return {{"guides", lod.guide_count()},       {"levels", levels},
          {"strands", strands.strand_count()}, {"strand_segments", strands.point_count() - strands.strand_count()},
          {"bytes", resident_bytes(lod)},      {"groom_bytes", groom}};
}

std::vector<std::string> lod_rows(const Json& json) {
  const auto megabytes = [](const Json& bytes) { return bytes.get<double>() / (1024 * 1024); };
  std::vector<std::string> rows = {
      fmt::format("{} guides; {:.1f} MiB beside {:.1f} MiB of strands, {:.0f} %", json["guides"].get<std::size_t>(),
                  megabytes(json["bytes"]), megabytes(json["groom_bytes"]),
                  100 * json["bytes"].get<double>() / json["groom_bytes"].get<double>()),
      fmt::format("{:>7} {:>9} {:>10} {:>14} {:>10} {:>11} {:>10}", "level", "hairs", "segments", "strands each", "most",
                  "mean width", "memory")};
  std::size_t level = 0;
  for (const Json& l : json["levels"])
    rows.push_back(fmt::format("{:>7} {:>9} {:>10} {:>14.1f} {:>10} {:>8.2f} mm {:>6.1f} MiB", level++,
                               l["hairs"].get<std::size_t>(), l["segments"].get<std::size_t>(), l["mean_fibers"].get<double>(),
                               l["most_fibers"].get<std::size_t>(), 1e3 * l["mean_width_m"].get<double>(),
                               megabytes(l["bytes"])));
  rows.push_back(fmt::format("{:>7} {:>9} {:>10}", "strands", json["strands"].get<std::size_t>(),
                             json["strand_segments"].get<std::size_t>()));
  return rows;
}

}  // namespace pelage::cli
