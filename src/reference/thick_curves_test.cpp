#include "reference/thick_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/rng.h"
#include "kernel/scalar.h"
#include "kit/thick_kit.h"

namespace pelage {
namespace {

/// A straight hair along y, so long that no ray meets its ends.
ThickCurves straight_hair(const kit::Bundle& bundle) { return ThickCurves(kit::thick_hair({{0, -1, 0}, {0, 1, 0}}, bundle)); }

std::optional<float> meet_any(const ThickCurves& hair, const Ray& ray, std::uint32_t seed) {
  std::optional<float> nearest;
  for (std::size_t piece = 0; piece < hair.piece_count(); ++piece) {
    const float u = uniform_from_bits(pcg4d(seed, static_cast<std::uint32_t>(piece), 7, 9).x);
    const std::optional<float> met = hair.meet(piece, ray, u);
    if (met && (!nearest || *met < *nearest)) nearest = met;
  }
  return nearest;
}

/// Share of the width of a bundle that rays inclined by theta meet, seen from azimuth phi.
double met_share(const ThickCurves& hair, float half_width, float theta, float phi, int rays) {
  const Vec3 across(std::cos(phi), 0, -std::sin(phi)),
      view(std::sin(phi) * std::cos(theta), std::sin(theta), std::cos(phi) * std::cos(theta));
  int met = 0;
  for (int i = 0; i < rays; ++i) {
    const float h = 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(rays) - 1;
    met +=
        meet_any(hair, {across * (h * half_width) + Vec3(0, 0.25f, 0) - view, view}, static_cast<std::uint32_t>(i)).has_value();
  }
  return static_cast<double>(met) / rays;
}

// Bundles of any number of fibers cover what fibers cover that are laid out at random, one fiber all of itself, from any inclination.
TEST(ThickCurves, CoversWhatItsFibersCover) {
  for (const float fibers : {1.f, 2.f, 5.f, 40.f}) {
    const float radius = fibers == 1 ? 0.01f : 0.001f;
    const ThickCurves hair = straight_hair({{0.01f, 0, 0}, {0, 0, 0.01f}, fibers, radius});
    int covered = 0;
    constexpr int kTrials = 40000;
    for (int i = 0; i < kTrials; ++i) {
      Rng rng(3, static_cast<std::uint32_t>(i));
      const float y = 0.01f * (2 * rng.uniform() - 1);
      bool met = false;
      for (int k = 0; k < static_cast<int>(fibers); ++k) {
        const float r = (0.01f - radius) * std::sqrt(rng.uniform()), at = r * std::cos(6.2831853f * rng.uniform());
        met = met || std::fabs(at - y) <= radius;
      }
      covered += met;
    }
    const double expected = static_cast<double>(covered) / kTrials, sigma = std::sqrt(0.25 / kTrials);
    for (const float theta : {0.f, 0.7f})
      EXPECT_NEAR(met_share(hair, 0.01f, theta, 0.4f, kTrials), expected, 5 * sigma) << fibers << " fibers, theta " << theta;
  }
}

// Of many thin fibers it is the coverage of the derivation, from the wide and from the narrow side.
TEST(ThickCurves, CoverageOfManyFibersIsTheBundles) {
  const kit::Bundle bundle{{0.02f, 0, 0}, {0, 0, 0.005f}, 400, 2e-5f};
  const ThickCurves hair = straight_hair(bundle);
  for (const float phi : {0.f, std::numbers::pi_v<float> / 2}) {
    const float wide = phi == 0 ? 0.02f : 0.005f, deep = phi == 0 ? 0.005f : 0.02f;
    const float expected =
        kernel::scatter_bundle_coverage(kernel::scatter_bundle_buffon(bundle.fibers, bundle.radius, wide, deep));
    EXPECT_NEAR(met_share(hair, wide, 0.3f, phi, 40000), static_cast<double>(expected), 0.012) << phi;
  }
}

// The first fiber is as deep in the bundle as fibers lie: halfway through, half of the chances are used up.
TEST(ThickCurves, FibersLieEvenlyAlongTheWay) {
  const ThickCurves hair = straight_hair({{0.01f, 0, 0}, {0, 0, 0.01f}, 1, 1e-4f});
  double sum = 0;
  int met = 0;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const std::optional<float> at = meet_any(hair, {{0.004f, 0.1f, 1}, {0, 0, -1}}, i);
    if (!at) continue;
    sum += static_cast<double>(*at), ++met;
  }
  ASSERT_GT(met, 500);
  EXPECT_NEAR(sum / met, 1, 0.01 / std::sqrt(met) * 4);
}

// What a ray leaves lies behind it: from there on no fiber of a straight hair is on its way, and it is at the hull.
TEST(ThickCurves, TheWayOutEndsAtTheHull) {
  const kit::Bundle bundle{{0.02f, 0, 0.003f}, {0, 0, 0.005f}, 50, 1e-3f};
  const ThickCurves hair(kit::thick_hair({{0, -1, 0}, {0, -0.3f, 0}, {0, 0.1f, 0}, {0, 1, 0}}, bundle));
  int tried = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Rng rng(4, i);
    const auto direction = [&] { return normalize(Vec3(rng.normal(), 0.5f * rng.normal(), rng.normal())); };
    const Vec3 view = direction(), from = Vec3(0.01f * rng.normal(), 0.2f * rng.normal(), 0.003f * rng.normal()) - view;
    for (std::size_t piece = 0; piece < hair.piece_count(); ++piece) {
      const std::optional<float> met = hair.meet(piece, {from, view}, 0.1f);
      if (!met) continue;
      const Vec3 origin = from + view * *met, onward = direction();
      const float out = hair.way_out(piece, origin, onward);
      const Vec3 p = origin + onward * out;
      if (std::fabs(p.y) > 0.9f) continue;
      const float x = p.x / 0.02f, y = (p.z - x * 0.003f) / 0.005f;
      EXPECT_NEAR(x * x + y * y, 1, 2e-3f) << i;
      for (std::size_t other = 0; other < hair.piece_count(); ++other)
        EXPECT_FALSE(hair.meet(other, {origin, onward, out}, 0)) << i;
      ++tried;
    }
  }
  EXPECT_GT(tried, 300);
}

