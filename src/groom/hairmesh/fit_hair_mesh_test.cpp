// Fitting: splines back from their points, cages back from their strands, operators back from what they did.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh_fit.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/runtime.h>

#include <cmath>

#include "groom/hairmesh/cage.h"
#include "groom/hairmesh/layer_spline.h"
#include "kit/test_hair_mesh.h"

namespace pelage {
namespace {

using Kind = StyleOperator::Kind;

HairMeshFitSettings quick(std::uint32_t bundles) {
  HairMeshFitSettings s;
  s.bundles = bundles, s.layers = 6, s.styles = 1, s.sample = 4000, s.occlusion = false;
  return s;
}

const StyleOperator* find(const HairMesh& mesh, Kind kind) {
  for (const StyleOperator& o : mesh.styles.front())
    if (o.kind == kind) return &o;
  return nullptr;
}

TEST(LayerSpline, IsTheSplineOfExpand) {
  const HairMesh mesh = testing::small_hair_mesh({}, 1, 7, 3);
  const BundleCage cage(mesh, mesh.bundles.front());
  const LayerSpline spline(7, 64);
  const Vec3* column = &mesh.positions[mesh.column_offsets[cage.bundle->columns[0]]];
  for (std::uint32_t k = 0; k < 6; ++k)
    for (const float t : {0.f, 0.3f, 0.9f}) {
      const float* c = &cage.coefficients[k * BundleCage::kSpan];
      const Vec3 truth{c[0] + t * (c[3] + t * (c[6] + t * c[9])), c[1] + t * (c[4] + t * (c[7] + t * c[10])),
                       c[2] + t * (c[5] + t * (c[8] + t * c[11]))};
      EXPECT_LT(length(spline.at(column, (static_cast<float>(k) + t) / 6) - truth), 1e-6f) << k << " " << t;
    }
  const Vec3 end = spline.at(column, 1), slope = spline.derivative(column, 1);
  EXPECT_LT(length(spline.at(column, 1.5f) - (end + slope * 0.5f)), 1e-6f);
}

TEST(LayerSpline, ProjectionGivesItsVerticesBack) {
  for (const std::uint32_t layers : {2u, 3u, 10u, 64u}) {
    const LayerSpline spline(layers, 128);
    std::vector<Vec3> vertices, back(layers), points;
    for (std::uint32_t k = 0; k < layers; ++k) {
      const auto x = static_cast<float>(k);
      vertices.push_back({std::sin(x), 0.1f * x, std::cos(2 * x)});
    }
    for (int i = 0; i < 128; ++i) points.push_back(spline.at(vertices.data(), static_cast<float>(i) / 127));
    spline.project(points.data(), back.data());
    for (std::uint32_t k = 0; k < layers; ++k) EXPECT_LT(length(back[k] - vertices[k]), 1e-4f) << layers << " " << k;
  }
}

// One bundle, whose places are not known to the fit.
TEST(HairMeshFit, GivesACageBackFromItsStrands) {
  const HairMesh mesh = testing::small_hair_mesh({}, 1, 6, 2000);
  HairMeshFitReport report;
  const HairMesh fit = fit_hair_mesh(expand(mesh), quick(1), &report);
  EXPECT_EQ(strand_count(fit), 2000u);
  EXPECT_LT(report.base_rms, 1e-3);  // of 0.2 m
  EXPECT_GT(report.silhouette_overlap, 0.9);
}

// Clusters follow other borders than the bundles, and quads of a scalp do not lie in planes.
TEST(HairMeshFit, ComesNearToAStraightBobWithoutOperators) {
  HairMeshSettings bob;
  bob.strands = 6000, bob.occlusion = false;
  HairMesh mesh = make_hair_mesh(bob);
  for (auto& style : mesh.styles) style.clear();
  HairMeshFitReport few, many;
  HairMeshFitSettings s = quick(45);
  s.layers = 10;
  fit_hair_mesh(expand(mesh), s, &few);
  s.bundles = 180;
  const HairMesh fit = fit_hair_mesh(expand(mesh), s, &many);
  EXPECT_LT(few.base_rms, 2.5e-3);
  EXPECT_LT(many.base_rms, 1.2e-3);
  EXPECT_LT(many.fast_rms, 2e-4);
  EXPECT_EQ(strand_count(fit), 6000u);
}

TEST(HairMeshFit, FindsTheCurls) {
  for (const auto& [radius, turns] : {std::pair(0.004f, 7.f), std::pair(0.006f, 4.5f), std::pair(0.003f, 11.f)}) {
    const HairMesh mesh = testing::small_hair_mesh({{Kind::kCurl, radius, turns, 0, 1}}, 1, 6, 800);
    ExpandSettings fine;
    fine.points = 120;
    HairMeshFitReport report;
    const HairMesh fit = fit_hair_mesh(expand(mesh, fine), quick(1), &report);
    const StyleOperator* curl = find(fit, Kind::kCurl);
    ASSERT_NE(curl, nullptr) << turns;
    EXPECT_NEAR(curl->amount, radius, 0.15f * radius);
    EXPECT_NEAR(curl->frequency, turns, 0.08f * turns);
    EXPECT_GT(curl->variation, 0.7f);
    EXPECT_NEAR(report.operator_rms, report.base_rms, 0.2 * report.base_rms);
  }
}

TEST(HairMeshFit, TellsWavesFromCurlsAndFrizz) {
  ExpandSettings fine;
  fine.points = 120;
  const auto fitted = [&](StyleOperator o) {
    return fit_hair_mesh(expand(testing::small_hair_mesh({o}, 1, 6, 800), fine), quick(1));
  };
  const HairMesh waves = fitted({Kind::kWave, 0.004f, 6, 0, 1});
  ASSERT_NE(find(waves, Kind::kWave), nullptr);
  EXPECT_NEAR(find(waves, Kind::kWave)->amount, 0.004f, 0.0008f);
  EXPECT_NEAR(find(waves, Kind::kWave)->frequency, 6, 0.5f);
  EXPECT_EQ(find(waves, Kind::kCurl), nullptr);
  const HairMesh frizz = fitted({Kind::kFrizz, 0.003f, 10, 0, 0});
  ASSERT_NE(find(frizz, Kind::kFrizz), nullptr);
  EXPECT_NEAR(find(frizz, Kind::kFrizz)->amount, 0.003f, 0.0008f);
  EXPECT_EQ(find(frizz, Kind::kCurl), nullptr);
}

TEST(HairMeshFit, FindsClumpsLengthsAndTaper) {
  const HairMesh mesh = testing::small_hair_mesh(
      {{Kind::kLength, 1, 0, 0, 0.3f}, {Kind::kClump, 0.7f, 4, 0, 0}, {Kind::kTaper, 0.4f, 0, 0.3f, 0}}, 1, 6, 3000);
  const HairMesh fit = fit_hair_mesh(expand(mesh), quick(1));
  ASSERT_NE(find(fit, Kind::kLength), nullptr);
  EXPECT_NEAR(find(fit, Kind::kLength)->variation, 0.3f, 0.08f);
  ASSERT_NE(find(fit, Kind::kClump), nullptr);
  EXPECT_NEAR(find(fit, Kind::kClump)->amount, 0.7f, 0.25f);
  EXPECT_NEAR(find(fit, Kind::kClump)->frequency, 4, 2);
  ASSERT_NE(find(fit, Kind::kTaper), nullptr);
  EXPECT_NEAR(find(fit, Kind::kTaper)->amount, 0.4f, 0.02f);
  EXPECT_NEAR(find(fit, Kind::kTaper)->start, 0.3f, 0.11f);
  EXPECT_NEAR(fit.width, mesh.width, 1e-6f);
}

TEST(HairMeshFit, IsTheSameForAnyNumberOfThreads) {
  GrowSettings hair = grow_defaults(HairStyle::kCurly);
  hair.strands = 600, hair.points = 32;
  const StrandSet strands = grow(hair, mannequin_head());
  HairMeshFitSettings s = quick(12);
  s.styles = 3;
  set_thread_count(1);
  const HairMesh one = fit_hair_mesh(strands, s);
  set_thread_count(3);
  const HairMesh three = fit_hair_mesh(strands, s);
  set_thread_count(0);
  ASSERT_EQ(one.positions.size(), three.positions.size());
  EXPECT_TRUE(one.positions == three.positions);
  ASSERT_EQ(one.styles.size(), three.styles.size());
  for (std::size_t i = 0; i < one.styles.size(); ++i) {
    ASSERT_EQ(one.styles[i].size(), three.styles[i].size());
    for (std::size_t k = 0; k < one.styles[i].size(); ++k) {
      EXPECT_EQ(one.styles[i][k].amount, three.styles[i][k].amount);
      EXPECT_EQ(one.styles[i][k].variation, three.styles[i][k].variation);
    }
  }
}

TEST(HairMeshFit, ASampleStandsForTheGroom) {
  const StrandSet strands = expand(testing::small_hair_mesh({{Kind::kCurl, 0.004f, 7, 0, 1}}, 2, 6, 1001));
  HairMeshFitSettings s = quick(7);
  HairMeshFitReport all, some;
  s.sample = 10000;
  fit_hair_mesh(strands, s, &all);
  s.sample = 777;
  EXPECT_EQ(strand_count(fit_hair_mesh(strands, s, &some)), 4004u);
  EXPECT_EQ(some.sampled, 777u);
  EXPECT_NEAR(some.base_rms, all.base_rms, 0.1 * all.base_rms);
  EXPECT_NEAR(some.operator_rms, all.operator_rms, 0.15 * all.operator_rms);
}

// One strand, two of the same, a few of which some have no length.
TEST(HairMeshFit, TakesHardlyAnyHair) {
  StrandSet set;
  set.basis = CurveBasis::kLinear;
  set.widths = {1e-4f};
  set.offsets = {0};
  for (int s = 0; s < 5; ++s) {
    for (int i = 0; i < 4; ++i) set.points.push_back({s < 2 ? 0.f : 0.01f, s == 4 ? 0.f : 0.05f * static_cast<float>(i), 0});
    set.offsets.push_back(static_cast<std::uint32_t>(set.points.size()));
    HairMeshFitReport report;
    const HairMesh mesh = fit_hair_mesh(set, quick(20), &report);
    EXPECT_EQ(strand_count(mesh), static_cast<std::uint64_t>(s) + 1);
    EXPECT_LT(report.base_rms, 1e-4);
  }
}

TEST(HairMeshFit, WhatIsWrongIsNamed) {
  const StrandSet strands = expand(testing::small_hair_mesh({}, 1, 3, 4));
  const auto problem = [&](const StrandSet& set, const HairMeshFitSettings& s) -> std::string {
    try {
      fit_hair_mesh(set, s);
    } catch (const Error& e) {
      return e.what();
    }
    return "nothing";
  };
  using ::testing::HasSubstr;
  HairMeshFitSettings s;
  s.bundles = 65537;
  EXPECT_THAT(problem(strands, s), HasSubstr("bundles"));
  s = {}, s.bundles = 60000, s.layers = 64;
  EXPECT_THAT(problem(strands, s), HasSubstr("bundles"));
  s = {}, s.layers = 1;
  EXPECT_THAT(problem(strands, s), HasSubstr("layers"));
  s = {}, s.layers = 65;
  EXPECT_THAT(problem(strands, s), HasSubstr("layers"));
  s = {}, s.bytes = 999;
  EXPECT_THAT(problem(strands, s), HasSubstr("bytes"));
  s = {}, s.styles = 0;
  EXPECT_THAT(problem(strands, s), HasSubstr("styles"));
  s = {}, s.sample = 0;
  EXPECT_THAT(problem(strands, s), HasSubstr("sample"));
  StrandSet none;
  none.offsets = {0}, none.widths = {1e-4f};
  EXPECT_THAT(problem(none, {}), HasSubstr("no strands"));
  StrandSet points = strands;
  for (Vec3& p : points.points) p = {};
  EXPECT_THAT(problem(points, {}), HasSubstr("length"));
}

}  // namespace
}  // namespace pelage
