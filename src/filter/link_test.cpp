// Strand linking on made-up samples and on real ones.
#include "filter/link.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "kernel/scalar.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

/// Polylines on the screen: primitive p is the piece from corner p to corner p + 1, of the strand that holds it.
class Polylines final : public StrandCurves {
 public:
  struct Strand {
    std::vector<Vec2> corners;
    float depth;
  };
  explicit Polylines(std::vector<Strand> strands) : strands_(std::move(strands)) {}
  std::uint32_t first(std::size_t strand) const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < strand; ++i) n += strands_[i].corners.size();
    return static_cast<std::uint32_t>(n);
  }
  StrandCurve curve_of(std::uint32_t primitive) const override {
    std::uint32_t i = 0;
    while (i + 1 < strands_.size() && first(i + 1) <= primitive) ++i;
    return {first(i), 0, i, static_cast<float>(strands_[i].corners.size() - 1)};
  }
  bool at(StrandCurve& curve, float s, CurvePoint& point) const override {
    const auto& corners = strands_[curve.strand].corners;
    const std::size_t i = std::min(static_cast<std::size_t>(s), corners.size() - 2);
    const Vec2 d = corners[i + 1] - corners[i];
    point.screen = corners[i] + d * (s - static_cast<float>(i));
    point.depth = strands_[curve.strand].depth;
    point.tangent = length(d) > 0 ? d * (1 / length(d)) : Vec2();
    return true;
  }
  float step(StrandCurve& curve, float s, float, float pixels) const override {
    const auto& corners = strands_[curve.strand].corners;
    const std::size_t i = std::min(static_cast<std::size_t>(s), corners.size() - 2);
    const float chord = length(corners[i + 1] - corners[i]);
    return chord > 0 ? pixels / chord : 1;
  }

 private:
  std::vector<Strand> strands_;
};

StrandLayer empty_layer(int width, int height) {
  StrandLayer layer;
  layer.width = width, layer.height = height;
  const std::size_t n = static_cast<std::size_t>(width * height);
  layer.visibility.resize(n), layer.depth.resize(n), layer.color.resize(n);
  layer.visibility.fill({}), layer.depth.fill(INFINITY), layer.color.fill({});
  layer.hair = PixelMask(width, height);
  return layer;
}

std::size_t at(const StrandLayer& layer, int x, int y) { return static_cast<std::size_t>(y * layer.width + x); }
/// Of the picture's pixel that holds a place.
std::size_t at(const StrandLayer& layer, Vec2 screen) {
  return at(layer, static_cast<int>(screen.x) - layer.left, static_cast<int>(screen.y) - layer.top);
}

/// Enters a sample of strand `strand` of `curves` at parameter s into the pixel where it is.
std::size_t hit(StrandLayer& layer, const Polylines& curves, std::uint32_t strand, float s, Vec3 color = {1, 0.5f, 0.25f}) {
  StrandCurve curve = curves.curve_of(curves.first(strand));
  CurvePoint point;
  EXPECT_TRUE(curves.at(curve, s, point));
  const std::size_t p = at(layer, point.screen);
  float t = 0;
  const std::uint32_t primitive = StrandCurves::primitive_at(curve, s, t);
  layer.visibility[p] = pack_visibility(point.tangent, t, primitive, false);
  layer.depth[p] = point.depth, layer.color[p] = color, layer.hair.add(p);
  return p;
}

/// The pixels that are filled, as "#"; hits "o", others ".".
std::string picture(const StrandLayer& layer) {
  std::string text;
  for (int y = 0; y < layer.height; ++y, text += '\n')
    for (int x = 0; x < layer.width; ++x) {
      const VisibilitySample& v = layer.visibility[at(layer, x, y)];
      text += v.is_filled() ? '#' : v.is_hair() ? 'o' : '.';
    }
  return text;
}

