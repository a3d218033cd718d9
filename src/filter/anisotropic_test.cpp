// The orientation-aware filter against its definition, and the matte around it.
#include "filter/anisotropic.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "filter/anisotropic_rows.h"

namespace pelage {
namespace {

Matte random_matte(int width, int height, float hair, std::uint32_t seed = 1) {
  Matte m;
  m.resize(width, height, false);
  Rng rng(4, seed);
  for (std::size_t p = 0; p < m.r.size(); ++p) {
    const bool here = rng.uniform() < hair;
    const float alpha = here ? rng.uniform() : 0, angle = 6.2832f * rng.uniform();
    m.alpha[p] = alpha, m.r[p] = alpha * rng.uniform(), m.g[p] = alpha * 2 * rng.uniform(), m.b[p] = alpha * rng.uniform();
    m.tangent_x[p] = here ? std::cos(angle) : 0, m.tangent_y[p] = here ? std::sin(angle) : 0;
  }
  return m;
}

double inverse_square(float sigma) {
  return std::isinf(sigma) ? 0 : 1 / (static_cast<double>(sigma) * static_cast<double>(sigma));
}

/// Eq. 11 and 12 of Huang 2025 and eq. 9 of Lipp 2026, pixel by pixel, in double precision.
double filtered_green(const Matte& m, const AnisotropicKernel& k, int x, int y) {
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * m.width + i); };
  const auto tangent = [&](std::size_t p) { return Vec2(m.tangent_x[p], m.tangent_y[p]); };
  const std::size_t p = at(x, y);
  if (tangent(p) == Vec2()) return 0;
  double sum = 0, weights = 0;
  const double r = std::max(0.5, static_cast<double>(k.radius)), minor = std::max(0.5, r * static_cast<double>(k.aspect));
  for (int j = 0; j < m.height; ++j)
    for (int i = 0; i < m.width; ++i) {
      const std::size_t q = at(i, j);
      if (tangent(q) == Vec2() || std::abs(i - x) > static_cast<int>(r) || std::abs(j - y) > static_cast<int>(r)) continue;
      const double dx = i - x, dy = j - y, tx = static_cast<double>(m.tangent_x[p]), ty = static_cast<double>(m.tangent_y[p]);
      const double along = dx * tx + dy * ty, across = dx * ty - dy * tx;
      if (along * along / (r * r) + across * across / (minor * minor) > 1) continue;
      const double theta = dx == 0 && dy == 0 ? 0 : std::acos(std::min(1.0, std::abs(along) / std::hypot(dx, dy)));
      double color = 0;
      for (const auto plane : {&Matte::r, &Matte::g, &Matte::b})
        color += std::pow(static_cast<double>((m.*plane)[q]) - static_cast<double>((m.*plane)[p]), 2);
      const double w =
          std::exp(-(dx * dx + dy * dy) / (r * r) * inverse_square(k.sigma_distance) -
                   theta * theta * inverse_square(k.sigma_angle) - color * inverse_square(k.sigma_color) -
                   along * along * inverse_square(k.sigma_along) / 2 - across * across * inverse_square(k.sigma_across) / 2);
      sum += w * static_cast<double>(m.g[q]), weights += w;
    }
  return sum / weights;
}

AnisotropicKernel kernel(float radius, float aspect, float distance = INFINITY, float angle = INFINITY, float color = INFINITY,
                         float along = INFINITY, float across = INFINITY) {
  return {radius, aspect, distance, angle, color, along, across};
}

TEST(Anisotropic, IsItsDefinition) {
  for (const AnisotropicKernel& k :
       {kernel(3.1f, 0.4f), kernel(4.5f, 0.2f, 0.5f), kernel(3.3f, 1, 0.7f, 0.4f), kernel(4.3f, 0.5f, 0.6f, 0.3f, 0.9f),
        kernel(5.2f, 0.6f, INFINITY, INFINITY, INFINITY, 2, 0.7f), kernel(0, 0.3f), kernel(0.9f, 1, 0.1f, 0.1f, 0.9f)})
    for (const float hair : {0.2f, 1.f}) {
      const Matte m = random_matte(23, 19, hair);
      const Matte out = filter_anisotropic(m, k);
      for (int y = 0; y < m.height; ++y)
        for (int x = 0; x < m.width; ++x)
          EXPECT_NEAR(static_cast<double>(out.g[static_cast<std::size_t>(y * 23 + x)]), filtered_green(m, k, x, y), 2e-5)
              << x << " " << y << " r " << k.radius;
    }
}

TEST(Anisotropic, WideRowsAreTheScalarOnes) {
  const int reach = 3;
  FilterPlanes planes;
  planes.width = 37, planes.height = 3, planes.reach = reach, planes.stride = 37 + 2 * reach + FilterPlanes::kPadding;
  Rng rng(2, 2);
  Buffer<float>* const all[] = {&planes.r,         &planes.g,         &planes.b,     &planes.alpha,
                                &planes.tangent_x, &planes.tangent_y, &planes.weight};
  for (Buffer<float>* plane : all) plane->resize(planes.stride * (3 + 2 * reach)), plane->fill(0);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 37; ++x) {
      const std::size_t p = planes.at(x, y);
      if (rng.uniform() < 0.3f) continue;
      const float angle = 6 * rng.uniform();
      planes.tangent_x[p] = std::cos(angle), planes.tangent_y[p] = std::sin(angle), planes.weight[p] = 1;
      planes.r[p] = rng.uniform(), planes.g[p] = rng.uniform(), planes.b[p] = rng.uniform(), planes.alpha[p] = rng.uniform();
    }
  for (const AnisotropicKernel& k :
       {kernel(3, 0.4f), kernel(3, 0.7f, 0.6f, INFINITY, 0.5f), kernel(3, 0.7f, 0.6f, 0.3f, 0.5f)}) {
    Buffer<float> slow[4], fast[4];
    for (int c = 0; c < 4; ++c) slow[c].resize(37 + 64), fast[c].resize(37 + 64);
    filter_row_scalar(planes, k, 1, {slow[0].data(), slow[1].data(), slow[2].data(), slow[3].data()});
    for (const std::string& isa : available_isas()) {
      set_isa(isa);
      filter_row(planes, k, 1, {fast[0].data(), fast[1].data(), fast[2].data(), fast[3].data()});
      for (int c = 0; c < 4; ++c) EXPECT_EQ(std::memcmp(slow[c].data(), fast[c].data(), 37 * sizeof(float)), 0) << isa;
    }
    set_isa("");
  }
}

