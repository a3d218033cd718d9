// The orientation-aware filter against its definition, and the matte around it.
#include "filter/anisotropic.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "filter/kernel_taps.h"

namespace pelage {
namespace {

constexpr int kBorder = 7;  // the most that a kernel of these tests reaches

Matte random_matte(int width, int height, float hair, std::uint32_t seed = 1) {
  Matte m(width, height, kBorder, false);
  m.clear(0, height);
  Rng rng(4, seed);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!(rng.uniform() < hair)) continue;
      const float alpha = rng.uniform(), angle = 6.2832f * rng.uniform();
      m.color[m.index(x, y)] = {alpha * rng.uniform(), alpha * 2 * rng.uniform(), alpha * rng.uniform(), alpha};
      m.lie(x, y, {std::cos(angle), std::sin(angle)}, 0.05f * std::exp2(6 * static_cast<float>(x) / static_cast<float>(width)));
      m.hair.add(x, y);
    }
  return m;
}

/// A layer without hair for mattes of this size.
StrandLayer bare_layer(int width, int height, int side = 1) {
  StrandLayer layer;
  layer.width = width * side, layer.height = height * side, layer.side = side;
  const auto n = static_cast<std::size_t>(layer.width * layer.height);
  layer.visibility.resize(n), layer.depth.resize(n);
  layer.visibility.fill({}), layer.depth.fill(INFINITY);
  mark_hair(layer);
  return layer;
}

double inverse_square(float sigma) {
  return std::isinf(sigma) ? 0 : 1 / (static_cast<double>(sigma) * static_cast<double>(sigma));
}

/// Eq. 11 and 12 of Huang 2025 and eq. 9 of Lipp 2026, pixel by pixel, in double precision, along the middle of the tangent's
/// cell of directions.
double filtered_green(const Matte& m, const AnisotropicKernel& k, int x, int y) {
  if (!m.hair.contains(x, y)) return 0;
  const Vec4 here = m.color[m.index(x, y)];
  const Vec2 tangent = DirectionCells::middle(DirectionCells::cell_of(MeanDirection::doubled(m.tangent[m.index(x, y)])));
  double sum = 0, weights = 0;
  const double r = std::max(0.5, static_cast<double>(k.radius)), minor = std::max(0.5, r * static_cast<double>(k.aspect));
  for (int j = 0; j < m.height; ++j)
    for (int i = 0; i < m.width; ++i) {
      const Vec4 there = m.color[m.index(i, j)];
      if (!m.hair.contains(i, j) || std::abs(i - x) > static_cast<int>(r) || std::abs(j - y) > static_cast<int>(r)) continue;
      const double dx = i - x, dy = j - y, tx = static_cast<double>(tangent.x), ty = static_cast<double>(tangent.y);
      const double along = dx * tx + dy * ty, across = dx * ty - dy * tx;
      if (along * along / (r * r) + across * across / (minor * minor) > 1) continue;
      const double theta = dx == 0 && dy == 0 ? 0 : std::acos(std::min(1.0, std::abs(along) / std::hypot(dx, dy)));
      double color = 0;
      for (const auto c : {&Vec4::x, &Vec4::y, &Vec4::z})
        color += std::pow(static_cast<double>(there.*c) - static_cast<double>(here.*c), 2);
      const double w = std::exp(-(dx * dx + dy * dy) / (r * r) * inverse_square(k.sigma_distance) -
                                theta * theta * inverse_square(k.sigma_angle) - color * inverse_square(k.sigma_color) -
                                along * along / (r * r) * inverse_square(k.sigma_along) / 2 -
                                across * across / (minor * minor) * inverse_square(k.sigma_across) / 2);
      sum += w * static_cast<double>(there.y), weights += w;
    }
  return sum / weights;
}

AnisotropicKernel kernel(float radius, float aspect, float distance = INFINITY, float angle = INFINITY, float color = INFINITY,
                         float along = INFINITY, float across = INFINITY) {
  return {radius, aspect, distance, angle, color, along, across};
}

AnisotropicKernel adapting(float radius, float aspect) {
  AnisotropicKernel k = kernel(radius, aspect, INFINITY, INFINITY, INFINITY, 0.5f, 0.5f);
  k.adapts = true;
  return k;
}

template <class F>
void for_each_pixel(const PixelMask& mask, const F& f) {
  mask.for_each(0, static_cast<std::size_t>(mask.height()), f);
}