TEST(VisibilitySample, KeepsItsFields) {
  const VisibilitySample v = pack_visibility({0.6f, -0.8f}, 0.25f, VisibilitySample::kMaxPrimitive, true);
  EXPECT_TRUE(v.is_hair() && v.is_filled());
  EXPECT_EQ(v.primitive(), VisibilitySample::kMaxPrimitive);
  EXPECT_EQ(v.tangent(), Vec2(0.6f, -0.8f));
  EXPECT_EQ(dot(v.tangent(), Vec2(v.normal_x, v.normal_y)), 0.f);
  EXPECT_FALSE(pack_visibility({1, 0}, 0, 7, false).is_filled());
  EXPECT_FALSE(VisibilitySample().is_hair());
}

// Eq. 4, written once more: |cos| times a Gaussian.
TEST(Alignment, IsThatOfThePaper) {
  Rng rng(1, 2);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 offset(2 * rng.uniform() - 1, 2 * rng.uniform() - 1);
    const float angle = 6.2832f * rng.uniform(), sigma = 0.5f + rng.uniform();
    const Vec2 tangent(std::cos(angle), std::sin(angle));
    const double d = std::hypot(static_cast<double>(offset.x), static_cast<double>(offset.y));
    const double expected =
        std::abs(static_cast<double>(dot(offset, tangent))) / d * std::exp(-d * d / (2.0 * static_cast<double>(sigma * sigma)));
    EXPECT_NEAR(kernel::filter_alignment(offset, tangent, sigma), expected, 1e-5);
    EXPECT_EQ(kernel::filter_alignment(offset, tangent, sigma), kernel::filter_alignment(offset, tangent * -1.f, sigma));
  }
  // The choice of sigma: with 1 a diagonal neighbor never passes an alignment of a half, with the root of 2 it does.
  EXPECT_LT(kernel::filter_alignment({1, 1}, Vec2(0.70710678f, 0.70710678f), 1.f), 0.5f);
  EXPECT_GT(kernel::filter_alignment({1, 1}, Vec2(0.70710678f, 0.70710678f), LinkSettings().sigma), 0.5f);
}

TEST(Link, FillsTheGapsOfAStrandToItsEnds) {
  const Polylines curves({{{{2.5f, 3.5f}, {6.5f, 3.5f}, {12.5f, 3.5f}}, 1}});
  StrandLayer layer = empty_layer(16, 7);
  hit(layer, curves, 0, 0.75f), hit(layer, curves, 0, 1.5f);
  const Links links = link_strands(layer, curves, {});
  EXPECT_EQ(picture(layer),
            "................\n................\n................\n..###o###o###...\n................\n................\n......"
            "..........\n");
  EXPECT_EQ(links.fills.size(), 9u);
  for (const Fill& fill : links.fills) {
    const VisibilitySample& v = layer.visibility[fill.pixel];
    EXPECT_EQ(v.primitive(), fill.pixel % 16 < 6 ? 0u : 1u);
    const float x = v.primitive() == 0 ? 2.5f + 4 * v.t : 6.5f + 6 * v.t;  // the place is that of the strand in that pixel
    EXPECT_EQ(static_cast<std::uint32_t>(x), fill.pixel % 16);
    EXPECT_EQ(layer.color[fill.pixel], layer.color[fill.source]);
    EXPECT_EQ(layer.depth[fill.pixel], 1.f);
  }
}

TEST(Link, StopsAtOtherSamplesAndAtTheBorder) {
  const Polylines curves({{{{-3, 2.5f}, {20, 2.5f}}, 2}, {{{8.5f, 0.5f}, {8.5f, 4.5f}}, 1}});
  StrandLayer layer = empty_layer(12, 5);
  hit(layer, curves, 0, 7.5f / 23), hit(layer, curves, 1, 0.5f);
  link_strands(layer, curves, {});
  EXPECT_EQ(picture(layer), "........#...\n........#...\n####o###o...\n........#...\n........#...\n");
}

