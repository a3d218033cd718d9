// What the layers cover, against the definition of the band in double precision (kernel/raster/band.h), point by point.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "assemble/assemble.h"
#include "core/rng.h"
#include "frame/camera_view.h"
#include "raster/analytic.h"
#include "raster/band_area.h"
#include "raster/raster.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

/// Rules (1) to (3) of the band of segment j, in double precision. `slack` widens the band by so many pixels.
bool covers(const ScreenBlock& b, std::size_t j, double x, double y, double slack = 0) {
  const double dx = static_cast<double>(b.x[j + 1]) - b.x[j], dy = static_cast<double>(b.y[j + 1]) - b.y[j];
  const bool x_major = std::fabs(static_cast<float>(dx)) >= std::fabs(static_cast<float>(dy));
  const double du = x_major ? dx : dy, dv = x_major ? dy : dx;
  if (du == 0) return false;
  const double s = x_major ? x - b.x[j] : y - b.y[j], above = x_major ? y - b.y[j] : x - b.x[j];
  const double stretch = std::hypot(1.0, dv / du), ra = b.radius[j], rb = b.radius[j + 1];
  if (std::fabs(above - s * dv / du) > stretch * (ra + (rb - ra) * s / du) + slack) return false;
  const double limit = kernel::kRasterMiterLimit;
  if (s < std::min(-ra * limit, du - rb * limit) - slack || s > std::max(ra * limit, du + rb * limit) + slack) return false;
  const auto side = [&](std::size_t i) {
    return (b.cap_x[i] * (x - b.x[i]) + b.cap_y[i] * (y - b.y[i])) / std::hypot(b.cap_x[i], b.cap_y[i]);
  };
  return side(j) >= -slack && side(j + 1) < slack;
}

struct Projected {
  CameraView view;
  ScreenBlock block;
};

Projected project_scene(const Scene& scene, int width, int height) {
  Projected p;
  p.view = make_camera_view(scene.camera, width, height);
  assemble_strands(make_assemble_job(scene, p.view, number_segments(scene, p.view), 0), 0, 1, p.block);
  return p;
}

/// Share of pixel (x, y) that the strand in `block` covers, by `n` × n points.
double supersampled(const ScreenBlock& block, int x, int y, int n) {
  const auto near = [&](std::size_t j) {
    const float reach = 2 * std::max(block.radius[j], block.radius[j + 1]) + 1;
    return block.id[j] != ScreenBlock::kNoSegment && std::min(block.x[j], block.x[j + 1]) - reach < static_cast<float>(x) &&
           std::max(block.x[j], block.x[j + 1]) + reach > static_cast<float>(x) &&
           std::min(block.y[j], block.y[j + 1]) - reach < static_cast<float>(y) &&
           std::max(block.y[j], block.y[j + 1]) + reach > static_cast<float>(y);
  };
  std::vector<std::size_t> segments;
  for (std::size_t j = 0; j + 1 < block.count; ++j)
    if (near(j)) segments.push_back(j);
  int hits = 0;
  for (int i = 0; i < n * n; ++i) {
    // A rotated lattice: its rows are not parallel to anything.
    const double px = x + std::fmod((i + 0.5) * 0.7548776662466927, 1.0),
                 py = y + std::fmod((i + 0.5) * 0.5698402909980532, 1.0);
    hits += std::any_of(segments.begin(), segments.end(), [&](std::size_t j) { return covers(block, j, px, py); });
  }
  return static_cast<double>(hits) / (n * n);
}

StrandSet isolated(bool curly, float width, CurveBasis basis) {
  StrandSet set = test::strand({}, width, basis);
  for (int i = 0; i < 25; ++i) {
    const float t = static_cast<float>(i) / 24;
    set.points.push_back(curly ? Vec3(-28 + 56 * t + 5 * std::sin(18 * t), 7 * std::cos(18 * t) + 2 * t, 0)
                               : Vec3(-29.3f + 58 * t, -7.7f + 16.3f * t, 0));
  }
  set.offsets = {0, 25};
  return set;
}

TEST(Coverage, AnalyticAreaOfIsolatedStrands) {
  for (const bool curly : {false, true})
    for (const float width : {0.05f, 0.2f, 0.5f, 1.f, 2.f, 4.f}) {
      Scene scene = test::scene_of(isolated(curly, width, CurveBasis::kCatmullRom));
      scene.camera = test::pixel_camera(40);
      scene.settings.subdivisions = 3;
      const Projected p = project_scene(scene, 64, 40);
      GBuffer g;
      raster_strands(scene, p.view, number_segments(scene, p.view), {.center = false, .analytic = true}, g);
      double error = 0, worst = 0;
      int touched = 0;
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 64; ++x) {
          const double exact = supersampled(p.block, x, y, 32),
                       found = analytic_coverage(g, static_cast<std::size_t>(y * 64 + x));
          if (exact == 0 && found == 0) continue;
          ++touched, error += std::fabs(exact - found), worst = std::max(worst, std::fabs(exact - found));
        }
      RecordProperty(curly ? "curly" : "straight", std::to_string(error / touched));
      EXPECT_LE(error / touched, 0.005) << "width " << width << ", curly " << curly << ", worst " << worst;
    }
}