// The direction that a pixel is filtered along is that of its hair, up to the size of a cell.
TEST(DirectionCells, AreNarrowAndHaveNoSign) {
  std::vector<int> uses(DirectionCells::kDirections);
  for (int i = 0; i < 20000; ++i) {
    const double angle = 6.283185307179586 * i / 20000;
    const Vec2 t(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    const int cell = DirectionCells::cell_of(MeanDirection::doubled(t));
    ASSERT_TRUE(cell >= 0 && cell < DirectionCells::kDirections);
    ++uses[static_cast<std::size_t>(cell)];
    const Vec2 middle = DirectionCells::middle(cell);
    const double off = std::asin(std::fabs(static_cast<double>(t.x * middle.y - t.y * middle.x))) * 180 / 3.141592653589793;
    EXPECT_LT(off, 0.455) << angle;
    EXPECT_EQ(DirectionCells::cell_of(MeanDirection::doubled(t * -1.f)), cell) << angle;
  }
  for (const int n : uses) EXPECT_GT(n, 20);
}

TEST(Anisotropic, IsItsDefinition) {
  for (const AnisotropicKernel& k :
       {kernel(3.1f, 0.4f), kernel(4.5f, 0.2f, 0.5f), kernel(3.3f, 1, 0.7f, 0.4f), kernel(4.3f, 0.5f, 0.6f, 0.3f, 0.9f),
        kernel(5.2f, 0.6f, INFINITY, INFINITY, INFINITY, 0.4f, 0.25f), kernel(0, 0.3f), kernel(0.9f, 1, 0.1f, 0.1f, 0.9f)})
    for (const float hair : {0.2f, 1.f}) {
      const Matte m = random_matte(23, 19, hair);
      const Buffer<Vec4> out = filter_anisotropic(m, k);
      for_each_pixel(m.hair, [&](int x, int y) {
        EXPECT_NEAR(static_cast<double>(out[m.index(x, y)].y), filtered_green(m, k, x, y), 2e-5)
            << x << " " << y << " r " << k.radius;
      });
    }
}

// The term of color is the only wide part.
TEST(Anisotropic, SameBitsOnAnyInstructionSet) {
  const Matte m = random_matte(61, 43, 0.7f);
  const AnisotropicKernel k = kernel(6, 0.7f, 0.6f, 0.3f, 0.5f);
  const Buffer<Vec4> slow = filter_anisotropic(m, k);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    const Buffer<Vec4> fast = filter_anisotropic(m, k);
    for_each_pixel(m.hair, [&](int x, int y) { EXPECT_EQ(slow[m.index(x, y)], fast[m.index(x, y)]) << isa << x << " " << y; });
  }
  set_isa("");
}

// What is the same everywhere stays as it is: hair of one color and opacity, whatever its directions.
TEST(Anisotropic, LeavesUniformHairAlone) {
  Matte m = random_matte(40, 30, 1);
  for_each_pixel(m.hair, [&](int x, int y) { m.color[m.index(x, y)] = {0.3f, 0.2f, 0.1f, 0.5f}; });
  const Buffer<Vec4> out = filter_anisotropic(m, kernel(6, 0.3f, 0.5f, 0.5f, 0.9f));
  for_each_pixel(m.hair, [&](int x, int y) {
    EXPECT_NEAR(out[m.index(x, y)].x, 0.3f, 1e-6f);
    EXPECT_NEAR(out[m.index(x, y)].w, 0.5f, 1e-6f);
  });
}

TEST(Anisotropic, SmoothsAlongAndNotAcross) {
  Matte m = random_matte(31, 31, 1);
  for_each_pixel(m.hair, [&](int x, int y) { m.color[m.index(x, y)] = {}, m.lie(x, y, {1, 0}); });
  m.color[m.index(15, 15)].y = 1;
  const Buffer<Vec4> out = filter_anisotropic(m, kernel(5, 0.1f));
  for_each_pixel(
      m.hair, [&](int x, int y) { EXPECT_NEAR(out[m.index(x, y)].y, y == 15 && std::abs(x - 15) <= 5 ? 1 / 11.f : 0, 1e-6f); });
}

// Hair without a direction has nothing to be smoothed along.
TEST(Anisotropic, LeavesHairThatIsSeenEndOnAlone) {
  Matte m = random_matte(9, 9, 1);
  m.lie(4, 4, {});
  const Buffer<Vec4> out = filter_anisotropic(m, kernel(3, 1));
  EXPECT_EQ(out[m.index(4, 4)], m.color[m.index(4, 4)]);
}

TEST(Anisotropic, FiltersColorAndOpacityApart) {
  Matte m = random_matte(40, 30, 0.6f);
  const AnisotropicKernel narrow = kernel(2, 0.5f), wide = kernel(7, 0.5f);
  const Buffer<Vec4> apart = filter_apart(m, narrow, wide), opacity = filter_anisotropic(m, narrow),
                     color = filter_anisotropic(m, wide);
  const Buffer<Vec4> alike = filter_apart(m, wide, wide);
  m.coverage.resize(m.color.size());
  const Buffer<Vec4> exact = filter_apart(m, narrow, wide);
  for_each_pixel(m.hair, [&](int x, int y) {
    const std::size_t p = m.index(x, y);
    EXPECT_EQ(apart[p].w, opacity[p].w);
    EXPECT_NEAR(apart[p].x * color[p].w, color[p].x * opacity[p].w, 1e-6f);  // the hair's own color is the wide one
    EXPECT_EQ(alike[p], color[p]);
    EXPECT_EQ(exact[p], color[p]);
  });
}

