// The orientation-aware filter against its definition, and the matte around it.
#include "filter/anisotropic.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

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
      m.lie(x, y, {std::cos(angle), std::sin(angle)});
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
  const Vec2 tangent = DirectionCells::middle(DirectionCells::cell_of(m.tangent[m.index(x, y)]));
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
      const double w =
          std::exp(-(dx * dx + dy * dy) / (r * r) * inverse_square(k.sigma_distance) -
                   theta * theta * inverse_square(k.sigma_angle) - color * inverse_square(k.sigma_color) -
                   along * along * inverse_square(k.sigma_along) / 2 - across * across * inverse_square(k.sigma_across) / 2);
      sum += w * static_cast<double>(there.y), weights += w;
    }
  return sum / weights;
}

AnisotropicKernel kernel(float radius, float aspect, float distance = INFINITY, float angle = INFINITY, float color = INFINITY,
                         float along = INFINITY, float across = INFINITY) {
  return {radius, aspect, distance, angle, color, along, across};
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
    const int cell = DirectionCells::cell_of(t);
    ASSERT_TRUE(cell >= 0 && cell < DirectionCells::kDirections);
    ++uses[static_cast<std::size_t>(cell)];
    const Vec2 middle = DirectionCells::middle(cell);
    const double off = std::asin(std::fabs(static_cast<double>(t.x * middle.y - t.y * middle.x))) * 180 / 3.141592653589793;
    EXPECT_LT(off, 0.455) << angle;
    EXPECT_TRUE(off > 0.2 || DirectionCells::cell_of(t * -1.f) == cell) << angle;
  }
  for (const int n : uses) EXPECT_GT(n, 20);
}

TEST(Anisotropic, IsItsDefinition) {
  for (const AnisotropicKernel& k :
       {kernel(3.1f, 0.4f), kernel(4.5f, 0.2f, 0.5f), kernel(3.3f, 1, 0.7f, 0.4f), kernel(4.3f, 0.5f, 0.6f, 0.3f, 0.9f),
        kernel(5.2f, 0.6f, INFINITY, INFINITY, INFINITY, 2, 0.7f), kernel(0, 0.3f), kernel(0.9f, 1, 0.1f, 0.1f, 0.9f)})
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
    for (const float hair : {0.f, 0.5f, 1.f}) {
      const Matte m = random_matte(w, h, hair);
      const Buffer<Vec4> out = filter_anisotropic(m, kernel(4, 0.5f));
      for_each_pixel(m.hair, [&](int x, int y) { EXPECT_TRUE(out[m.index(x, y)].x >= 0 && out[m.index(x, y)].w <= 1); });
    }
}

TEST(Anisotropic, SizeOfTheKernelIsThatOfTheHair) {
  EXPECT_EQ(kernel_for({}, {}).radius, 0.f);
  LinkSettings s;
  s.kernel_size = 0.1f;
  EXPECT_NEAR(kernel_for({20, 84, 10, 35}, s).radius, 0.1f * 40, 1e-5f);  // √(64 · 25)
  s.kernel_size = 1e6f;
  EXPECT_EQ(kernel_for({20, 84, 10, 35}, s).radius, AnisotropicKernel::kMostRadius);
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
  m.lie(4, 2, {0, 1}), m.hair.add(4, 2);
  extend_tangents(m, bare_layer(9, 5), 2);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(m.weight[m.index(x, y)], std::abs(x - 4) <= 2 ? 1.f : 0.f);
      EXPECT_EQ(m.hair.contains(x, y), std::abs(x - 4) <= 2);
      EXPECT_TRUE(!m.hair.contains(x, y) || m.tangent[m.index(x, y)] == Vec2(0, 1));
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
