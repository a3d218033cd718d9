// light: control-point segments per second from the strands in memory to the finished opacity map of the key light, and
// the seconds that all maps of the default lights take.
#include "light/light.h"

#include <fmt/format.h>

#include <cmath>

#include "bench.h"
#include "core/rng.h"
#include "frame/light_lookup.h"
#include "grooms.h"
#include "light/light_view.h"
#include "light/opacity_map.h"

namespace pelage::bench {
namespace {

constexpr int kMapSize = 1024;
constexpr double kMaxError = 0.02;  ///< relative, of areas and of mean crossings

struct Input {
  Scene scene;
  Light light;
  OpacityMap map;

  explicit Input(const std::string& groom) : scene(groom_scene(groom)) {
    add_default_lights(scene);
    light = scene.lights.front();
  }
  void build(const std::vector<GroomInstance>& grooms) {
    const std::vector<StrandLines> lines = strand_lines(grooms);
    map = build_opacity_map(lines, light_views(light, bounds(lines), kMapSize).front());
  }
  void build() { build(scene.grooms); }
  double segments() const {
    const StrandSet& set = *scene.grooms[0].strands;
    return static_cast<double>(set.point_count() - set.strand_count());
  }
};

Vec3 across(Vec3 v, Vec3 direction) { return v - direction * dot(v, direction); }

/// Area that the groom shows to a directional light, overlaps counted, from its control polygon, m².
double shown_area(const GroomInstance& groom, Vec3 direction) {
  const StrandSet& set = *groom.strands;
  double area = 0;
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    for (std::size_t i = set.offsets[s]; i + 1 < set.offsets[s + 1]; ++i)
      area += static_cast<double>(length(across(set.points[i + 1] - set.points[i], direction))) *
              static_cast<double>(0.5f * (set.width(i) + set.width(i + 1)));
  return area * static_cast<double>(groom.width_scale);
}

/// The same from the map: crossings times the texels' area.
double drawn_area(const OpacityMap& map) {
  double sum = 0;
  for (std::size_t t = OpacityMap::kLayers - 1; t < map.crossings.size(); t += OpacityMap::kLayers)
    sum += static_cast<double>(map.crossings[t]);
  return sum * static_cast<double>(OpacityMap::kCrossingUnit) / std::pow(static_cast<double>(map.view.focal), 2);
}

/// The groom thinned to about `strands`, as polylines: small enough to count every crossing.
GroomInstance thinned(const GroomInstance& groom, std::size_t strands) {
  const StrandSet& set = *groom.strands;
  auto few = std::make_shared<StrandSet>();
  few->basis = CurveBasis::kLinear, few->offsets = {0}, few->widths = {20 * set.width(0)};
  for (std::size_t s = 0; s < set.strand_count(); s += set.strand_count() / strands + 1) {
    few->points.insert(few->points.end(), set.points.begin() + set.offsets[s], set.points.begin() + set.offsets[s + 1]);
    few->offsets.push_back(static_cast<std::uint32_t>(few->points.size()));
  }
  GroomInstance result = groom;
  result.strands = few;
  return result;
}

/// Strands of `set` whose bands the whole line through p along d crosses.
int count_crossings(const StrandSet& set, Vec3 p, Vec3 d) {
  int count = 0;
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    for (std::size_t i = set.offsets[s]; i + 1 < set.offsets[s + 1]; ++i) {
      const Vec3 way = across(set.points[i + 1] - set.points[i], d), to = across(p - set.points[i], d);
      const float t = dot(to, way) / dot(way, way);
      count += t > 0 && t < 1 && length(to - way * t) < 0.5f * set.width(i);
    }
  return count;
}

std::string check(Input& in) {
  in.build();
  const double shown = shown_area(in.scene.grooms[0], in.light.direction), drawn = drawn_area(in.map);
  if (!(std::fabs(drawn / shown - 1) < kMaxError)) return fmt::format("the map shows {} m² of strands, not {}", drawn, shown);

  const std::vector<GroomInstance> few = {thinned(in.scene.grooms[0], 250)};
  in.build(few);
  const Bounds box = bounds(*few[0].strands);
  double looked_up = 0, counted = 0;
  for (std::uint32_t i = 0; i < 6000; ++i) {
    Rng rng(1, i);
    const Vec3 p = box.lower + box.extent() * Vec3(rng.uniform(), rng.uniform(), rng.uniform());
    looked_up += static_cast<double>(crossings_at(in.map, p + in.light.direction * (2 * length(box.extent()))));
    counted += count_crossings(*few[0].strands, p, in.light.direction);
  }
  if (!(std::fabs(looked_up / counted - 1) < kMaxError + 3 / std::sqrt(counted)))
    return fmt::format("{} crossings looked up, {} counted", looked_up, counted);
  return "";
}

}  // namespace

void add_light_cases(Suite& suite) {
  for (const std::string& groom : groom_names()) {
    const std::string name = "light.opacity." + groom;
    suite.cases.push_back({name, "segments_per_second", "1/s", [groom] {
                             auto in = std::make_shared<Input>(groom);
                             return Workload{
                                 .check = [in] { return check(*in); }, .run = [in] { in->build(); }, .items = in->segments()};
                           }});
    suite.ratios.push_back({"light.opacity_scaling." + groom, {name, 2}, {name, 1}});
    suite.cases.push_back({"light.all." + groom, "seconds_per_frame", "s", [groom] {
                             auto in = std::make_shared<Input>(groom);
                             return Workload{.check = [in] { return check(*in); },
                                             .run = [in] { prepare_lights(in->scene, MeshTracer({})); }};
                           }});
  }
}

}  // namespace pelage::bench