// In a bent hair no place is in two pieces and none in between is left out: however a ray is cut by pieces, the
// chance to pass all of them is what one chord as long would give.
TEST(ThickCurves, PiecesOfABendDivideIt) {
  std::vector<Vec3> arc;
  for (int i = 0; i <= 12; ++i)
    arc.push_back({0.1f * std::cos(0.1f * static_cast<float>(i)), 0.1f * std::sin(0.1f * static_cast<float>(i)), 0});
  const ThickCurves hair(kit::thick_hair(arc, {{0, 0, 0.01f}, {0.01f, 0, 0}, 1000, 1e-5f}, true));
  // Along a chord of the arc, through the tube: steps of equal length are inside one piece or none.
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const float t = static_cast<float>(i) / 2000, a = 0.25f + 0.7f * t;
    const Vec3 p(0.1f * std::cos(a), 0.1f * std::sin(a), 0.004f);
    const Vec3 v = normalize(Vec3(0.3f, -0.2f, 0.9f));
    int in = 0;
    for (std::size_t piece = 0; piece < hair.piece_count(); ++piece) in += hair.meet(piece, {p, v, 0, 1e-5f}, 0).has_value();
    EXPECT_GE(in, 1) << i;
    inside += in;
  }
  EXPECT_LE(inside, 2000 + 48);  // a step may reach across the plane between two
}

TEST(ThickCurves, BoundsHoldEveryMeeting) {
  const ThickCurves hair(kit::thick_hair({{0, 0, 0}, {0.05f, 0.05f, 0}, {0.1f, 0, 0.03f}, {0.1f, -0.1f, 0}},
                                         {{0, 0, 0.02f}, {0.003f, 0.003f, 0}, 20, 1e-3f}));
  for (std::uint32_t i = 0; i < 4000; ++i) {
    Rng rng(8, i);
    const Vec3 view = normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
    const Vec3 from = Vec3(0.1f * rng.uniform(), 0.15f * rng.uniform() - 0.1f, 0.05f * rng.uniform()) - view;
    for (std::size_t piece = 0; piece < hair.piece_count(); ++piece) {
      const std::optional<float> met = hair.meet(piece, {from, view}, 0.01f * rng.uniform());
      if (!met) continue;
      const Vec3 p = from + view * *met;
      const Bounds b = hair.bounds(piece);
      EXPECT_TRUE(p.x >= b.lower.x && p.y >= b.lower.y && p.z >= b.lower.z && p.x <= b.upper.x && p.y <= b.upper.y &&
                  p.z <= b.upper.z);
    }
  }
}

TEST(ThickCurves, SectionsWithoutWidthAreNotMet) {
  const ThickCurves hair = straight_hair({{0, 0, 0}, {0, 0, 0}, 3, 0});
  EXPECT_FALSE(meet_any(hair, {{0, 0, 1}, {0, 0, -1}}, 1));
}

}  // namespace
}  // namespace pelage
