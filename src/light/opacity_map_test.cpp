// Deep opacity maps against closed forms and against counting crossings one by one.
#include "light/opacity_map.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "frame/light_lookup.h"
#include "kernel/scalar.h"
#include "light/light_view.h"

namespace pelage {
namespace {

struct Straight {
  Vec3 from, to;
};

GroomInstance groom_of(const std::vector<Straight>& lines, float width) {
  auto set = std::make_shared<StrandSet>();
  set->basis = CurveBasis::kLinear;
  set->widths = {width};
  set->offsets = {0};
  for (const Straight& s : lines) {
    set->points.push_back(s.from), set->points.push_back(s.to);
    set->offsets.push_back(static_cast<std::uint32_t>(set->points.size()));
  }
  GroomInstance groom;
  groom.strands = set;
  return groom;
}

/// `count` strands of length 2 along x, at random y in [−1, 1] and z in [−depth, 0], seen from +z.
std::vector<Straight> slab(int count, float depth) {
  std::vector<Straight> lines;
  for (int i = 0; i < count; ++i) {
    Rng rng(7, static_cast<std::uint32_t>(i));
    const float y = 2 * rng.uniform() - 1, z = -depth * rng.uniform();
    lines.push_back({{-1, y, z}, {1, y, z}});
  }
  return lines;
}

std::vector<Straight> thicket(int count) {
  std::vector<Straight> lines;
  for (int i = 0; i < count; ++i) {
    Rng rng(11, static_cast<std::uint32_t>(i));
    const auto point = [&] { return Vec3(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1); };
    const Vec3 a = point();
    lines.push_back({a, point()});
  }
  return lines;
}

Light directional(Vec3 direction) {
  Light light;
  light.direction = normalize(direction);
  return light;
}

OpacityMap map_of(const GroomInstance& groom, const Light& light, int size) {
  const std::vector<GroomInstance> grooms{groom};
  const std::vector<StrandLines> lines = strand_lines(grooms);
  return build_opacity_map(lines, light_views(light, bounds(lines), size).front());
}

bool same(const OpacityMap& a, const OpacityMap& b) {
  return std::equal(a.crossings.begin(), a.crossings.end(), b.crossings.begin(), b.crossings.end()) &&
         std::equal(a.first_depth.begin(), a.first_depth.end(), b.first_depth.begin(), b.first_depth.end());
}

/// Whether the line through p along the unit vector d crosses the band of half width `radius` about a–b.
bool meets(Vec3 a, Vec3 b, Vec3 p, Vec3 d, float radius) {
  const Vec3 e = b - a, w = a - p;
  const Vec3 e2 = e - d * dot(e, d), w2 = w - d * dot(w, d);
  const float s = -dot(w2, e2) / dot(e2, e2);
  return s > 0 && s < 1 && length(w2 + e2 * s) < radius;
}

TEST(OpacityMap, SlabOfParallelStrandsHasTheClosedForm) {
  constexpr int kCount = 20000;
  constexpr float kWidth = 2e-3f, kDepth = 0.5f;
  const OpacityMap map = map_of(groom_of(slab(kCount, kDepth), kWidth), directional({0, 0, -1}), 64);
  for (const float share : {0.25f, 0.5f, 1.f}) {
    const float expected = kCount * kWidth / 2 * share;  // strands per metre of y, times width
    double mean = 0;
    int places = 0;
    for (float y = -0.8f; y < 0.8f; y += 0.02f)
      for (float x = -0.8f; x < 0.8f; x += 0.4f, ++places)
        mean += static_cast<double>(crossings_at(map, {x, y, -kDepth * share}));
    EXPECT_NEAR(mean / places, expected, 0.02 * expected) << share;
  }
  EXPECT_EQ(crossings_at(map, {0, 0, 1}), 0);
  EXPECT_EQ(crossings_at(map, {5, 0, -1}), 0);
}

// Bands of thick hairs are as wide as their sections and as deep as the fibers in them.
TEST(OpacityMap, ThickHairsCountTheirFibers) {
  constexpr int kCount = 20000;
  constexpr float kFiber = 2e-4f, kFibers = 5, kDepth = 0.5f;
  GroomInstance groom = groom_of(slab(kCount, kDepth), 1);  // the width on the screen plays no part
  ThickSections sections;
  const std::size_t points = groom.strands->point_count();
  sections.major.assign(points, {0, 0.01f, 0}), sections.minor.assign(points, {0, 0, 0.01f});
  sections.fibers.assign(points, kFibers), sections.diameters.assign(points, kFiber), sections.spreads.assign(points, 0);
  groom.sections = std::make_shared<const ThickSections>(std::move(sections));
  const OpacityMap map = map_of(groom, directional({0, 0, -1}), 64);
  const float expected = kCount * kFibers * kFiber / 2;
  EXPECT_NEAR(crossings_at(map, {0, 0, -kDepth}), expected, 0.05f * expected);
  EXPECT_NEAR(crossings_at(map, {0, 0, -kDepth / 2}), expected / 2, 0.05f * expected);
}

TEST(OpacityMap, MeanCrossingsEqualCountingRays) {
  const std::vector<Straight> lines = thicket(400);
  constexpr float kWidth = 0.02f;
  for (const Vec3 direction : {Vec3(0, 0, -1), Vec3(1, -2, 0.5f)}) {
    const Light light = directional(direction);
    for (const int size : {32, 256, 2048}) {  // strands thinner than a texel, wider, and so wide that they are drawn coarser
      const OpacityMap map = map_of(groom_of(lines, kWidth), light, size);
      double drawn = 0, counted = 0;
      for (int i = 0; i < 4000; ++i) {
        Rng rng(3, static_cast<std::uint32_t>(i));
        const Vec3 p{1.2f * rng.uniform() - 0.6f, 1.2f * rng.uniform() - 0.6f, 1.2f * rng.uniform() - 0.6f};
        drawn += static_cast<double>(crossings_at(map, p + light.direction * 10.f));
        for (const Straight& line : lines) counted += meets(line.from, line.to, p, light.direction, kWidth / 2);
      }
      EXPECT_NEAR(drawn / counted, 1, 0.03) << size;
    }
  }
}

// Bands of ten texels are drawn coarser, yet where they are: place by place, not only in the mean.
TEST(OpacityMap, WideBandsLieWhereRaysMeetThem) {
  const std::vector<Straight> lines = thicket(100);
  constexpr float kWidth = 0.04f;
  const Light light = directional({1, -2, 0.5f});
  const OpacityMap map = map_of(groom_of(lines, kWidth), light, 1024);
  ASSERT_GT(kWidth / texel_size(map.view, 1), 9);
  double error2 = 0, counts = 0, counts2 = 0;
  constexpr int kPlaces = 4000;
  for (int i = 0; i < kPlaces; ++i) {
    Rng rng(5, static_cast<std::uint32_t>(i));
    const Vec3 p{1.2f * rng.uniform() - 0.6f, 1.2f * rng.uniform() - 0.6f, 1.2f * rng.uniform() - 0.6f};
    double counted = 0;
    for (const Straight& line : lines) counted += meets(line.from, line.to, p, light.direction, kWidth / 2);
    const double error = static_cast<double>(crossings_at(map, p + light.direction * 10.f)) - counted;
    error2 += error * error, counts += counted, counts2 += counted * counted;
  }
  const double variance = counts2 / kPlaces - counts * counts / kPlaces / kPlaces;
  EXPECT_LT(error2 / kPlaces, 0.2 * variance);
}

TEST(OpacityMap, CrossingsGrowWithDepth) {
  const OpacityMap map = map_of(groom_of(thicket(300), 0.01f), directional({0, 0, -1}), 64);
  for (float x = -0.5f; x < 0.5f; x += 0.13f) {
    float before = 0;
    for (float z = 1.5f; z > -1.5f; z -= 0.01f) {
      const float n = crossings_at(map, {x, 0.3f, z});
      EXPECT_GE(n, before - 1e-5f);
      before = n;
    }
  }
}

TEST(OpacityMap, PointLightSpreadsWithDistance) {
  Light light;
  light.type = Light::Type::kPoint;
  light.position = {0, 0, 3};
  const OpacityMap map = map_of(groom_of(slab(20000, 0.5f), 2e-3f), light, 128);
  double mean = 0;
  int places = 0;
  for (float y = -0.5f; y < 0.5f; y += 0.01f, ++places) mean += static_cast<double>(crossings_at(map, {0.1f, y, -0.5f}));
  // A ray at the angle θ in the y–z plane passes density·width/cos θ·cos θ of strands along x: as straight ahead.
  EXPECT_NEAR(mean / places, 20, 0.6);
}

TEST(OpacityMap, StridedStrandsCountForThoseLeftOut) {
  GroomInstance groom = groom_of(slab(20000, 0.5f), 2e-3f);
  const std::vector<GroomInstance> grooms{groom};
  const std::vector<StrandLines> all = strand_lines(grooms);
  const CameraView view = light_views(directional({0, 0, -1}), bounds(all), 32).front();
  const OpacityMap map = build_opacity_map(all, view, {8});
  double mean = 0;
  int places = 0;
  for (float y = -0.8f; y < 0.8f; y += 0.01f, ++places) mean += static_cast<double>(crossings_at(map, {0, y, -0.5f}));
  EXPECT_NEAR(mean / places, 20, 1);
}

TEST(OpacityMap, StrideIsBlindToPatternsInTheOrderOfStrands) {
  // Every fourth strand lies in front, the others behind: a fixed stride would see only one kind.
  std::vector<Straight> lines = slab(40000, 0);
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].from.z = lines[i].to.z = i % 4 == 0 ? 0 : -0.5f;
  const std::vector<GroomInstance> grooms{groom_of(lines, 1e-3f)};
  const std::vector<StrandLines> all = strand_lines(grooms);
  const CameraView view = light_views(directional({0, 0, -1}), bounds(all), 64).front();
  const OpacityMap full = build_opacity_map(all, view), thin = build_opacity_map(all, view, {4});
  double full_front = 0, thin_front = 0, full_all = 0, thin_all = 0, error2 = 0;
  for (float y = -0.8f; y < 0.8f; y += 0.01f) {
    const Vec3 front{0, y, -0.4f}, back{0, y, -1};
    full_front += static_cast<double>(crossings_at(full, front)), thin_front += static_cast<double>(crossings_at(thin, front));
    const double a = static_cast<double>(crossings_at(full, back)), b = static_cast<double>(crossings_at(thin, back));
    full_all += a, thin_all += b, error2 += (b / a - 1) * (b / a - 1) / 160;
  }
  EXPECT_NEAR(thin_front / full_front, 1, 0.04);
  EXPECT_NEAR(thin_all / full_all, 1, 0.03);
  EXPECT_LT(std::sqrt(error2), 0.08);  // one texel's row has 625 strands, a quarter of which is drawn: 1/√156
}

TEST(OpacityMap, MapsDrawnTogetherAreThoseDrawnAlone) {
  const std::vector<GroomInstance> grooms{groom_of(thicket(2000), 0.003f)};
  const std::vector<StrandLines> all = strand_lines(grooms);
  std::vector<CameraView> views;
  for (const Vec3 d : {Vec3(0, 0, -1), Vec3(1, 0.3f, 0), Vec3(0.2f, -1, 0.1f)})
    views.push_back(light_views(directional(d), bounds(all), 96).front());
  const std::vector<OpacityMap> maps = build_opacity_maps(all, views);
  ASSERT_EQ(maps.size(), views.size());
  for (std::size_t i = 0; i < views.size(); ++i) EXPECT_TRUE(same(maps[i], build_opacity_map(all, views[i]))) << i;
}

TEST(OpacityMap, SameBitsForAnyThreadsAndInstructionSet) {
  const GroomInstance groom = groom_of(thicket(3000), 0.003f);
  const Light light = directional({0.3f, -1, 0.2f});
  set_thread_count(1);
  const OpacityMap one = map_of(groom, light, 128);
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    EXPECT_TRUE(same(one, map_of(groom, light, 128))) << threads;
  }
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_TRUE(same(one, map_of(groom, light, 128))) << isa;
  }
  set_isa("");
  set_thread_count(0);
}