/// A block of one random segment with caps of its own, near a small image.
ScreenBlock random_segment(std::uint32_t key) {
  Rng rng(11, key);
  ScreenBlock b;
  for (Buffer<float> ScreenBlock::*member :
       {&ScreenBlock::x, &ScreenBlock::y, &ScreenBlock::depth, &ScreenBlock::radius, &ScreenBlock::cap_x, &ScreenBlock::cap_y})
    (b.*member).resize(2);
  b.id.resize(2);
  b.count = 2, b.id[0] = 0, b.id[1] = ScreenBlock::kNoSegment;
  const float reach = std::exp2(4 * rng.uniform());
  b.x[0] = 12 * rng.uniform() - 2, b.y[0] = 12 * rng.uniform() - 2;
  b.x[1] = b.x[0] + reach * (2 * rng.uniform() - 1), b.y[1] = b.y[0] + reach * (2 * rng.uniform() - 1);
  for (int i = 0; i < 2; ++i) {
    b.depth[i] = 1 + rng.uniform();
    const float turn = 1.2f * (2 * rng.uniform() - 1), dx = b.x[1] - b.x[0], dy = b.y[1] - b.y[0];
    b.cap_x[i] = dx * std::cos(turn) - dy * std::sin(turn), b.cap_y[i] = dx * std::sin(turn) + dy * std::cos(turn);
  }
  // Thin to wide, tapering by up to half a pixel a pixel.
  b.radius[0] = 0.5f * std::exp2(7 * rng.uniform() - 6);
  b.radius[1] = std::max(0.f, b.radius[0] + 0.5f * (2 * rng.uniform() - 1) * std::hypot(b.x[1] - b.x[0], b.y[1] - b.y[0]));
  return b;
}

/// The band clipped to a pixel, in double precision: corners of the polygon that half planes leave, moved out by `slack`
/// pixels.
struct P {
  double x, y;
};
std::vector<P> clipped(const ScreenBlock& b, int x, int y, double slack) {
  std::vector<P> corners{{x + 0.0, y + 0.0}, {x + 1.0, y + 0.0}, {x + 1.0, y + 1.0}, {x + 0.0, y + 1.0}};
  const auto keep = [&](auto&& side) {
    std::vector<P> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const P p = corners[i], q = corners[(i + 1) % corners.size()];
      const double a = side(p), c = side(q);
      if (a >= 0) kept.push_back(p);
      if ((a >= 0) != (c >= 0)) kept.push_back({p.x + (q.x - p.x) * a / (a - c), p.y + (q.y - p.y) * a / (a - c)});
    }
    corners = std::move(kept);
  };
  const double dx = static_cast<double>(b.x[1]) - b.x[0], dy = static_cast<double>(b.y[1]) - b.y[0];
  const bool x_major = std::fabs(static_cast<float>(dx)) >= std::fabs(static_cast<float>(dy));
  const double du = x_major ? dx : dy, m = (x_major ? dy : dx) / du, k = std::hypot(1.0, m), ra = b.radius[0], rb = b.radius[1];
  const auto s = [&](P p) { return x_major ? p.x - b.x[0] : p.y - b.y[0]; };
  const auto v = [&](P p) { return x_major ? p.y - b.y[0] : p.x - b.x[0]; };
  const auto half = [&](P p) { return k * (ra + (rb - ra) * s(p) / du) + slack; };
  keep([&](P p) { return half(p) - (v(p) - m * s(p)); });
  keep([&](P p) { return half(p) + (v(p) - m * s(p)); });
  const auto side = [&](std::size_t i, P p) {
    return (b.cap_x[i] * (p.x - b.x[i]) + b.cap_y[i] * (p.y - b.y[i])) / std::hypot(b.cap_x[i], b.cap_y[i]);
  };
  keep([&](P p) { return side(0, p) + slack; });
  keep([&](P p) { return slack - side(1, p); });
  const double limit = kernel::kRasterMiterLimit;
  keep([&](P p) { return s(p) - std::min(-ra * limit, du - rb * limit) + slack; });
  keep([&](P p) { return std::max(ra * limit, du + rb * limit) - s(p) + slack; });
  return corners;
}

