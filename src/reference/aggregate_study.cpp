#include "reference/aggregate_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pelage {
namespace {

constexpr int kA = ClusterScattering::kAzimuths, kI = ClusterScattering::kInclinations;
constexpr int kSteps = 4;  // midpoints across a cell

HairMaterial material_of(HairMaterial::Model model, float eumelanin, float pheomelanin) {
  HairMaterial m;
  m.model = model, m.eumelanin = eumelanin, m.pheomelanin = pheomelanin;
  return m;
}

/// A model made ready for a panel: f·cos θ_i.
class Evaluated {
 public:
  Evaluated(const AggregatePanel& panel, const AggregateModel& model)
      : kind_(model.kind), zhu_(panel.material.model == HairMaterial::Model::kZhu), terms_(model.terms),
        bundle_(bundle_of(panel.shape, model.crossings)) {
    const kernel::ScatterFiber fiber = make_fiber(panel.material, {});
    const float s = kernel::m_sin(panel.theta_o), c = kernel::m_cos(panel.theta_o);
    lobes_ = zhu_ ? kernel::scatter_prepare_zhu(fiber, s, c) : kernel::scatter_prepare_marschner(fiber, s, c);
    aggregate_ = kind_ == AggregateModel::Kind::kOurs ? kernel::scatter_prepare_aggregate(lobes_, bundle_)
                                                      : kernel::scatter_prepare_huang(lobes_, bundle_, terms_);
  }
  Vec3 operator()(float sin_i, float cos_i, float cos_phi) const {
    using namespace kernel;
    if (kind_ == AggregateModel::Kind::kZhu2023 || kind_ == AggregateModel::Kind::kZhu2023Narrow) {
      ScatterLobes kept = lobes_;
      kept.a_tt = {0, 0, 0};
      const Vec3 value = zhu_ ? scatter_zhu(kept, sin_i, cos_i, cos_phi) : scatter_marschner(kept, sin_i, cos_i, cos_phi);
      const float narrow = kind_ == AggregateModel::Kind::kZhu2023Narrow ? 1 : 0;
      return scatter_aggregate_zhu_2023(lobes_, bundle_, narrow, value, sin_i, cos_i, cos_phi);
    }
    const ScatterShares shares = kind_ == AggregateModel::Kind::kOurs ? scatter_shares(aggregate_, cos_phi)
                                                                      : scatter_shares_huang(aggregate_, terms_, cos_phi);
    return zhu_ ? scatter_aggregate_zhu(aggregate_, shares, sin_i, cos_i, cos_phi)
                : scatter_aggregate_marschner(aggregate_, shares, sin_i, cos_i, cos_phi);
  }

 private:
  AggregateModel::Kind kind_;
  bool zhu_;
  kernel::ScatterAggregateTerms terms_;
  kernel::ScatterBundle bundle_;
  kernel::ScatterLobes lobes_;
  kernel::ScatterAggregate aggregate_;
};

}  // namespace

std::vector<AggregatePanel> aggregate_panels() {
  using Model = HairMaterial::Model;
  struct Section {
    const char* name;
    float wide, deep;
  };
  struct Color {
    const char* name;
    float eumelanin, pheomelanin;
  };
  std::vector<AggregatePanel> panels;
  for (const Model model : {Model::kZhu, Model::kMarschner}) {
    for (const Color color :
         {Color{"blond", 0.08f, 0.1f}, Color{"brown", 0.7f, 0.2f}, Color{"black", 6, 0}, Color{"white", 0, 0}}) {
      for (const Section section : {Section{"circle", 1, 1}, Section{"wide", 2, 0.5f}, Section{"deep", 0.5f, 2}}) {
        for (const bool dense : {true, false}) {
          // A section of density rho has N r^2 = rho a b.
          const float rho = dense ? 0.35f : 0.04f, scale = std::sqrt(100 / rho);
          panels.push_back({std::string(model == Model::kZhu ? "zhu." : "marschner.") + color.name + "." + section.name + "." +
                                (dense ? "dense" : "sparse"),
                            {100, 1, scale * section.wide, scale * section.deep},
                            material_of(model, color.eumelanin, color.pheomelanin),
                            0});
        }
      }
    }
  }
  return panels;
}