// A layer may be a part of the picture: strands stay where they are.
TEST(Link, FillsTheSameInAPartOfThePicture) {
  const Polylines curves({{{{10.5f, 21.5f}, {19.5f, 22.5f}}, 2}, {{{14.5f, 20.5f}, {14.5f, 24.5f}}, 1}});
  StrandLayer whole = empty_layer(40, 30), part = empty_layer(14, 7);
  part.left = 8, part.top = 20;
  for (StrandLayer* layer : {&whole, &part}) {
    hit(*layer, curves, 0, 0.2f), hit(*layer, curves, 0, 0.8f), hit(*layer, curves, 1, 0.6f);
    EXPECT_GT(link_strands(*layer, curves, {}).fills.size(), 8u);
  }
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) {
      const VisibilitySample &a = part.visibility[at(part, x, y)], &b = whole.visibility[at(whole, x + 8, y + 20)];
      EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << x << " " << y;
    }
}

TEST(Link, StaysBehindTheOpaqueScene) {
  const Polylines curves({{{{0.5f, 1.5f}, {9.5f, 1.5f}}, 2}});
  StrandLayer layer = empty_layer(10, 3);
  layer.opaque_depth.resize(30);
  layer.opaque_depth.fill(INFINITY);
  for (const int x : {5, 6}) layer.opaque_depth[at(layer, x, 1)] = 1.5f;
  layer.opaque_depth[at(layer, 7, 1)] = 2.5f;
  hit(layer, curves, 0, 2.f / 9);
  link_strands(layer, curves, {});
  EXPECT_EQ(picture(layer), "..........\n##o##..###\n..........\n");
}

TEST(Link, DoesNotFollowStrandsThatDoNotFit) {
  const Polylines across({{{{4.5f, 0.5f}, {4.5f, 0.5f}}, 1}});  // seen end-on
  StrandLayer layer = empty_layer(9, 3);
  const std::size_t p = hit(layer, across, 0, 0.5f);
  EXPECT_EQ(link_strands(layer, across, {}).candidates, 0u);
  EXPECT_TRUE(layer.visibility[p].is_hair());
  StrandLayer none = empty_layer(5, 1);
  EXPECT_TRUE(link_strands(none, across, {}).fills.empty());
  StrandLayer full = empty_layer(1, 1);
  const Polylines dot({{{{0.2f, 0.5f}, {0.9f, 0.5f}}, 1}});
  hit(full, dot, 0, 0.5f);
  EXPECT_TRUE(link_strands(full, dot, {}).fills.empty());
}

/// Seen end-on in its middle, a strand does not make the walk stall or jump.
TEST(Link, WalksOverPlacesThatAreSeenEndOn) {
  const Polylines curves({{{{1.5f, 1.5f}, {5.5f, 1.5f}, {5.5f, 1.5f}, {9.5f, 1.5f}}, 1}});
  StrandLayer layer = empty_layer(11, 3);
  hit(layer, curves, 0, 0.25f);
  link_strands(layer, curves, {});
  EXPECT_EQ(picture(layer), "...........\n.#o#######.\n...........\n");
}

// Of two strands that want a pixel the better aligned has it, of equal ones the nearer, in whatever order they come.
TEST(Link, SettlesConflictsByScoreThenDepth) {
  for (const bool swapped : {false, true}) {
    std::vector<Polylines::Strand> strands{{{{0.5f, 2.5f}, {8.5f, 2.5f}}, 2}, {{{8.5f, 2.5f}, {0.5f, 2.5f}}, 1}};
    if (swapped) std::swap(strands[0], strands[1]);
    const Polylines curves(strands);
    StrandLayer layer = empty_layer(9, 5);
    hit(layer, curves, 0, 1.f / 8), hit(layer, curves, 1, 1.f / 8);
    link_strands(layer, curves, {});
    for (int x = 2; x < 7; ++x) EXPECT_EQ(layer.depth[at(layer, x, 2)], 1.f) << x << swapped;
  }
}