bool touches(const ScreenBlock& b, int x, int y, double slack) { return clipped(b, x, y, slack).size() >= 3; }

TEST(Coverage, AreasAreThoseOfThePolygon) {
  constexpr int kSize = 8;
  constexpr double kAreaError = 5e-5;  // single-precision coordinates of some tens of pixels, slopes below 2
  int whole = 0;
  for (std::uint32_t key = 0; key < 100000; ++key) {
    const ScreenBlock b = random_segment(key);
    double found[kSize][kSize] = {};
    walk_areas(band_at(b, 0), kSize, kSize,
               [&](int x, int y, float, float area, const PixelSides& p) { found[y][x] = area, whole += p.whole; });
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const std::vector<P> c = clipped(b, x, y, 0);
        double twice = 0;
        for (std::size_t i = 0; i < c.size(); ++i) {
          const P p = c[i], q = c[(i + 1) % c.size()];
          twice += (p.x - x) * (q.y - y) - (p.y - y) * (q.x - x);
        }
        ASSERT_NEAR(found[y][x], std::fabs(twice) / 2, kAreaError) << "segment " << key << ", pixel " << x << " " << y;
      }
  }
  EXPECT_GT(whole, 10000);
}

TEST(Coverage, ConservativeWalkVisitsExactlyWhatIsTouched) {
  constexpr int kSize = 8;
  constexpr double kRounding = 2e-5;  // pixels: single-precision coordinates of some tens of pixels
  int wrong = 0, touched = 0;
  for (std::uint32_t key = 0; key < 1000000 && wrong < 5; ++key) {
    const ScreenBlock b = random_segment(key);
    bool visited[kSize][kSize] = {};
    walk_touched(band_at(b, 0), kSize, kSize, [&](int x, int y, float) { visited[y][x] = true; });
    // Radii stay below 2, and reaches below 2 × 1.5: pixels further off need no look.
    const int x0 = static_cast<int>(std::min(b.x[0], b.x[1])) - 7, x1 = static_cast<int>(std::max(b.x[0], b.x[1])) + 7;
    const int y0 = static_cast<int>(std::min(b.y[0], b.y[1])) - 7, y1 = static_cast<int>(std::max(b.y[0], b.y[1])) + 7;
    for (int y = std::max(y0, 0); y < std::min(y1, kSize); ++y)
      for (int x = std::max(x0, 0); x < std::min(x1, kSize); ++x) {
        touched += visited[y][x];
        if (visited[y][x] ? !touches(b, x, y, kRounding) : touches(b, x, y, -kRounding)) {
          ++wrong;
          ADD_FAILURE() << "segment " << key << ", pixel " << x << " " << y << ": visited " << visited[y][x];
        }
      }
  }
  EXPECT_GT(touched, 1000000);
}

TEST(Coverage, CentersAndSamplesAreWhatTheDefinitionCovers) {
  constexpr int kSize = 8;
  constexpr double kRounding = 2e-5;
  for (std::uint32_t key = 0; key < 200000; ++key) {
    const ScreenBlock b = random_segment(key);
    bool center[kSize][kSize] = {}, touched[kSize][kSize] = {};
    walk_centers(band_at(b, 0), kSize, kSize, [&](int x, int y, float depth) {
      center[y][x] = true;
      ASSERT_TRUE(depth >= std::min(b.depth[0], b.depth[1]) && depth <= std::max(b.depth[0], b.depth[1]));
    });
    walk_touched(band_at(b, 0), kSize, kSize, [&](int x, int y, float) { touched[y][x] = true; });
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        ASSERT_TRUE(touched[y][x] || !center[y][x]) << "segment " << key;
        if (center[y][x]) ASSERT_TRUE(covers(b, 0, x + 0.5, y + 0.5, kRounding)) << "segment " << key;
        else ASSERT_FALSE(covers(b, 0, x + 0.5, y + 0.5, -kRounding)) << "segment " << key;
      }
    const Vec2 at(0.8125f, 0.1875f);
    bool sample[kSize][kSize] = {};
    walk_samples(band_at(b, 0), kSize, kSize, &at, 1, [&](int x, int y, float, std::uint32_t) { sample[y][x] = true; });
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        if (sample[y][x]) ASSERT_TRUE(covers(b, 0, x + at.x, y + at.y, kRounding)) << "segment " << key;
        else ASSERT_FALSE(covers(b, 0, x + at.x, y + at.y, -kRounding)) << "segment " << key;
      }
  }
}

}  // namespace
}  // namespace pelage