TEST(Anisotropic, TakesOddSizesAndEmptyPictures) {
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 40}, std::pair{67, 1}, std::pair{17, 9}})
    for (const float hair : {0.f, 0.5f, 1.f})
      for (const AnisotropicKernel& k : {kernel(4, 0.5f), adapting(4, 0.5f)}) {
        const Matte m = random_matte(w, h, hair);
        const Buffer<Vec4> out = filter_anisotropic(m, k);
        for_each_pixel(m.hair,
                       [&](int x, int y) { EXPECT_TRUE(out[m.index(x, y)].x >= 0 && out[m.index(x, y)].w <= 1.0001f); });
      }
}

// The variant for the mean thickness around a pixel and for the agreement of directions there, along their mean.
TEST(Anisotropic, AdaptsToThicknessAndAgreement) {
  const Matte m = random_matte(41, 33, 0.6f);
  const AnisotropicKernel k = adapting(6, 0.2f);
  const Buffer<Vec4> out = filter_anisotropic(m, k);
  std::vector<int> seen(static_cast<std::size_t>(KernelVariants::count(k)));
  for_each_pixel(m.hair, [&](int x, int y) {
    MeanDirection sum;
    double cos2 = 0, sin2 = 0, thickness = 0, count = 0;
    for (int j = y - 2; j <= y + 2; ++j)
      for (int i = x - 2; i <= x + 2; ++i) {
        if (!m.hair.contains(i, j)) continue;
        const Vec2 t = m.tangent[m.index(i, j)];
        const double angle = 2 * std::atan2(static_cast<double>(t.y), static_cast<double>(t.x));
        sum.add(t), cos2 += std::cos(angle), sin2 += std::sin(angle),
            thickness += static_cast<double>(m.thickness[m.index(i, j)]);
        count += 1;
      }
    const int variant =
        KernelVariants::of(static_cast<float>(thickness / count), static_cast<float>(std::hypot(cos2, sin2) / count));
    ++seen[static_cast<std::size_t>(variant)];
    Matte lone = random_matte(41, 33, 0.6f);
    lone.lie(x, y, sum.mean());
    const double expected = filtered_green(lone, KernelVariants::kernel(k, variant), x, y);
    EXPECT_NEAR(static_cast<double>(out[m.index(x, y)].y), expected, 2e-5) << x << " " << y << " variant " << variant;
  });
  EXPECT_GT(std::count_if(seen.begin(), seen.end(), [](int n) { return n > 0; }), 8);
}

TEST(KernelVariants, ShrinkWithThicknessAndRoundWithDisagreement) {
  const AnisotropicKernel thin = adapting(8, 0.25f);
  const auto variant = [&](float thickness, float agreement) {
    return KernelVariants::kernel(thin, KernelVariants::of(thickness, agreement));
  };
  EXPECT_EQ(variant(0, 1).radius, 8);
  EXPECT_EQ(variant(0.13f, 1).radius, 8);
  EXPECT_EQ(variant(0.13f, 1).aspect, 0.25f);
  EXPECT_NEAR(variant(0.4f, 1).radius, 4, 1e-5f);  // half of it at four times the thickness
  EXPECT_NEAR(variant(1.6f, 1).radius, 2, 1e-5f);
  EXPECT_EQ(variant(1.6f, 1).aspect, 0.5f);  // one pixel across at least
  EXPECT_EQ(variant(1e6f, 1).radius, 1);
  EXPECT_EQ(variant(1e6f, 0).aspect, 1);
  for (const float thickness : {0.f, 0.5f, 2.f})
    for (const float agreement : {0.f, 0.4f, 0.8f}) {
      const AnisotropicKernel k = variant(thickness, agreement), agreed = variant(thickness, 1);
      EXPECT_NEAR(k.radius * k.radius * k.aspect, agreed.radius * agreed.radius * agreed.aspect, 1e-4f);
      EXPECT_GE(k.aspect, agreed.aspect);
    }
  EXPECT_EQ(variant(0.5f, 0).aspect, 1);
  EXPECT_EQ(KernelVariants::kernel(kernel(5, 0.3f), 0).radius, 5);
  EXPECT_EQ(KernelVariants::count(kernel(5, 0.3f)), 1);
}