std::vector<AggregateModel> aggregate_models() {
  using Kind = AggregateModel::Kind;
  using Crossings = AggregateModel::Crossings;
  const kernel::ScatterAggregateTerms all = kernel::scatter_terms_huang();
  kernel::ScatterAggregateTerms no_side = all, no_shadow = all, damped = all;
  no_side.side = 0, no_shadow.shadow = 0, damped.forward = damped.back = kernel::kDualDensity;
  return {{"ours", Kind::kOurs, Crossings::kBuffon, all},
          {"huang", Kind::kHuang, Crossings::kHuang, all},
          {"huang-buffon", Kind::kHuang, Crossings::kBuffon, all},
          {"huang-no-a1plus", Kind::kHuang, Crossings::kHuang, no_side},
          {"huang-no-s", Kind::kHuang, Crossings::kHuang, no_shadow},
          {"huang-damped", Kind::kHuang, Crossings::kHuang, damped},
          {"huang-fitted", Kind::kHuang, Crossings::kHuang, kernel::scatter_terms_fitted()},
          {"zhu2023", Kind::kZhu2023, Crossings::kHuang, all},
          {"zhu2023-buffon", Kind::kZhu2023, Crossings::kBuffon, all},
          {"zhu2023-narrow", Kind::kZhu2023Narrow, Crossings::kHuang, all},
          {"zhu2023-narrow-buffon", Kind::kZhu2023Narrow, Crossings::kBuffon, all}};
}

kernel::ScatterBundle bundle_of(const ClusterShape& s, AggregateModel::Crossings crossings) {
  const auto make =
      crossings == AggregateModel::Crossings::kHuang ? kernel::scatter_bundle_huang : kernel::scatter_bundle_buffon;
  return make(static_cast<float>(s.hairs), s.radius, s.half_width, s.half_depth);
}

std::vector<Vec3> model_energies(const AggregatePanel& panel, const AggregateModel& model) {
  const Evaluated evaluated(panel, model);
  std::vector<Vec3> cells(kA * kI);
  constexpr double kPiD = std::numbers::pi, dt = kPiD / (kI * kSteps), dp = kPiD / (kA * kSteps);
  for (int i = 0; i < kA * kSteps; ++i) {
    const auto cos_phi = static_cast<float>(std::cos((i + 0.5) * dp));
    for (int j = 0; j < kI * kSteps; ++j) {
      const double theta = (j + 0.5) * dt - kPiD / 2, c = std::cos(theta);
      Vec3& cell = cells[static_cast<std::size_t>(i / kSteps * kI + j / kSteps)];
      cell = cell + evaluated(static_cast<float>(std::sin(theta)), static_cast<float>(c), cos_phi) *
                        static_cast<float>(2 * c * dt * dp);
    }
  }
  return cells;
}

AggregateProfiles profiles_of(const std::vector<Vec3>& energies) {
  AggregateProfiles p{std::vector<Vec3>(kA), std::vector<Vec3>(kI), std::vector<Vec3>(kI)};
  for (std::size_t i = 0; i < kA; ++i) {
    for (std::size_t j = 0; j < kI; ++j) {
      const Vec3 e = energies[i * kI + j];
      p.azimuth[i] = p.azimuth[i] + e;
      Vec3& side = (i < kA / 2 ? p.lit : p.through)[j];
      side = side + e;
    }
  }
  return p;
}

ProfileErrors errors_of(const AggregateProfiles& model, const AggregateProfiles& truth) {
  const auto error = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const Vec3 d = a[i] - b[i];
      difference += std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z), sum += b[i].x + b[i].y + b[i].z;
    }
    return sum > 0 ? difference / sum : 0;
  };
  return {error(model.azimuth, truth.azimuth), error(model.lit, truth.lit), error(model.through, truth.through)};
}

ProfileErrors best_of_zhu_2023(const AggregatePanel& panel, const AggregateProfiles& truth) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  ProfileErrors best{kNone, kNone, kNone};
  for (const AggregateModel& m : aggregate_models()) {
    if (m.kind != AggregateModel::Kind::kZhu2023 && m.kind != AggregateModel::Kind::kZhu2023Narrow) continue;
    const ProfileErrors e = errors_of(profiles_of(model_energies(panel, m)), truth);
    best = {std::min(best.azimuth, e.azimuth), std::min(best.lit, e.lit), std::min(best.through, e.through)};
  }
  return best;
}

}  // namespace pelage
