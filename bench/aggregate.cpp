// aggregate: how far the models of hair bundles are from traced ones, panel by panel, and what an evaluation costs beside a single
// fiber's and dual scattering's.
//
//   aggregate.error.<family>.<color>.<section>.<density>.<model>     mean of the relative errors of three profiles
//   aggregate.cost.<model>                                             seconds of an evaluation: prepared once, three lights
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "aggregate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {
#include "aggregate_cost.inc"
}  // namespace wide

/// All fibers of the inputs by one model, a lane each; see aggregate_cost.inc.
void run_cost(int model, const float* in, float* out, std::size_t n) {
  const auto step = static_cast<std::size_t>(wide::lanes());
  for (std::size_t i = 0; i < n; i += step)
    wide::store(wide::cost_of(model, [&](std::size_t k) { return wide::load(in + k * n + i); }), out + i);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <fmt/format.h>

#include <map>
#include <memory>

#include "bench.h"
#include "core/rng.h"
#include "kernel/scalar.h"
#include "reference/aggregate_study.h"

namespace pelage {
namespace kernel {
#include "aggregate_cost.inc"
}  // namespace kernel

HWY_EXPORT(run_cost);

namespace bench {
namespace {

constexpr int kClusters = 100, kRays = 1000;
constexpr std::size_t kFibers = 1 << 14;

struct CostInput {
  std::vector<float> in = std::vector<float>(kernel::kCostInputs * kFibers), out = std::vector<float>(kFibers);

  CostInput() {
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = Rng(3, static_cast<std::uint32_t>(i)).uniform();
  }
  void run(int model) { HWY_DYNAMIC_DISPATCH(run_cost)(model, in.data(), out.data(), kFibers); }
  std::string check(int model) {
    run(model);
    for (std::size_t i = 0; i < kFibers; ++i)
      if (out[i] != kernel::cost_of(model, [&](std::size_t k) { return in[k * kFibers + i]; }))
        return fmt::format("fiber {} differs from the one-lane answer", i);
    return "";
  }
};

/// Traced once for all models of a panel.
const AggregateProfiles& truth_of(const AggregatePanel& panel) {
  static std::map<std::string, AggregateProfiles> made;
  const auto found = made.find(panel.name);
  if (found != made.end()) return found->second;
  return made[panel.name] =
             profiles_of(trace_clusters(panel.shape, FiberMaterial(panel.material), panel.theta_o, kClusters, kRays, 1).energy);
}

/// Ours has to be closer than whatever reading of Zhu 2023, in every profile.
std::string check_error(const AggregatePanel& panel, const AggregateModel& model) {
  if (model.kind != AggregateModel::Kind::kOurs) return "";
  const AggregateProfiles& truth = truth_of(panel);
  const ProfileErrors ours = errors_of(profiles_of(model_energies(panel, model)), truth), zhu = best_of_zhu_2023(panel, truth);
  if (ours.azimuth < zhu.azimuth && ours.lit < zhu.lit && ours.through < zhu.through) return "";
  return fmt::format("errors {:.3f} {:.3f} {:.3f}, of Zhu 2023 {:.3f} {:.3f} {:.3f}", ours.azimuth, ours.lit, ours.through,
                     zhu.azimuth, zhu.lit, zhu.through);
}

}  // namespace

void add_aggregate_cases(Suite& suite) {
  for (const AggregatePanel& panel : aggregate_panels()) {
    for (const AggregateModel& model : aggregate_models()) {
      if (model.name == "huang-damped" || model.name.find("zhu2023-") == 0) continue;
      const auto error = [panel, model] {
        const ProfileErrors e = errors_of(profiles_of(model_energies(panel, model)), truth_of(panel));
        return (e.azimuth + e.lit + e.through) / 3;
      };
      suite.cases.push_back({fmt::format("aggregate.error.{}.{}", panel.name, model.name), "relative_error", "1",
                             [=] { return Workload{.check = [=] { return check_error(panel, model); }, .measure = error}; }});
    }
  }
  constexpr const char* kModels[] = {"single", "dual", "huang", "ours"};
  for (int model = 0; model < 4; ++model) {
    suite.cases.push_back({fmt::format("aggregate.cost.{}", kModels[model]), "evaluations_per_second", "1/s", [model] {
                             const auto input = std::make_shared<CostInput>();
                             return Workload{.check = [=] { return input->check(model); },
                                             .run = [=] { input->run(model); },
                                             .items = static_cast<double>(kFibers)};
                           }});
  }
  // How many times the cost of dual scattering's evaluation.
  suite.ratios.push_back({"aggregate.cost.huang_over_dual", {"aggregate.cost.dual"}, {"aggregate.cost.huang"}});
  suite.ratios.push_back({"aggregate.cost.ours_over_dual", {"aggregate.cost.dual"}, {"aggregate.cost.ours"}});
}

}  // namespace bench
}  // namespace pelage
#endif  // HWY_ONCE
