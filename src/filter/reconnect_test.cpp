#include "filter/reconnect.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

/// A picture of one pixel per metre, whose strands are drawn by hand. Depths are shares of a range of 100 m.
class Canvas {
 public:
  Canvas(int width, int height) {
    Camera camera;
    camera.projection = Camera::Projection::kOrthographic;
    camera.eye = {0, 0, 1}, camera.target = {0, 0, 0}, camera.height = static_cast<float>(height);
    buffer.view = make_camera_view(camera, width, height);
    buffer.range = {0, kRange};
    const auto pixels = static_cast<std::size_t>(width * height);
    buffer.center.resize(pixels), buffer.conservative.resize(pixels), radiance.index.resize(pixels);
    buffer.center.fill(kEmptyPixel), buffer.conservative.fill(kEmptyPixel), radiance.index.fill(Radiance::kNone);
  }

  /// A strand along `tangent` (world: y up) at a pixel; its center, too, or only a touch.
  void put(int x, int y, float depth, Vec3 tangent, bool center, Vec3 color = {0.5f, 0.4f, 0.3f}) {
    const Vec2 oct = kernel::raster_octahedral(normalize(tangent));
    const auto level = [](float v) { return static_cast<PixelKey>(kernel::raster_tangent_level(v)); };
    const PixelKey key = static_cast<PixelKey>(kernel::raster_depth_level(depth, 0, kernel::kRasterDepthLevels)) << 40 |
                         level(oct.x) << 32 | level(oct.y) << 24;
    const auto at = static_cast<std::size_t>(y * buffer.view.width + x);
    buffer.conservative[at] = std::min(buffer.conservative[at], key);
    if (!center || key >= buffer.center[at]) return;
    buffer.center[at] = key;
    radiance.index[at] = static_cast<std::uint32_t>(colors_.size());
    colors_.push_back(color);
  }
  HairPicture filter(const SwrSettings& settings = {}, const Buffer<float>& coverage = {}) {
    radiance.color.resize(colors_.size());
    std::copy(colors_.begin(), colors_.end(), radiance.color.begin());
    return reconnect(buffer, radiance, settings, coverage);
  }
  DeferredBuffer buffer;
  Radiance radiance;
  static constexpr float kRange = 100;

 private:
  std::vector<Vec3> colors_;
};

Vec4 at(const HairPicture& p, int x, int y) { return p.color[static_cast<std::size_t>(y * p.width + x)]; }

// ---------------------------------------------------------------------------------------------------------------------
// Lipp 2026, §3.3, word by word: every pixel of the window, eq. 9 and 10 as they stand. Pixels outside the picture are as those
// at its edge.

struct Mean {
  double r = 0, g = 0, b = 0, weight = 0, hits = 0, all = 0;
};

/// What a mean compares: own color too, or only what is near in depth.
enum class Rule { kCenter, kTouched, kInFront, kDense, kDenseOfAnyDepth };

class Oracle {
 public:
  Oracle(const Canvas& c, const SwrSettings& s) : c_(c), s_(s) {}

  Vec4 pixel(int x, int y) const {
    const PixelKey touched = key(c_.buffer.conservative, x, y), center = key(c_.buffer.center, x, y);
    if (touched == kEmptyPixel) return {0, 0, 0, 0};
    const bool hit = center != kEmptyPixel;
    if (s_.alpha == SwrAlpha::kKernel && around(x, y) > 3) {
      const Mean near = mean(touched, x, y, Rule::kDense),
                 m = near.weight > 0 ? near : mean(touched, x, y, Rule::kDenseOfAnyDepth);
      return over(m, m.hits / m.all, {0, 0, 0, 0});
    }
    const Mean own = mean(hit ? center : touched, x, y, hit ? Rule::kCenter : Rule::kTouched);
    const double alpha = own.hits / own.all;
    if (!hit || depth(touched) > depth(center) - static_cast<double>(s_.connect_depth)) return over(own, alpha, {0, 0, 0, 0});
    const Mean front = mean(touched, x, y, Rule::kInFront);
    const Vec4 behind = over(own, 1, {0, 0, 0, 0});
    return over(front, front.all > 0 ? front.hits / front.all : 0, behind);
  }