// A strand far behind does not claim a pixel beside one in front, if depth counts; as published it does.
TEST(Link, DepthContinuityPrefersTheFront) {
  const Polylines curves({{{{0.5f, 2.5f}, {8.5f, 2.5f}}, 2}, {{{0.5f, 0.2f}, {8.5f, 4.2f}}, 1}});
  LinkSettings by_depth;
  by_depth.depth_sigma = 0.2f;
  for (const auto& [settings, depth] : {std::pair{LinkSettings(), 2.f}, std::pair{by_depth, 1.f}}) {
    StrandLayer layer = empty_layer(9, 5);
    hit(layer, curves, 0, 3.f / 8), hit(layer, curves, 1, 3.f / 8);
    link_strands(layer, curves, settings);
    EXPECT_EQ(layer.depth[at(layer, 4, 2)], depth);
  }
}

/// Eq. 4 and 5, then every walk in steps of a hundredth of a pixel: slow and obvious. Which pixels may be filled at all.
std::map<std::size_t, bool> reachable(const StrandLayer& layer, const StrandCurves& curves) {
  std::map<std::size_t, bool> found;
  for (int y = 0; y < layer.height; ++y)
    for (int x = 0; x < layer.width; ++x) {
      if (layer.visibility[at(layer, x, y)].is_hair()) continue;
      float best = 0.5f;
      std::size_t source = 0;
      Vec2 way;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          if (x + i < 0 || y + j < 0 || x + i >= layer.width || y + j >= layer.height) continue;
          const VisibilitySample& v = layer.visibility[at(layer, x + i, y + j)];
          const Vec2 offset(static_cast<float>(-i), static_cast<float>(-j));
          if (!v.is_hair() || (!i && !j)) continue;
          const float score = std::fabs(dot(offset, v.tangent())) / length(offset) * std::exp(-dot(offset, offset) / 4);
          if (score > best + 1e-6f) best = score, source = at(layer, x + i, y + j), way = offset;
        }
      if (best == 0.5f) continue;
      const VisibilitySample& v = layer.visibility[source];
      StrandCurve curve = curves.curve_of(v.primitive());
      const float sign = dot(way, v.tangent()) > 0 ? 1.f : -1.f;
      float s = static_cast<float>(v.primitive() - curve.first_primitive) + v.t;
      for (CurvePoint p; s >= 0 && s <= curve.end && curves.at(curve, s, p);
           s += sign * curves.step(curve, s, p.depth, 0.01f)) {
        if (!(p.screen.x >= 0 && p.screen.y >= 0 && p.screen.x < static_cast<float>(layer.width) &&
              p.screen.y < static_cast<float>(layer.height)))
          break;
        const std::size_t pixel = at(layer, static_cast<int>(p.screen.x), static_cast<int>(p.screen.y));
        if (pixel != source && layer.visibility[pixel].is_hair()) break;
        if (pixel != source) found[pixel] = true;
      }
    }
  return found;
}

TEST(Link, FillsWhatASlowWalkReaches) {
  int filled = 0, missed = 0, unexpected = 0;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    Rng rng(9, seed);
    std::vector<Polylines::Strand> strands;
    for (int i = 0; i < 6; ++i) {
      Polylines::Strand strand{{}, 1 + rng.uniform()};
      Vec2 p(40 * rng.uniform(), 30 * rng.uniform());
      float angle = 6.2832f * rng.uniform();
      for (int k = 0; k < 6; ++k) {
        strand.corners.push_back(p);
        angle += rng.uniform() - 0.5f;
        p = p + Vec2(std::cos(angle), std::sin(angle)) * (2 + 6 * rng.uniform());
      }
      strands.push_back(strand);
    }
    const Polylines curves(strands);
    StrandLayer layer = empty_layer(40, 30);
    for (std::uint32_t i = 0; i < strands.size(); ++i)
      for (int k = 0; k < 8; ++k) {
        const float s = 5 * rng.uniform();
        CurvePoint p;
        StrandCurve curve = curves.curve_of(curves.first(i));
        curves.at(curve, s, p);
        if (p.screen.x >= 0 && p.screen.y >= 0 && p.screen.x < 40 && p.screen.y < 30 &&
            !layer.visibility[at(layer, static_cast<int>(p.screen.x), static_cast<int>(p.screen.y))].is_hair())
          hit(layer, curves, i, s);
      }
    const auto expected = reachable(layer, curves);
    link_strands(layer, curves, {});
    for (std::size_t p = 0; p < layer.visibility.size(); ++p)
      if (layer.visibility[p].is_filled()) {
        ++filled;
        unexpected += !expected.count(p);
      } else if (expected.count(p)) {
        ++missed;
      }
  }
  EXPECT_GT(filled, 1000);
  // Steps of a pixel leave out some of the pixels that a strand only cuts the corner of: they do not fill them, nor do they stop
  // at samples there.
  EXPECT_LT(unexpected, filled / 50);
  EXPECT_LT(missed, filled / 3);
}

