// Models of hair bundles beside traced bundles:
//   aggregate_plots FOLDER [CLUSTERS [RAYS]]   writes aggregate_azimuth.svg, aggregate_inclination.svg and aggregate.md there
// aggregate.md has every panel's errors by model. 100 clusters of 2000 rays unless told otherwise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "oracle/diagram.h"
#include "reference/aggregate_study.h"

namespace pelage {
namespace {

constexpr const char* kDrawn[] = {"ours", "huang", "zhu2023"};  ///< lines; the truth is dots
constexpr const char* kPanels[] = {"zhu.blond.circle.dense", "zhu.blond.circle.sparse", "zhu.brown.deep.dense",
                                   "marschner.brown.wide.sparse"};

/// Energies by cells as a density over degrees, green channel.
std::vector<Vec2> curve(const std::vector<Vec3>& profile, float first, float degrees) {
  std::vector<Vec2> points;
  const float step = degrees / static_cast<float>(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i)
    points.push_back({first + (static_cast<float>(i) + 0.5f) * step, profile[i].y / step * 100});
  return points;
}

plots::Diagram diagram(double left, const std::string& title, const std::string& x_title, const std::vector<Vec2>& truth,
                       const std::map<std::string, std::vector<Vec2>>& lines) {
  float most = 0;
  for (const Vec2& p : truth) most = std::max(most, p.y);
  const double digit = std::pow(10, std::floor(std::log10(static_cast<double>(most))));
  plots::Diagram d(left, 30, 180, digit * std::ceil(1.25 * static_cast<double>(most) / digit), title, x_title);
  d.dots(truth, plots::kColors[1]);
  d.label(0, "traced", plots::kColors[1], true);
  constexpr const char* kStrokes[] = {plots::kColors[0], plots::kColors[2], plots::kColors[3]};
  for (int i = 0; i < 3; ++i) {
    d.line(lines.at(kDrawn[i]), kStrokes[i], i == 0 ? "" : "4 3");
    d.label(i + 1, kDrawn[i], kStrokes[i], true);
  }
  return d;
}

struct Figures {
  std::vector<plots::Diagram> azimuth, inclination;
  std::string table;
};

void add_figures(Figures& figures, const AggregatePanel& panel, const AggregateProfiles& truth) {
  std::map<std::string, std::vector<Vec2>> around, along;
  for (const AggregateModel& m : aggregate_models()) {
    const AggregateProfiles p = profiles_of(model_energies(panel, m));
    around[m.name] = curve(p.azimuth, 0, 180), along[m.name] = curve(p.through, 0, 180);
  }
  const double left = 40 + 450. * static_cast<double>(figures.azimuth.size());
  figures.azimuth.push_back(
      diagram(left, panel.name, "azimuth between light and eye, degrees; % a degree", curve(truth.azimuth, 0, 180), around));
  figures.inclination.push_back(diagram(left, panel.name, "inclination of light from behind + 90, degrees; % a degree",
                                        curve(truth.through, 0, 180), along));
}

int draw(const std::string& folder, int clusters, int rays) {
  Figures figures;
  figures.table = fmt::format(
      "Relative errors of the profiles over azimuth, inclination on the lit side, inclination on the other; {} clusters "
      "of {} rays.\n\n| panel | crossings |",
      clusters, rays);
  std::string rule = "\n|---|---|";
  for (const AggregateModel& m : aggregate_models()) figures.table += fmt::format(" {} |", m.name), rule += "---|";
  figures.table += rule + "\n";
  std::map<std::string, ProfileErrors> sums;
  const std::vector<AggregatePanel> panels = aggregate_panels();
  for (const AggregatePanel& p : panels) {
    const ClusterScattering traced = trace_clusters(p.shape, FiberMaterial(p.material), p.theta_o, clusters, rays, 7);
    const AggregateProfiles truth = profiles_of(traced.energy);
    figures.table += fmt::format("| {} | {:.2f} |", p.name, traced.crossings);
    for (const AggregateModel& m : aggregate_models()) {
      const ProfileErrors e = errors_of(profiles_of(model_energies(p, m)), truth);
      figures.table += fmt::format(" {:.2f} {:.2f} {:.2f} |", e.azimuth, e.lit, e.through);
      ProfileErrors& sum = sums[m.name];
      sum = {sum.azimuth + e.azimuth, sum.lit + e.lit, sum.through + e.through};
    }
    figures.table += "\n";
    if (std::find(std::begin(kPanels), std::end(kPanels), p.name) != std::end(kPanels)) add_figures(figures, p, truth);
  }
  figures.table += "| mean | |";
  for (const AggregateModel& m : aggregate_models()) {
    const ProfileErrors& e = sums[m.name];
    const auto n = static_cast<double>(panels.size());
    figures.table += fmt::format(" {:.3f} {:.3f} {:.3f} |", e.azimuth / n, e.lit / n, e.through / n);
    std::printf("%-24s azimuth %.3f, lit side %.3f, other side %.3f\n", m.name.c_str(), e.azimuth / n, e.lit / n,
                e.through / n);
  }
  plots::write(folder + "/aggregate_azimuth.svg", figures.azimuth);
  plots::write(folder + "/aggregate_inclination.svg", figures.inclination);
  std::ofstream(folder + "/aggregate.md") << figures.table << "\n";
  return 0;
}

}  // namespace
}  // namespace pelage

int main(int argc, char** argv) {
  if (argc >= 2 && argc <= 4)
    return pelage::draw(argv[1], argc > 2 ? std::max(std::atoi(argv[2]), 1) : 100,
                        argc > 3 ? std::max(std::atoi(argv[3]), 1) : 2000);
  std::fprintf(stderr, "usage: aggregate_plots FOLDER [CLUSTERS [RAYS]]\n");
  return 2;
}