 private:
  PixelKey key(const Buffer<PixelKey>& layer, int x, int y) const { return layer[index(x, y)]; }
  std::size_t index(int x, int y) const {
    const int width = c_.buffer.view.width, height = c_.buffer.view.height;
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1));
  }
  int around(int x, int y) const {
    int touched = -1;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) touched += key(c_.buffer.conservative, x + dx, y + dy) != kEmptyPixel;
    return touched;
  }
  static double depth(PixelKey k) { return deferred::depth_level(k) / static_cast<double>(kernel::kRasterDepthLevels); }
  static Vec4 over(const Mean& m, double alpha, Vec4 behind) {
    if (!(m.weight > 0)) return behind;
    const double through = 1 - alpha;
    return {static_cast<float>(m.r / m.weight * alpha + behind.x * through),
            static_cast<float>(m.g / m.weight * alpha + behind.y * through),
            static_cast<float>(m.b / m.weight * alpha + behind.z * through), static_cast<float>(alpha + behind.w * through)};
  }
  Vec3 color(int x, int y) const { return c_.radiance.color[c_.radiance.index[index(x, y)]]; }
  Mean mean(PixelKey strand, int x, int y, Rule rule) const {
    const Vec3 t = transform_vector(c_.buffer.view.world_to_camera, deferred::tangent(strand));
    const double on_screen = std::hypot(t.x, t.y), tx = t.x / on_screen, ty = t.y / on_screen;
    const double slope = std::fmin(std::fmax(t.z / on_screen, -1), 1) / static_cast<double>(Canvas::kRange);
    const double sigma_along = s_.radius * s_.s_parallel, sigma_across = s_.radius * s_.s_perpendicular;
    const bool nearby = rule == Rule::kInFront, dense = rule == Rule::kDense || rule == Rule::kDenseOfAnyDepth;
    const double tolerance = nearby ? s_.connect_depth : rule == Rule::kDenseOfAnyDepth ? 2 : s_.depth_tolerance;
    Mean m;
    for (int dy = -s_.radius; dy <= s_.radius; ++dy)
      for (int dx = -s_.radius; dx <= s_.radius; ++dx) {
        const double along = dx * tx + dy * ty, across = std::hypot(dx - along * tx, dy - along * ty);
        const PixelKey center = key(c_.buffer.center, x + dx, y + dy), touched = key(c_.buffer.conservative, x + dx, y + dy);
        const double expected = depth(strand) + slope * along;
        const bool hit = center != kEmptyPixel;
        const bool alike = hit && std::fabs(depth(dense ? touched : center) - expected) <= tolerance;
        double w = std::exp(-along * along / (sigma_along * sigma_along) - across * across / (sigma_across * sigma_across));
        if (w < static_cast<double>(kLeastReconnectWeight)) w = 0;
        if (dense) {
          m.hits += hit ? w : 0, m.all += w;
        } else if (across <= s_.strip) {
          m.hits += hit && (alike || !nearby);
          m.all += touched != kEmptyPixel && (!nearby || std::fabs(depth(touched) - expected) <= tolerance);
        }
        if (!alike) continue;
        const Vec3 c = color(x + dx, y + dy);
        if (rule == Rule::kCenter) {
          const Vec3 d = c - color(x, y);
          w *= std::exp(-static_cast<double>(dot(d, d)) / (s_.sigma_color * s_.sigma_color));
        }
        m.r += c.x * w, m.g += c.y * w, m.b += c.z * w, m.weight += w;
      }
    return m;
  }

  const Canvas& c_;
  const SwrSettings& s_;
};

/// Strands in directions whose cells are exact, or so nearly that the strip is the same.
Canvas many_strands() {
  Canvas canvas(40, 32);
  Rng rng(3, 1);
  for (int i = 0; i < 900; ++i) {
    const int x = static_cast<int>(40 * rng.uniform()), y = static_cast<int>(32 * rng.uniform());
    constexpr Vec3 kTangents[] = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const Vec3 color(rng.uniform(), rng.uniform(), 2 * rng.uniform());
    canvas.put(x, y, 0.3f + 0.05f * rng.uniform(), kTangents[i % 4], rng.uniform() < 0.5f, color);
  }
  return canvas;
}

