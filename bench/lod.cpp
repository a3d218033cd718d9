// lod: strands per second from a groom to its chain of thick hairs, and control points per second that follow the guides.
#include <fmt/format.h>
#include <pelage/lod.h>

#include <cmath>

#include "bench.h"
#include "grooms.h"
#include "lod/slow_lod.h"

namespace pelage::bench {
namespace {

/// Every n-th strand of a groom, all of one width: few enough for the slow way.
StrandSet sample(const StrandSet& whole, std::size_t count) {
  StrandSet set;
  set.basis = whole.basis, set.widths = {8e-5f}, set.offsets = {0};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t s = i * whole.strand_count() / count;
    set.points.insert(set.points.end(), whole.points.begin() + whole.offsets[s], whole.points.begin() + whole.offsets[s + 1]);
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
  }
  return set;
}

std::string check_build(const StrandSet& whole) {
  const StrandSet set = sample(whole, 600);
  const LodSettings settings{.levels = 3, .guides = 20, .memory_share = 20};
  const LodHierarchy lod = build_lod(set, settings);
  const slow::Chain chain = slow::build(set, settings);
  if (lod.guide_strands != chain.guides) return "the guides differ";
  if (lod.levels() != chain.levels.size()) return "the levels differ";
  for (std::size_t l = 0; l < lod.levels(); ++l) {
    if (lod.level(l).size() != chain.levels[l].size()) return fmt::format("level {} has {} hairs", l, lod.level(l).size());
    for (std::size_t h = 0; h < lod.level(l).size(); ++h)
      if (lod.level(l)[h].fibers != chain.levels[l][h].size()) return fmt::format("hair {} of level {} differs", h, l);
  }
  return "";
}

Workload build_workload(const std::string& name) {
  const auto set = groom(name);
  return {.check = [set] { return check_build(*set); },
          .run = [set] { build_lod(*set); },
          .items = static_cast<double>(set->strand_count())};
}

/// A chain, and its guides swung aside.
struct Swung {
  std::shared_ptr<const StrandSet> set;
  LodHierarchy lod;
  std::vector<Vec3> guides;
  ThickHairPose pose;

  explicit Swung(const std::string& name) : set(groom(name)), lod(build_lod(*set)), guides(lod.guides) {
    for (std::size_t i = 0; i < guides.size(); ++i)
      guides[i].x += 0.02f * std::pow(static_cast<float>(i % LodHierarchy::kPoints) / (LodHierarchy::kPoints - 1), 2.f);
  }
  /// With the guides at rest nothing moves.
  std::string check() {
    pose_hairs(lod, lod.guides, pose);
    for (std::size_t i = 0; i < lod.centers.size(); ++i)
      if (length(pose.centers[i] - lod.centers[i]) > 1e-6f) return fmt::format("center {} moved", i);
    const StrandSet posed = pose_strands(lod, *set, lod.guides);
    for (std::size_t i = 0; i < posed.points.size(); ++i)
      if (length(posed.points[i] - set->points[i]) > 1e-6f) return fmt::format("point {} moved", i);
    return "";
  }
};

Workload pose_hairs_workload(const std::string& name) {
  const auto in = std::make_shared<Swung>(name);
  return {.check = [in] { return in->check(); },
          .run = [in] { pose_hairs(in->lod, in->guides, in->pose); },
          .items = static_cast<double>(in->lod.centers.size())};
}

Workload pose_strands_workload(const std::string& name) {
  const auto in = std::make_shared<Swung>(name);
  return {.check = [in] { return in->check(); },
          .run = [in] { pose_strands(in->lod, *in->set, in->guides); },
          .items = static_cast<double>(in->set->point_count())};
}

}  // namespace

void add_lod_cases(Suite& suite) {
  for (const std::string groom : {"straight50k", "curly50k"})
    suite.cases.push_back({"lod.build." + groom, "strands_per_second", "1/s", [groom] { return build_workload(groom); }});
  suite.cases.push_back(
      {"lod.pose_hairs.straight50k", "points_per_second", "1/s", [] { return pose_hairs_workload("straight50k"); }});
  suite.cases.push_back(
      {"lod.pose_strands.straight50k", "points_per_second", "1/s", [] { return pose_strands_workload("straight50k"); }});
}

}  // namespace pelage::bench