TEST(Link, SameBitsForAnyThreads) {
  Rng rng(3, 3);
  std::vector<Polylines::Strand> strands;
  for (int i = 0; i < 200; ++i)
    strands.push_back(
        {{{100 * rng.uniform(), 90 * rng.uniform()}, {100 * rng.uniform(), 90 * rng.uniform()}}, 1 + rng.uniform()});
  const Polylines curves(strands);
  const auto linked = [&](int threads) {
    set_thread_count(threads);
    StrandLayer layer = empty_layer(100, 90);
    for (std::uint32_t i = 0; i < strands.size(); ++i)
      for (const float s : {0.2f, 0.5f, 0.9f}) hit(layer, curves, i, s, {static_cast<float>(i), 1, 1});
    link_strands(layer, curves, {});
    set_thread_count(0);
    return layer;
  };
  const StrandLayer one = linked(1);
  for (const int threads : {2, 3, 5}) {
    const StrandLayer many = linked(threads);
    EXPECT_EQ(std::memcmp(one.visibility.data(), many.visibility.data(), one.visibility.size() * sizeof(VisibilitySample)), 0);
    EXPECT_EQ(std::memcmp(one.color.data(), many.color.data(), one.color.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(std::memcmp(one.depth.data(), many.depth.data(), one.depth.size() * sizeof(float)), 0);
  }
}

// The curves of a groom are where its surfaces are, and a step of one pixel moves one where the strand lies across the view.
TEST(GroomCurves, AreTheStrandsOfTheScene) {
  Scene scene = test::hairy_scene(200, 150);
  const CameraView view = make_camera_view(scene.camera, 200, 150);
  const GroomCurves curves(scene, view);
  const SegmentNumbering spans = number_spans(scene);
  for (std::uint32_t primitive : {0u, 1u, 14u, 16u * 33u + 5u, 16u * 299u}) {
    StrandCurve curve = curves.curve_of(primitive);
    EXPECT_EQ(curve.strand, primitive / 16);
    EXPECT_EQ(curve.end, 15.f);
    CurvePoint point, next;
    const float s = static_cast<float>(primitive % 16) + 0.25f;
    ASSERT_TRUE(curves.at(curve, s, point));
    const StrandSurface surface = surface_at(scene, spans, find_segment(scene, spans, primitive), 0.25f);
    const Vec3 c = transform_point(view.world_to_camera, surface.position);
    EXPECT_NEAR(point.screen.x, project(view, c).x, 1e-3f);
    EXPECT_NEAR(point.screen.y, project(view, c).y, 1e-3f);
    ASSERT_TRUE(curves.at(curve, s + 0.001f, next));
    const Vec2 moved = (next.screen - point.screen) * (1 / length(next.screen - point.screen));
    EXPECT_GT(dot(moved, point.tangent), 0.999f);
    EXPECT_GT(curves.step(curve, s, point.depth, 1), 0.f);
  }
}

}  // namespace
}  // namespace pelage