struct Difference {
  double alpha = 0, worst = 0, mean = 0;
};

Difference from_oracle(Canvas& canvas, const SwrSettings& settings) {
  const HairPicture picture = canvas.filter(settings);
  const Oracle oracle(canvas, settings);
  Difference d;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Vec4 a = at(picture, x, y), b = oracle.pixel(x, y);
      d.alpha = std::fmax(d.alpha, std::fabs(a.w - b.w));
      const double off = std::fmax(std::fmax(std::fabs(a.x - b.x), std::fabs(a.y - b.y)), std::fabs(a.z - b.z));
      d.worst = std::fmax(d.worst, off), d.mean += off / (picture.width * picture.height);
    }
  return d;
}

TEST(Reconnect, DoesWhatItsEquationsSay) {
  SwrSettings settings;
  settings.alpha = SwrAlpha::kRatio, settings.s_parallel = 0.56f, settings.s_perpendicular = 0.28f;
  settings.depth_tolerance = 0.02f, settings.connect_depth = 0.02f;
  Canvas canvas = many_strands();
  const Difference d = from_oracle(canvas, settings);
  EXPECT_LT(d.alpha, 1e-5);
  // Tangents of 255 levels, and the cheap exponential, which favors other colors a little.
  EXPECT_LT(d.worst, 0.06);
  EXPECT_LT(d.mean, 0.006);
  int promoted = 0, covered = 0;
  for (std::size_t p = 0; p < canvas.buffer.center.size(); ++p) {
    const PixelKey center = canvas.buffer.center[p], touched = canvas.buffer.conservative[p];
    promoted += center == kEmptyPixel && touched != kEmptyPixel, covered += center != kEmptyPixel && touched != center;
  }
  EXPECT_GT(promoted, 100);
  EXPECT_GT(covered, 50);
}

TEST(Reconnect, TakesTheMeanUnderTheKernelInDenseHair) {
  SwrSettings settings;
  settings.depth_tolerance = 0.02f;
  Canvas canvas = many_strands();
  const Difference d = from_oracle(canvas, settings);
  EXPECT_LT(d.alpha, 0.002);
  EXPECT_LT(d.worst, 0.06);
  EXPECT_LT(d.mean, 0.004);
}

// What shows in three of ten pixels covers three tenths, wherever kernels lie.
TEST(Reconnect, KeepsCoverageAndRadiance) {
  Canvas canvas(128, 128);
  Rng rng(5, 1);
  double hits = 0, light = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const bool hit = rng.uniform() < 0.3f;
      const float green = rng.uniform(), depth = 0.4f + 0.2f * rng.uniform();
      canvas.put(x, y, depth, {rng.uniform() - 0.5f, rng.uniform() - 0.5f, 0}, hit, {1, green, 0});
      hits += hit, light += hit ? green : 0.f;
    }
  SwrSettings settings;
  settings.depth_tolerance = 1;
  const HairPicture picture = canvas.filter(settings);
  double alpha = 0, green = 0;
  for (const Vec4 p : picture.color) alpha += p.w, green += p.y;
  EXPECT_NEAR(alpha / hits, 1, 0.005);
  EXPECT_NEAR(green / light, 1, 0.01);
}

// A strand of which every third pixel is hit and all are touched.
TEST(Reconnect, ConnectsAStrandAndMakesItATransparentThird) {
  Canvas canvas(64, 16);
  for (int x = 0; x < 64; ++x) canvas.put(x, 8, 0.5f, {1, 0, 0}, x % 3 == 1);
  const HairPicture picture = canvas.filter();
  for (int x = 6; x < 58; ++x) {
    const Vec4 p = at(picture, x, 8);
    EXPECT_NEAR(p.w, 1 / 3.f, 0.07f) << x;  // 3 or 4 of 11
    EXPECT_NEAR(p.x / p.w, 0.5f, 1e-4f);
    EXPECT_EQ(at(picture, x, 7).w, 0);
  }
}