// Threads have sheets of their own, as many as memory allows, else all have one; of every level that wide bands are drawn into.
TEST(OpacityMap, SheetsOfThreadsSumToTheSheetOfAll) {
  const std::vector<Straight> lines = thicket(8000);
  const Light light = directional({0.3f, -1, 0.2f});
  set_thread_count(1);
  const OpacityMap one = map_of(groom_of(lines, 0.04f), light, 512);
  for (const int threads : {4, 70}) {  // 4 MiB a sheet
    set_thread_count(threads);
    EXPECT_TRUE(same(one, map_of(groom_of(lines, 0.04f), light, 512))) << threads;
  }
  set_thread_count(0);
}

// Strands across a plane, one crossing every 5 widths: those on both of two ways of `length` widths that part by `angle`, counted on a grid.
TEST(Opacity, SharedCrossingsAreThoseOnBothWays) {
  constexpr float kPerWidth = 0.2f, kStep = 0.01f;
  for (const float length : {2.f, 8.f, 30.f}) {
    for (const float angle : {0.f, 0.02f, 0.1f, 0.3f}) {
      double area = 0;
      for (float along = 0.5f * kStep; along < length; along += kStep)
        for (float aside = -0.5f + 0.5f * kStep; aside < 0.5f; aside += kStep)
          if (std::fabs(aside * std::cos(angle) - along * std::sin(angle)) < 0.5f) area += static_cast<double>(kStep * kStep);
      const float parting = 2 * std::sin(0.5f * angle) / kPerWidth;
      EXPECT_NEAR(kernel::light_shared_crossings(kPerWidth * length, parting), kPerWidth * area, 0.02)
          << length << " widths, " << angle;
    }
  }
}

TEST(OpacityMap, NoStrandsGiveAnEmptyMap) {
  std::vector<GroomInstance> grooms(1);
  grooms[0].strands = std::make_shared<StrandSet>();
  const OpacityMap map = build_opacity_map(strand_lines(grooms), CameraView{});
  EXPECT_TRUE(map.crossings.empty());
  EXPECT_EQ(crossings_at(map, {0, 0, 0}), 0);
}

}  // namespace
}  // namespace pelage
