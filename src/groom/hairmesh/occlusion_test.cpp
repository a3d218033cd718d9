// Baked occlusion against rays cast through the strands themselves.
#include <gtest/gtest.h>
#include <pelage/hair_mesh_styles.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "kit/test_hair_mesh.h"

namespace pelage {
namespace {

using Kind = StyleOperator::Kind;

/// Whether the ray from `o` along the unit vector `d` comes nearer than `radius` to the segment a … b.
bool hits(Vec3 o, Vec3 d, Vec3 a, Vec3 b, float radius) {
  // Seen along the ray: the distance of the origin from the segment's projection, if that place is ahead.
  const Vec3 ao = a - o, e = b - a;
  const Vec3 a2 = ao - d * dot(ao, d), e2 = e - d * dot(e, d);
  const float t = std::clamp(-dot(a2, e2) / std::max(dot(e2, e2), 1e-20f), 0.f, 1.f);
  return dot(ao + e * t, d) > 0 && length(a2 + e2 * t) < radius;
}

/// Share of random directions in which nothing is in the way.
float cast(const StrandSet& set, Vec3 from, std::uint32_t rays) {
  std::uint32_t open = 0;
  Rng rng(3, 0);
  for (std::uint32_t i = 0; i < rays; ++i) {
    const float z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z), angle = 6.2831853f * rng.uniform();
    const Vec3 d(r * std::cos(angle), r * std::sin(angle), z);
    bool hit = false;
    for (std::size_t s = 0; s < set.strand_count() && !hit; ++s)
      for (std::uint32_t k = set.offsets[s]; k + 1 < set.offsets[s + 1] && !hit; ++k)
        hit = hits(from, d, set.points[k], set.points[k + 1], 0.5f * set.widths[k]);
    open += !hit;
  }
  return static_cast<float>(open) / static_cast<float>(rays);
}

// Strands that are wide enough for the eye to count them, with and without order.
TEST(Occlusion, IsWhatRaysThroughTheStrandsFind) {
  const std::vector<std::vector<StyleOperator>> styles{{}, {{Kind::kNoise, 0.03f, 9, 0, 1}, {Kind::kFrizz, 0.03f, 9, 0, 0.2f}}};
  for (const auto& style : styles) {
    HairMesh mesh = testing::small_hair_mesh(style, 3, 4, 260);
    mesh.width = 4e-4f;
    const StrandSet set = expand(mesh, {.points = 48});
    bake_occlusion(mesh);
    double error = 0, bias = 0;
    std::size_t vertices = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); v += 3, ++vertices) {
      const double d = static_cast<double>(mesh.occlusion[v] - cast(set, mesh.positions[v], 250));
      error += std::abs(d), bias += d;
      EXPECT_LT(std::abs(d), 0.17) << "vertex " << v;
    }
    const double n = static_cast<double>(vertices);
    EXPECT_LT(error / n, 0.05);
    EXPECT_LT(std::abs(bias) / n, 0.025);
    const auto [least, most] = std::minmax_element(mesh.occlusion.begin(), mesh.occlusion.end());
    EXPECT_LT(*least, 0.4f);  // so that there is something to get right
    EXPECT_GT(*most, 0.6f);
  }
}

TEST(Occlusion, MoreHairLetsLessThrough) {
  HairMesh thin = testing::small_hair_mesh({}), thick = thin;
  for (HairMesh::Bundle& b : thick.bundles) b.strands *= 20;
  bake_occlusion(thin), bake_occlusion(thick);
  for (std::size_t v = 0; v < thin.vertex_count(); ++v) EXPECT_LT(thick.occlusion[v], thin.occlusion[v]);
}

// The strands that are sampled stand for all of them.
TEST(Occlusion, DoesNotDependOnTheSample) {
  HairMesh few = testing::small_hair_mesh({}, 2, 5, 10000), many = few;
  for (HairMesh::Bundle& b : many.bundles) b.strands *= 16;
  few.width = 8e-5f, many.width = 8e-5f / 16;
  bake_occlusion(few), bake_occlusion(many);
  for (std::size_t v = 0; v < few.vertex_count(); ++v) EXPECT_NEAR(few.occlusion[v], many.occlusion[v], 0.01f);
}

TEST(Occlusion, NoWidthIsNoShade) {
  HairMesh mesh = testing::small_hair_mesh({});
  mesh.width = 0;
  bake_occlusion(mesh);
  for (const float x : mesh.occlusion) EXPECT_EQ(x, 1);
}

}  // namespace
}  // namespace pelage
