// Traced bundles: how many fibers rays meet, energy, the single fiber; and the models of bundles against them.
#include "reference/fiber_cluster.h"

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "reference/aggregate_study.h"

namespace pelage {
namespace {

HairMaterial material(float eumelanin, HairMaterial::Model model = HairMaterial::Model::kMarschner) {
  HairMaterial m;
  m.model = model, m.eumelanin = eumelanin, m.pheomelanin = 0;
  return m;
}

TEST(FiberCluster, FibersLieInsideAndDoNotOverlap) {
  const ClusterShape shape{80, 1, 40, 10};
  const FiberCluster cluster(shape, 3);
  for (std::uint32_t i = 0; i < 80; ++i) {
    const Vec2 p = cluster.center(i);
    // The farthest point of the circle from the axis is inside as well.
    EXPECT_LE(std::hypot(p.x / 39, p.y / 9), 1);
    for (std::uint32_t k = 0; k < i; ++k) EXPECT_GE(std::hypot(p.x - cluster.center(k).x, p.y - cluster.center(k).y), 2);
  }
  EXPECT_THROW(FiberCluster({400, 1, 20, 20}, 1), Error);
}

// The next fiber of a ray against every one of them, by the distance at which its circle is entered.
TEST(FiberCluster, NearestIsTheFirstThatIsEntered) {
  const FiberCluster cluster({60, 1, 14, 14}, 9);
  for (int i = 0; i < 720; ++i) {
    const float angle = static_cast<float>(i) * 0.0087f;
    const auto from = static_cast<std::uint32_t>(i % 60);
    const Vec2 o = cluster.center(from), d(std::cos(angle), std::sin(angle));
    std::uint32_t expected = FiberCluster::kNone;
    float best = INFINITY;
    for (std::uint32_t k = 0; k < 60; ++k) {
      const Vec2 v(cluster.center(k).x - o.x, cluster.center(k).y - o.y);
      const float b = v.x * d.x + v.y * d.y, c = v.x * v.x + v.y * v.y - 1, disc = b * b - c;
      if (k == from || disc <= 0 || b - std::sqrt(disc) <= 0) continue;
      if (b - std::sqrt(disc) < best) best = b - std::sqrt(disc), expected = k;
    }
    EXPECT_EQ(cluster.nearest(o, d, from), expected) << i;
  }
}

TEST(FiberCluster, WhiteFibersGiveAllOfTheLightBack) {
  for (const auto model : {HairMaterial::Model::kZhu, HairMaterial::Model::kMarschner}) {
    const ClusterScattering s = trace_clusters({40, 1, 12, 12}, FiberMaterial(material(0, model)), 0.4f, 10, 500, 1);
    Vec3 sum(0, 0, 0);
    for (const Vec3& e : s.energy) sum = sum + e;
    EXPECT_NEAR(sum.y, 1, 0.02f);
  }
}

// One fiber that fills its ellipse scatters as its model says.
TEST(FiberCluster, ALoneFiberIsItsModel) {
  const AggregatePanel panel{"", {1, 1, 1.0001f, 1.0001f}, material(0.3f), 0.3f};
  const ClusterScattering s = trace_clusters(panel.shape, FiberMaterial(panel.material), 0.3f, 1, 400000, 1);
  EXPECT_NEAR(s.coverage, 1, 1e-3);
  const auto sine = kernel::m_sin(panel.theta_o), cosine = kernel::m_cos(panel.theta_o);
  const kernel::ScatterLobes l = kernel::scatter_prepare_marschner(make_fiber(panel.material, {}), sine, cosine);
  Vec3 traced[2]{}, expected[2]{};  // on the lit side, on the other
  for (std::size_t i = 0; i < s.energy.size(); ++i) {
    Vec3& side = traced[i >= s.energy.size() / 2];
    side = side + s.energy[i];
  }
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const float phi = 3.14159265f * (static_cast<float>(i) + 0.5f) / kSteps,
                  theta = 3.14159265f * ((static_cast<float>(j) + 0.5f) / kSteps - 0.5f);
      Vec3& side = expected[i >= kSteps / 2];
      side = side + kernel::scatter_marschner(l, std::sin(theta), std::cos(theta), std::cos(phi)) *
                        (std::cos(theta) * 2 * 3.14159265f * 3.14159265f / (kSteps * kSteps));
    }
  }
  for (int side = 0; side < 2; ++side) EXPECT_NEAR(traced[side].y, expected[side].y, 2e-3f) << side;
}

TEST(FiberCluster, TheSameForAnyNumberOfThreads) {
  const FiberMaterial m(material(0.5f));
  set_thread_count(1);
  const ClusterScattering one = trace_clusters({30, 1, 9, 9}, m, 0, 6, 100, 5);
  set_thread_count(4);
  const ClusterScattering four = trace_clusters({30, 1, 9, 9}, m, 0, 6, 100, 5);
  set_thread_count(0);
  EXPECT_EQ(one.energy, four.energy);
  EXPECT_EQ(one.counts, four.counts);
}

// Mean numbers of fibers on a ray: Buffon's is exact, the paper's is far too small where fibers are sparse.
TEST(FiberCluster, BuffonCountsCrossings) {
  for (const AggregatePanel& p : aggregate_panels()) {
    if (p.name.find("zhu.black.") != 0) continue;
    const ClusterScattering s = trace_clusters(p.shape, FiberMaterial(p.material), 0, 40, 400, 2);
    const double buffon = scatter_bundle_crossings(bundle_of(p.shape, AggregateModel::Crossings::kBuffon), -1),
                 huang = scatter_bundle_crossings(bundle_of(p.shape, AggregateModel::Crossings::kHuang), -1);
    EXPECT_NEAR(buffon, s.crossings, 0.01 * s.crossings) << p.name;
    EXPECT_LT(huang, 0.6 * s.crossings) << p.name;
    const kernel::ScatterBundle b = bundle_of(p.shape, AggregateModel::Crossings::kBuffon);
    EXPECT_NEAR(scatter_bundle_coverage(b), s.coverage, 0.05) << p.name;
    std::printf("%-24s crossings %.2f, Buffon %.2f, paper %.2f; coverage %.3f, ours %.3f\n", p.name.c_str(), s.crossings,
                buffon, huang, s.coverage, static_cast<double>(scatter_bundle_coverage(b)));
  }
}

// Closer to the truth than Zhu 2023 in every panel and every profile, whichever way that is read.
TEST(AggregateStudy, OursIsCloserThanZhu2023InEveryPanel) {
  const AggregateModel model = aggregate_models().front();
  ASSERT_EQ(model.kind, AggregateModel::Kind::kOurs);
  double worst = 0;
  for (const AggregatePanel& p : aggregate_panels()) {
    const AggregateProfiles truth =
        profiles_of(trace_clusters(p.shape, FiberMaterial(p.material), p.theta_o, 40, 800, 3).energy);
    const ProfileErrors ours = errors_of(profiles_of(model_energies(p, model)), truth), best = best_of_zhu_2023(p, truth);
    EXPECT_LT(ours.azimuth, best.azimuth) << p.name;
    EXPECT_LT(ours.lit, best.lit) << p.name;
    EXPECT_LT(ours.through, best.through) << p.name;
    worst = std::max({worst, ours.azimuth / best.azimuth, ours.lit / best.lit, ours.through / best.through});
  }
  std::printf("largest ratio of errors, ours over the best of Zhu 2023: %.2f\n", worst);
}

}  // namespace
}  // namespace pelage
