// The prefiltered environment against sums over the sky, and the octahedron that it stands on.
#include "light/probe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/rng.h"
#include "frame/environment_map.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

Vec3 random_direction(std::uint32_t i) {
  Rng rng(21, i);
  const float z = 2 * rng.uniform() - 1, around = 6.2831853f * rng.uniform(), r = std::sqrt(std::max(0.f, 1 - z * z));
  return {r * std::cos(around), r * std::sin(around), z};
}

/// A dim sky with a small sun and a warm ground.
Environment sunny() {
  auto map = std::make_shared<Image>();
  *map = Image(256, 128, {"R", "G", "B"}), map->pixels.clear();
  for (int y = 0; y < map->height; ++y)
    for (int x = 0; x < map->width; ++x) {
      const bool sun = x > 60 && x < 68 && y > 30 && y<36, ground = y> 70;
      map->pixels.insert(map->pixels.end(), {sun      ? 200.f
                                             : ground ? 0.3f
                                                      : 0.2f,
                                             sun ? 180.f : 0.2f,
                                             sun      ? 150.f
                                             : ground ? 0.1f
                                                      : 0.6f});
    }
  Environment e;
  e.radiance = {1, 1, 1}, e.map = map, e.rotation = 0.7f;
  return e;
}

/// The same by a sum over every texel of the map itself, in double.
Vec3 summed(const Environment& e, Vec3 axis, float alpha) {
  double weight = 0, sum[3] = {};
  for (int y = 0; y < e.map->height; ++y) {
    const double v = (y + 0.5) / e.map->height, area = std::sin(v * std::numbers::pi);
    for (int x = 0; x < e.map->width; ++x) {
      const double u = (x + 0.5) / e.map->width;
      const double cosine = static_cast<double>(dot(axis, map_direction(e, static_cast<float>(u), static_cast<float>(v))));
      const double half = (1 + cosine) / 2, a2 = static_cast<double>(alpha * alpha), d = half * (a2 - 1) + 1;
      const double w = std::max(cosine, 0.) * a2 / (d * d) * area;
      const Vec3 radiance = map_value(*e.map, x, y);
      weight += w, sum[0] += w * static_cast<double>(radiance.x), sum[1] += w * static_cast<double>(radiance.y),
          sum[2] += w * static_cast<double>(radiance.z);
    }
  }
  return Vec3(static_cast<float>(sum[0] / weight), static_cast<float>(sum[1] / weight), static_cast<float>(sum[2] / weight));
}

TEST(Probe, OctahedronComesBack) {
  for (std::uint32_t i = 0; i < 10000; ++i) {
    const Vec3 d = random_direction(i);
    const Vec2 place = kernel::light_octahedral(d);
    ASSERT_TRUE(place.x >= 0 && place.x <= 1 && place.y >= 0 && place.y <= 1);
    EXPECT_NEAR(length(kernel::light_octahedral_direction(place) - d), 0, 2e-6f);
  }
}

// The edges are glued to themselves, turned around their middles: a step beyond one is a step inside at its other half.
TEST(Probe, OctahedronGoesOnBeyondItsEdges) {
  const auto expect_same = [](Vec2 out, Vec2 in) {
    EXPECT_NEAR(length(kernel::light_octahedral_direction(out) - kernel::light_octahedral_direction(in)), 0, 1e-5f)
        << out.x << " " << out.y;
  };
  for (float t = 0.01f; t < 1; t += 0.0137f) {
    for (const float step : {0.f, 0.004f, 0.02f}) {
      expect_same({-step, t}, {step, 1 - t}), expect_same({1 + step, t}, {1 - step, 1 - t});
      expect_same({t, -step}, {1 - t, step}), expect_same({t, 1 + step}, {1 - t, 1 - step});
    }
  }
  for (const Vec2 corner : {Vec2(-0.01f, -0.01f), Vec2(1.01f, -0.01f), Vec2(-0.01f, 1.01f), Vec2(1.01f, 1.01f)})
    EXPECT_LT(kernel::light_octahedral_direction(corner).z, -0.99f);
}

TEST(Probe, LevelsAndRoughnessesAreInverse) {
  for (float level = 0; level <= kernel::kProbeLevels - 1; level += 0.25f)
    EXPECT_NEAR(kernel::light_probe_level(kernel::light_probe_alpha(level)), level, 1e-4f);
  EXPECT_NEAR(kernel::light_probe_alpha(0), 0.2f, 1e-6f);
  EXPECT_NEAR(kernel::light_probe_alpha(kernel::kProbeLevels - 1), 1, 1e-6f);
  EXPECT_EQ(kernel::light_probe_level(0), 0);
  EXPECT_EQ(kernel::light_probe_level(2), kernel::kProbeLevels - 1);
}

TEST(Probe, AnEvenSkyIsExact) {
  Environment e;
  e.radiance = {0.5f, 1, 2};
  const EnvironmentProbe constant = make_probe(e);
  auto map = std::make_shared<Image>();
  *map = Image(64, 32, {"R", "G", "B"}), map->pixels.assign(map->pixels.size(), 1.f);
  e.map = map;
  const EnvironmentProbe mapped = make_probe(e);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec3 d = random_direction(i);
    for (const float alpha : {0.f, 0.13f, 0.5f, 1.f}) {
      EXPECT_NEAR(probe_radiance(constant, d, alpha).z, 2, 1e-5f);
      EXPECT_NEAR(probe_radiance(mapped, d, alpha).x, 0.5f, 1e-4f);
      EXPECT_NEAR(probe_radiance(mapped, d, alpha).z, 2, 4e-4f);
    }
  }
}

TEST(Probe, EqualsSumsOverTheSky) {
  const Environment e = sunny();
  const EnvironmentProbe probe = make_probe(e);
  double worst = 0;
  for (const float alpha : {0.2f, 0.22f, 0.3f, 0.55f, 0.8f, 1.f}) {
    double largest = 0, error = 0;
    for (std::uint32_t i = 0; i < 150; ++i) {
      const Vec3 d = random_direction(i), expected = summed(e, d, alpha), got = probe_radiance(probe, d, alpha);
      largest = std::max(largest, static_cast<double>(expected.y));
      error = std::max(
          {error, std::fabs(static_cast<double>(got.x - expected.x)), std::fabs(static_cast<double>(got.y - expected.y))});
    }
    const Vec3 sun = map_direction(e, 64.5f / 256, 33.f / 128);
    largest = std::max(largest, static_cast<double>(summed(e, sun, alpha).y));
    error = std::max(error, std::fabs(static_cast<double>(summed(e, sun, alpha).y - probe_radiance(probe, sun, alpha).y)));
    EXPECT_LE(error / largest, static_cast<double>(kernel::kProbeMaxRelError)) << alpha;
    worst = std::max(worst, error / largest);
  }
  std::printf("probe: worst error %.4f of the brightest\n", worst);
}

}  // namespace
}  // namespace pelage
