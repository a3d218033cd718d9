// What the tracer's models compute once, together, or not at all, against the formulas of kernel/scatter that they stand for.
#include "reference/fiber_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "core/rng.h"
#include "reference/fiber_models.h"

namespace pelage {
namespace {

using namespace kernel;

/// Materials and angles over the whole domain of the scene file.
struct Draw {
  HairMaterial material;
  float sin_o, cos_o, h;
  FiberAngles angles;
  Vec4 u;
};

Draw drawn(std::uint32_t i) {
  Rng rng(5, i);
  const auto range = [&](float lo, float hi) { return lo + (hi - lo) * rng.uniform(); };
  Draw d;
  d.material.eumelanin = range(0, 4), d.material.pheomelanin = range(0, 1), d.material.eta = range(1.2f, 2.2f);
  d.material.beta_longitudinal = range(0.03f, 0.6f), d.material.beta_azimuthal = range(0.05f, 1.2f);
  d.material.cuticle_tilt = range(0, 0.2f);
  const float theta_o = range(-1.57f, 1.57f), theta_i = range(-1.57f, 1.57f);
  d.sin_o = std::sin(theta_o), d.cos_o = std::cos(theta_o), d.h = range(-1, 1);
  d.angles = {std::sin(theta_i), std::cos(theta_i), range(-9, 9)};
  d.u = {rng.uniform(), rng.uniform(), rng.uniform(), rng.uniform()};
  return d;
}

void expect_same(ScatterDirection a, ScatterDirection b, std::uint32_t i) {
  ASSERT_EQ(a.lobe, b.lobe) << i;
  ASSERT_EQ(a.sin_i, b.sin_i) << i;
  ASSERT_EQ(a.cos_i, b.cos_i) << i;
  ASSERT_NEAR(a.phi, b.phi, 2e-6f) << i;
}

void expect_close(Vec3 a, Vec3 b, float share, std::uint32_t i) {
  for (const auto channel : {&Vec3::x, &Vec3::y, &Vec3::z})
    ASSERT_NEAR(a.*channel, b.*channel, share * (b.*channel) + 1e-7f) << i;
}

TEST(FiberModels, MarschnerTogetherIsMarschnerApart) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Draw d = drawn(i);
    const FiberMaterial material(d.material);
    const fiber_models::Marschner model({material, {}, d.sin_o, d.cos_o, d.h});
    const ScatterLobes lobes = scatter_prepare_marschner(make_fiber(d.material, {}), d.sin_o, d.cos_o);
    const ScatterChoice choice = scatter_choice_of(lobes);
    const FiberAngles a = d.angles;
    const FiberWeight w = model.weigh(a);
    expect_close(w.value, scatter_marschner(lobes, a.sin_i, a.cos_i, m_cos(a.phi)), 1e-5f, i);
    const float density = scatter_pdf_marschner(lobes, choice, a.sin_i, a.cos_i, a.phi);
    ASSERT_NEAR(w.density, density, 1e-5f * density) << i;
    expect_same(model.sample(d.u), scatter_sample_marschner(lobes, choice, d.u), i);
  }
}

TEST(FiberModels, ChiangTogetherIsChiangApart) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Draw d = drawn(i);
    const FiberMaterial material(d.material);
    const fiber_models::Chiang model({material, {}, d.sin_o, d.cos_o, d.h});
    const ScatterNear near = scatter_prepare_chiang(make_fiber(d.material, {}), d.sin_o, d.cos_o, d.h);
    const ScatterChoice choice = scatter_choice_chiang(near);
    const FiberAngles a = d.angles;
    const FiberWeight w = model.weigh(a);
    expect_close(w.value, scatter_chiang(near, a.sin_i, a.cos_i, a.phi), 1e-5f, i);
    const float density = scatter_pdf_chiang(near, choice, a.sin_i, a.cos_i, a.phi);
    ASSERT_NEAR(w.density, density, 1e-5f * density) << i;
    expect_same(model.sample(d.u), scatter_sample_chiang(near, choice, d.u), i);
  }
}

/// Share of a pair's energy that another has elsewhere.
float misplaced(const ScatterPair& a, const ScatterPair& b) {
  constexpr int kSteps = 180;
  float sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float phi = (static_cast<float>(i) + 0.5f) / kSteps * kPi, c = std::cos(phi), s = std::sin(phi);
    sum += std::fabs(scatter_pair_value(a, c, s, 0) - scatter_pair_value(b, c, s, 0));
  }
  return sum * kPi / kSteps;
}

TEST(MarschnerTable, IsWhatItTabulates) {
  float energy = 0, elsewhere = 0;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const ScatterFiber fiber = make_fiber(drawn(i).material, {});
    const MarschnerTable table(fiber);
    for (std::uint32_t k = 0; k < 1000; ++k) {
      const float theta = (static_cast<float>(k) + 0.5f) / 1000 * 3.14159265f - 1.57079633f, sin_o = std::sin(theta),
                  cos_o = std::cos(theta);
      const ScatterLobes exact = scatter_prepare_marschner(fiber, sin_o, cos_o), l = table.lobes(sin_o, cos_o);
      const auto worst = [](float& w, float a, float b) { w = std::max(w, std::fabs(a - b)); };
      worst(energy, l.a_r, exact.a_r);
      for (const auto c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        worst(energy, l.a_tt.*c, exact.a_tt.*c), worst(energy, l.a_trt.*c, exact.a_trt.*c);
        worst(energy, l.a_rest.*c, exact.a_rest.*c);
      }
      elsewhere = std::max({elsewhere, misplaced(completed(l.n_tt), exact.n_tt), misplaced(completed(l.n_trt), exact.n_trt)});
      ASSERT_EQ(l.tt.sin_o, exact.tt.sin_o);
      ASSERT_EQ(l.r.cos_o, exact.r.cos_o);
      ASSERT_EQ(l.trt.norm, exact.trt.norm);
    }
  }
  std::printf("largest error of an energy %.1e, largest share of a pair's elsewhere %.1e\n", static_cast<double>(energy),
              static_cast<double>(elsewhere));
  EXPECT_LE(energy, kMarschnerTableMaxAbsError);
  EXPECT_LE(elsewhere, kMarschnerTableMaxMisplaced);
}

}  // namespace
}  // namespace pelage