TEST(Anisotropic, SizeOfThePublishedKernelIsThatOfTheHair) {
  LinkSettings s;
  s.kernel_size = 0.1f;
  EXPECT_EQ(kernel_for({}, 1, s).radius, 0.f);
  EXPECT_NEAR(kernel_for({20, 84, 10, 35}, 1, s).radius, 0.1f * 40, 1e-5f);  // √(64 · 25)
  EXPECT_FALSE(kernel_for({}, 1, s).adapts);
  s.kernel_size = 1e6f;
  EXPECT_EQ(kernel_for({20, 84, 10, 35}, 1, s).radius, AnisotropicKernel::kMostRadius);
}

TEST(Anisotropic, KernelThatAdaptsShrinksAsSamplesGrow) {
  LinkSettings s;
  EXPECT_TRUE(kernel_for({20, 84, 10, 35}, 1, s).adapts);
  EXPECT_EQ(kernel_for({20, 84, 10, 35}, 1, s).radius, s.kernel_radius);
  EXPECT_NEAR(kernel_for({}, 2, s).radius, 0.66f * s.kernel_radius, 0.01f);  // of four samples
  EXPECT_EQ(kernel_for({}, 1, s).sigma_along, s.falloff);
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
  m.lie(4, 2, {0, 1}, 0.5f), m.hair.add(4, 2);
  extend_tangents(m, bare_layer(9, 5), 2);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(m.weight[m.index(x, y)], std::abs(x - 4) <= 2 ? 1.f : 0.f);
      EXPECT_EQ(m.hair.contains(x, y), std::abs(x - 4) <= 2);
      EXPECT_TRUE(!m.hair.contains(x, y) || m.tangent[m.index(x, y)] == Vec2(0, 1));
      EXPECT_TRUE(!m.hair.contains(x, y) || m.thickness[m.index(x, y)] == 0.5f);
    }
}

// Where something opaque is in front of all the hair around, there is no gap to close.
TEST(Matte, GapsAreNotInFrontOfHair) {
  for (const int side : {1, 2}) {
    Matte m = random_matte(9, 1, 0);
    StrandLayer layer = bare_layer(9, 1, side);
    layer.opaque_depth.resize(layer.depth.size());
    const auto set = [&](Buffer<float>& plane, int x, float value) {
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) plane[static_cast<std::size_t>(j * layer.width + x * side + i)] = value;
    };
    m.lie(4, 0, {1, 0}), m.hair.add(4, 0);
    set(layer.depth, 4, 2);
    for (int x = 0; x < 9; ++x) set(layer.opaque_depth, x, x == 3 || x == 6 ? 1.f : x == 5 ? 3.f : INFINITY);
    extend_tangents(m, layer, 2);
    for (int x = 0; x < 9; ++x) EXPECT_EQ(m.hair.contains(x, 0), x == 2 || x == 4 || x == 5) << x << " side " << side;
  }
}

// Over a bright and over a dark background, of one and of several visibility pixels.
TEST(Matte, LiesOverWhatIsBehind) {
  const StrandLayer layer = bare_layer(2, 1, 2);
  Behind behind;
  behind.width = 4, behind.height = 2, behind.color.resize(8);
  for (std::size_t p = 0; p < 8; ++p) behind.color[p] = p % 4 < 2 ? Vec4(1, 2, 3, 1) : Vec4(0, 0, 0, p % 4 == 2 ? 1 : 0);
  Matte m(2, 1, 0, false);
  m.clear(0, 1);
  for (int x = 0; x < 2; ++x) m.color[m.index(x, 0)] = {0.25f, 0, 0.5f, 0.5f}, m.hair.add(x, 0);
  const Image image = lay_over(m, {}, layer, behind, 1);
  const float expected[] = {1.5f, 2, 4, 1, 0.5f, 0, 1, 0.75f};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(image.pixels[i], expected[i], 1e-6f);
  m.coverage.resize(2);
  m.coverage[0] = 1, m.coverage[1] = 0.25f;  // the color stays, the opacity is this
  const float exact[] = {1, 0, 2, 1, 0.25f, 0, 0.5f, 0.625f};
  const Image covered = lay_over(m, {}, layer, behind, 1);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(covered.pixels[i], exact[i], 1e-6f);
}

// A matte of a part of the picture: around it only what is behind is seen.
TEST(Matte, LiesWhereItsLayerIs) {
  StrandLayer layer = bare_layer(2, 2);
  layer.left = 1, layer.top = 2;
  Behind behind;
  behind.width = 4, behind.height = 5, behind.color.resize(20);
  behind.color.fill({1, 1, 1, 1});
  Matte m(2, 2, 0, false);
  m.clear(0, 2);
  m.left = 1, m.top = 2;
  m.color[m.index(1, 0)].w = 1, m.hair.add(1, 0);
  const Image image = lay_over(m, {}, layer, behind, 0);
  for (std::size_t p = 0; p < 20; ++p) EXPECT_EQ(image.pixels[4 * p], p == 2 * 4 + 2 ? 0.f : 1.f) << p;
}

}  // namespace
}  // namespace pelage