// Its hits lie far apart from those of the hair behind it, and do not take their color.
TEST(Reconnect, LaysAFlyawayOverTheHairBehind) {
  Canvas canvas(64, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 64; ++x) canvas.put(x, y, 0.8f, {0, 1, 0}, true, {0.1f, 0.1f, 0.1f});
  for (int x = 0; x < 64; ++x) canvas.put(x, 12, 0.2f, {1, 0, 0}, x % 2 == 0, {0.9f, 0.9f, 0.9f});
  const HairPicture picture = canvas.filter();
  for (int x = 6; x < 58; ++x) {
    EXPECT_EQ(at(picture, x, 12).w, 1);
    if (x % 2 != 0) {
      EXPECT_NEAR(at(picture, x, 12).x, 0.5f, 0.06f) << x;  // half of it over what is behind
    }
    EXPECT_NEAR(at(picture, x, 10).x, 0.1f, 0.01f);
  }
}

TEST(Reconnect, DenseHairIsOpaque) {
  Canvas canvas(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) canvas.put(x, y, 0.5f, {1, 2, 0}, true);
  for (const Vec4 p : canvas.filter().color) EXPECT_EQ(p.w, 1);
}

// Hair goes on behind what hides it, and ends before what stands behind it.
TEST(Reconnect, KnowsWhatTheOpaqueSceneHides) {
  for (const float opaque : {0.1f, 0.9f}) {
    Canvas canvas(32, 16);
    canvas.buffer.opaque.resize(32 * 16), canvas.buffer.opaque.fill(2);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x)
        if (x < 16) canvas.put(x, y, 0.5f, {1, 1, 0}, true);
        else canvas.buffer.opaque[static_cast<std::size_t>(y * 32 + x)] = opaque;
    const HairPicture picture = canvas.filter();
    for (int y = 0; y < 16; ++y) {
      EXPECT_EQ(at(picture, 8, y).w, 1);
      EXPECT_EQ(at(picture, 16, y).w, 0);
      const float edge = at(picture, 15, y).w;
      EXPECT_TRUE(opaque < 0.5f ? edge == 1 : edge > 0.5f && edge < 0.9f) << opaque << ": " << edge;
    }
  }
}

// Strands that come toward the camera are followed by the depth that they should have.
TEST(Reconnect, FollowsAStrandInDepth) {
  Canvas canvas(64, 8);
  for (int x = 0; x < 64; ++x) canvas.put(x, 4, 0.2f + 0.005f * static_cast<float>(x), {1, 0, -0.5f}, x % 2 == 0);
  const HairPicture picture = canvas.filter();
  for (int x = 6; x < 58; ++x) EXPECT_NEAR(at(picture, x, 4).w, 0.5f, 0.06f) << x;
}

TEST(Reconnect, TakesOpacityFromCoverageWhereThereIsOne) {
  Canvas canvas(32, 8);
  for (int x = 0; x < 32; ++x) canvas.put(x, 4, 0.5f, {1, 0, 0}, x % 2 == 0);
  Buffer<float> coverage(32 * 8);
  coverage.fill(0.25f);
  const HairPicture picture = canvas.filter({}, coverage);
  for (int x = 0; x < 32; ++x) EXPECT_EQ(at(picture, x, 4).w, 0.25f);
}

TEST(Reconnect, SameBitsForAnyThreadsAndInstructionSet) {
  Canvas canvas(61, 47);
  Rng rng(4, 1);
  for (int i = 0; i < 3000; ++i)
    canvas.put(static_cast<int>(61 * rng.uniform()), static_cast<int>(47 * rng.uniform()), rng.uniform(),
               {rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f}, rng.uniform() < 0.3f);
  set_thread_count(1);
  const HairPicture one = canvas.filter();
  set_thread_count(3);
  const HairPicture three = canvas.filter();
  set_thread_count(0);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(std::memcmp(one.color.data(), canvas.filter().color.data(), one.color.size() * sizeof(Vec4)), 0) << isa;
  }
  set_isa("");
  EXPECT_EQ(std::memcmp(one.color.data(), three.color.data(), one.color.size() * sizeof(Vec4)), 0);
  for (const Vec4 p : one.color) EXPECT_TRUE(std::isfinite(p.x) && p.w >= 0 && p.w <= 1);
}

}  // namespace
}  // namespace pelage