// What is the same everywhere stays as it is: hair of one color and opacity, whatever its directions.
TEST(Anisotropic, LeavesUniformHairAlone) {
  Matte m = random_matte(40, 30, 1);
  m.r.fill(0.3f), m.g.fill(0.2f), m.b.fill(0.1f), m.alpha.fill(0.5f);
  const Matte out = filter_anisotropic(m, kernel(6, 0.3f, 0.5f, 0.5f, 0.9f));
  for (std::size_t p = 0; p < m.r.size(); ++p) {
    EXPECT_NEAR(out.r[p], 0.3f, 1e-6f);
    EXPECT_NEAR(out.alpha[p], 0.5f, 1e-6f);
  }
}

TEST(Anisotropic, SmoothsAlongAndNotAcross) {
  Matte m;
  m.resize(31, 31, false);
  for (Buffer<float>* plane : {&m.r, &m.g, &m.b, &m.alpha, &m.tangent_y}) plane->fill(0);
  m.tangent_x.fill(1);
  m.g[15 * 31 + 15] = 1;
  const Matte out = filter_anisotropic(m, kernel(5, 0.1f));
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 31; ++x)
      EXPECT_NEAR(out.g[static_cast<std::size_t>(y * 31 + x)], y == 15 && std::abs(x - 15) <= 5 ? 1 / 11.f : 0, 1e-6f);
}

TEST(Anisotropic, TakesOddSizesAndEmptyPictures) {
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 40}, std::pair{67, 1}, std::pair{17, 9}})
    for (const float hair : {0.f, 0.5f, 1.f}) {
      const Matte m = random_matte(w, h, hair);
      const Matte out = filter_anisotropic(m, kernel(4, 0.5f));
      for (std::size_t p = 0; p < m.r.size(); ++p) EXPECT_TRUE(out.r[p] >= 0 && out.alpha[p] <= 1);
    }
}

TEST(Anisotropic, SizeOfTheKernelIsThatOfTheHair) {
  Matte m = random_matte(100, 50, 0);
  EXPECT_EQ(kernel_for(m, {}).radius, 0.f);
  m.tangent_x[10 * 100 + 20] = 1, m.tangent_x[34 * 100 + 83] = 1;
  LinkSettings s;
  s.kernel_size = 0.1f;
  EXPECT_NEAR(kernel_for(m, s).radius, 0.1f * 40, 1e-5f);  // √(64 · 25)
  s.kernel_size = 1e6f;
  EXPECT_EQ(kernel_for(m, s).radius, AnisotropicKernel::kMostRadius);
}

TEST(MeanDirection, HasNoSign) {
  MeanDirection d;
  EXPECT_EQ(d.mean(), Vec2());
  d.add({0.6f, 0.8f}), d.add({-0.6f, -0.8f});
  EXPECT_NEAR(std::fabs(dot(d.mean(), Vec2(0.6f, 0.8f))), 1, 1e-6f);
  MeanDirection half;
  half.add({1, 0}), half.add({-0.6f, 0.8f});  // 0° and 127°, which is -53°
  EXPECT_NEAR(std::fabs(dot(half.mean(), Vec2(0.89442719f, -0.44721360f))), 1, 1e-6f);
}

TEST(Matte, TangentsReachIntoGaps) {
  Matte m = random_matte(9, 5, 0);
  m.tangent_y[2 * 9 + 4] = 1;
  extend_tangents(m, 2);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) EXPECT_EQ(m.tangent_y[static_cast<std::size_t>(y * 9 + x)], std::abs(x - 4) <= 2 ? 1.f : 0.f);
}

// Over a bright and over a dark background, of one and of several visibility pixels.
TEST(Matte, LiesOverWhatIsBehind) {
  StrandLayer layer;
  layer.width = 4, layer.height = 2, layer.side = 2;
  layer.behind.resize(8), layer.visibility.resize(8);
  layer.visibility.fill({});
  for (std::size_t p = 0; p < 8; ++p) layer.behind[p] = p % 4 < 2 ? Vec4(1, 2, 3, 1) : Vec4(0, 0, 0, p % 4 == 2 ? 1 : 0);
  Matte m;
  m.resize(2, 1, false);
  m.r[0] = m.r[1] = 0.25f, m.g[0] = m.g[1] = 0, m.b[0] = m.b[1] = 0.5f, m.alpha[0] = m.alpha[1] = 0.5f;
  const Image image = lay_over(m, layer, 1);
  const float expected[] = {1.5f, 2, 4, 1, 0.5f, 0, 1, 0.75f};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(image.pixels[i], expected[i], 1e-6f);
  m.coverage.resize(2);
  m.coverage[0] = 1, m.coverage[1] = 0.25f;  // the color stays, the opacity is this
  const float exact[] = {1, 0, 2, 1, 0.25f, 0, 0.5f, 0.625f};
  const Image covered = lay_over(m, layer, 1);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(covered.pixels[i], exact[i], 1e-6f);
}

}  // namespace
}  // namespace pelage
