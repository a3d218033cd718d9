#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "groom/benchmark_grooms.h"
#include "groom/collide.h"
#include "groom/head_shape.h"
#include "groom/scalp.h"

namespace pelage {
namespace {

constexpr HairStyle kStyles[] = {HairStyle::kStraight, HairStyle::kWavy,     HairStyle::kCurly,
                                 HairStyle::kAfro,     HairStyle::kPonytail, HairStyle::kCoat};
constexpr HairStyle kLongStyles[] = {HairStyle::kStraight, HairStyle::kWavy, HairStyle::kCurly};

const TriangleMesh& head() {
  static const TriangleMesh mesh = mannequin_head();
  return mesh;
}

GrowSettings small(HairStyle style, int strands = 800) {
  GrowSettings s = grow_defaults(style);
  s.strands = strands;
  s.clumps = std::min(s.clumps, strands / 4);
  return s;
}

/// Square of 1 m in the plane y = 0, facing up.
TriangleMesh square() {
  TriangleMesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}};
  m.triangles = {{0, 1, 2}, {0, 2, 3}};
  return m;
}

double strand_length(const StrandSet& s, std::size_t strand) {
  double sum = 0;
  for (std::size_t i = s.offsets[strand]; i + 1 < s.offsets[strand + 1]; ++i)
    sum += static_cast<double>(length(s.points[i + 1] - s.points[i]));
  return sum;
}

struct Moments {
  double mean, deviation;
};
Moments moments(const std::vector<double>& x) {
  const double n = static_cast<double>(x.size()), mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  double variance = 0;
  for (const double v : x) variance += (v - mean) * (v - mean) / n;
  return {mean, std::sqrt(variance)};
}

void expect_same_bits(const StrandSet& a, const StrandSet& b) {
  EXPECT_TRUE(a.points == b.points);
  EXPECT_EQ(a.offsets, b.offsets);
  EXPECT_EQ(a.widths, b.widths);
  EXPECT_TRUE(a.root_uv == b.root_uv);
  EXPECT_EQ(a.strand_id, b.strand_id);
  EXPECT_EQ(a.guide_id, b.guide_id);
  EXPECT_EQ(a.group, b.group);
}

std::string message_of(const GrowSettings& settings, const TriangleMesh& mesh) {
  try {
    grow(settings, mesh);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Grow, SameBitsForAnyThreadCount) {
  for (const HairStyle style : kStyles) {
    set_thread_count(1);
    const StrandSet one = grow(small(style), head());
    set_thread_count(2);
    const StrandSet two = grow(small(style), head());
    set_thread_count(0);
    expect_same_bits(one, two);
  }
}

TEST(Grow, SeedsDiffer) {
  GrowSettings s = small(HairStyle::kCurly);
  const StrandSet a = grow(s, head());
  s.seed += std::uint64_t{1} << 40;  // the high half counts too
  const StrandSet b = grow(s, head());
  EXPECT_FALSE(a.points == b.points);
  std::size_t same_root = 0;
  for (std::size_t i = 0; i < a.strand_count(); ++i)
    for (std::size_t j = 0; j < b.strand_count(); ++j) same_root += a.points[a.offsets[i]] == b.points[b.offsets[j]];
  EXPECT_EQ(same_root, 0u) << "hair stands elsewhere, not only differently";
}

TEST(Grow, EveryStyleKeepsTheInvariants) {
  for (const HairStyle style : kStyles) {
    for (const int points : {4, 33}) {
      GrowSettings s = small(style, 501);
      s.points = points;
      const StrandSet hair = grow(s, head());
      validate(hair, "grow");
      ASSERT_EQ(hair.strand_count(), 501u);
      ASSERT_EQ(hair.point_count(), 501u * static_cast<std::size_t>(points));
      ASSERT_EQ(hair.widths.size(), hair.point_count());
      ASSERT_EQ(hair.root_uv.size(), 501u);
      std::vector<std::uint32_t> ids = hair.strand_id;
      std::sort(ids.begin(), ids.end());
      for (std::uint32_t i = 0; i < ids.size(); ++i) ASSERT_EQ(ids[i], i);
      EXPECT_TRUE(std::is_sorted(hair.guide_id.begin(), hair.guide_id.end()));
      EXPECT_GE(hair.guide_id.front(), 0);
      EXPECT_LT(hair.guide_id.back(), s.clumps);
      for (const std::uint16_t group : hair.group) EXPECT_LE(group, static_cast<std::uint16_t>(HairGroup::kWool));
    }
  }
}

TEST(Grow, OneStrand) {
  for (const HairStyle style : kStyles) {
    GrowSettings s = grow_defaults(style);
    s.strands = 1;
    const StrandSet hair = grow(s, head());
    validate(hair, "grow");
    EXPECT_EQ(hair.strand_count(), 1u);
  }
}

TEST(Grow, RootsStandOnTheScalp) {
  const StrandSet hair = grow(small(HairStyle::kStraight, 3000), head());
  for (std::size_t i = 0; i < hair.strand_count(); ++i) {
    const Vec3 root = hair.points[hair.offsets[i]];
    EXPECT_LT(std::abs(groom::head_distance(root)), 1.5e-3f);  // chords of the mesh
    EXPECT_GT(groom::hairline_distance(root), -2e-3f);
    const Vec2 uv = groom::head_uv(root);
    EXPECT_NEAR(hair.root_uv[i].x, uv.x, 0.02f);
    EXPECT_NEAR(hair.root_uv[i].y, uv.y, 0.02f);
  }
}

TEST(Grow, HairKnowsTheHeadItGrewOn) {
  for (const HairStyle style : kStyles) EXPECT_TRUE(grown_on_mannequin(grow(small(style), head()))) << static_cast<int>(style);
  EXPECT_FALSE(grown_on_mannequin(grow(small(HairStyle::kCoat), square())));
  EXPECT_FALSE(grown_on_mannequin(StrandSet()));
  const StrandSet hair = grow(small(HairStyle::kStraight), head());
  const auto changed = [&](auto change) {
    StrandSet other = hair;
    for (Vec3& p : other.points) p = change(p);
    return grown_on_mannequin(other);
  };
  EXPECT_TRUE(changed([](Vec3 p) { return p + Vec3(2e-4f, 0, 0); }));  // as a coarse file format might
  EXPECT_FALSE(changed([](Vec3 p) { return p + Vec3(0, 0.01f, 0); }));
  EXPECT_FALSE(changed([](Vec3 p) { return p * 1.1f; }));
  EXPECT_FALSE(changed([](Vec3 p) { return Vec3(p.x, p.z, -p.y); }));
  EXPECT_FALSE(changed([](Vec3 p) { return Vec3(p.x, p.y, -p.z); })) << "hair in the face: skin, but no scalp";
}

TEST(Grow, StrandsStayOutsideTheHead) {
  for (const HairStyle style : kStyles) {
    const StrandSet hair = grow(small(style, 4000), head());
    std::size_t inside = 0;
    for (const Vec3 p : hair.points) inside += groom::head_distance(p) < -1e-3f;
    EXPECT_LE(static_cast<double>(inside), 1e-3 * static_cast<double>(hair.point_count())) << static_cast<int>(style);
  }
}

TEST(Grow, LongHairLeavesTheFaceFree) {
  for (const HairStyle style : kLongStyles)
    for (const float parting : {0.f, -0.05f, 0.05f}) {  // a side parting sends hair over the forehead
      GrowSettings s = small(style, 4000);
      s.parting = parting;
      const StrandSet hair = grow(s, head());
      std::size_t in_face = 0;
      for (const Vec3 p : hair.points) in_face += std::abs(p.x) < 0.045f && p.y > -0.11f && p.y < 0.045f && p.z > 0.07f;
      EXPECT_LE(static_cast<double>(in_face), 1e-3 * static_cast<double>(hair.point_count()))
          << static_cast<int>(style) << " parted at " << parting;
    }
}

TEST(Collide, PushesOutOfTheFaceByItsShare) {
  const Vec3 fringe(0, -0.03f, 0.2f), beside(0.2f, 0, 0);  // a hand before the nose; a shoulder away
  EXPECT_EQ(groom::push_out_of_face(beside, 1), beside);
  EXPECT_EQ(groom::push_out_of_face(fringe, 0), fringe);
  const Vec3 out = groom::push_out_of_face(fringe, 1), half = groom::push_out_of_face(fringe, 0.5f);
  const float way = length(out - fringe);
  EXPECT_GT(way, 0.02f);
  EXPECT_NEAR(length(half - fringe), way / 2, 1e-6f);
  EXPECT_LT(length(groom::push_out_of_face(out, 1) - out), 0.1f * way) << "nothing left to push";
  EXPECT_GT(groom::head_distance(out), 0.02f) << "well in front of the skin";
  for (const Vec3 temple : {Vec3(0.07f, 0, 0.09f), Vec3(-0.08f, -0.05f, 0.1f), Vec3(0, 0, 0.1f)}) {
    const Vec3 aside = groom::push_out_of_face(temple, 1);
    EXPECT_GT(length(aside - temple), 1e-3f);
    EXPECT_GE(aside.z, temple.z) << "back into the head";
    EXPECT_GE(std::abs(aside.x), std::abs(temple.x));
  }
}

TEST(Collide, TheShortestWayLeadsOutOfTheFace) {
  const auto depth = [](Vec3 p) { return length(groom::push_out_of_face(p, 1) - p); };
  constexpr float kStep = 1e-4f;
  int near_the_edge = 0;
  for (float x = -0.1f; x < 0.1f; x += 0.01f)
    for (float y = -0.2f; y < 0.1f; y += 0.01f)
      for (float z = 0.15f; z < 0.25f; z += 0.003f) {  // in front of the bulge's middle, where it is an ellipsoid
        const Vec3 p(x, y, z);
        if (depth(p) < 2 * kStep || depth(p) > 0.005f) continue;
        const Vec3 less(depth(p - Vec3(kStep, 0, 0)) - depth(p + Vec3(kStep, 0, 0)),
                        depth(p - Vec3(0, kStep, 0)) - depth(p + Vec3(0, kStep, 0)),
                        depth(p - Vec3(0, 0, kStep)) - depth(p + Vec3(0, 0, kStep)));
        EXPECT_GT(dot(normalize(less), normalize(groom::push_out_of_face(p, 1) - p)), 0.999f);
        ++near_the_edge;
      }
  EXPECT_GT(near_the_edge, 100);
}

TEST(Grow, LengthsAndWidthsMatchTheSettings) {
  for (const HairStyle style : {HairStyle::kStraight, HairStyle::kWavy, HairStyle::kCurly, HairStyle::kPonytail}) {
    const GrowSettings s = small(style, 6000);
    const StrandSet hair = grow(s, head());
    std::vector<double> lengths, widths;
    for (std::size_t i = 0; i < hair.strand_count(); ++i) {
      lengths.push_back(strand_length(hair, i));
      widths.push_back(static_cast<double>(hair.widths[hair.offsets[i]]));
      EXPECT_FLOAT_EQ(hair.widths[hair.offsets[i + 1] - 1], hair.widths[hair.offsets[i]] * (1 - s.taper));
    }
    const double length = static_cast<double>(s.length), width = static_cast<double>(s.width);
    EXPECT_NEAR(moments(lengths).mean / length, 1, 0.04) << static_cast<int>(style);
    EXPECT_NEAR(moments(lengths).deviation / length, static_cast<double>(s.length_variation), 0.02) << static_cast<int>(style);
    EXPECT_NEAR(moments(widths).mean / width, 1, 0.01);
    EXPECT_NEAR(moments(widths).deviation / width, static_cast<double>(s.width_variation), 0.01);
  }
}

TEST(Grow, FlyawaysAndWoolHaveTheirShares) {
  GrowSettings s = small(HairStyle::kCoat, 10000);
  s.flyaways = 0.1f, s.undercoat = 0.5f;
  std::map<std::uint16_t, int> count;
  for (const std::uint16_t group : grow(s, head()).group) ++count[group];
  EXPECT_NEAR(count[static_cast<std::uint16_t>(HairGroup::kFlyaway)], 1000, 120);
  EXPECT_NEAR(count[static_cast<std::uint16_t>(HairGroup::kWool)], 4500, 250);
}

/// Mean distance of tips from the middle of the tips of their lock.
double tip_spread(const StrandSet& hair) {
  std::map<std::int32_t, std::vector<Vec3>> locks;
  for (std::size_t i = 0; i < hair.strand_count(); ++i) locks[hair.guide_id[i]].push_back(hair.points[hair.offsets[i + 1] - 1]);
  double sum = 0;
  for (const auto& [guide, tips] : locks) {
    Vec3 middle;
    for (const Vec3 tip : tips) middle = middle + tip / static_cast<float>(tips.size());
    for (const Vec3 tip : tips) sum += static_cast<double>(length(tip - middle));
  }
  return sum / static_cast<double>(hair.strand_count());
}

TEST(Grow, TightClumpsMeetAtTheTips) {
  GrowSettings s = small(HairStyle::kStraight, 4000);
  s.length_variation = 0, s.frizz = 0, s.flyaways = 0, s.clumps = 200, s.clump_tightness = 0;
  const double loose = tip_spread(grow(s, head()));
  s.clump_tightness = 1;
  EXPECT_LT(tip_spread(grow(s, head())), 0.5 * loose);
}

TEST(Grow, PonytailPassesItsTie) {
  const StrandSet hair = grow(small(HairStyle::kPonytail, 2000), head());
  std::size_t tied = 0, passed = 0;
  for (std::size_t i = 0; i < hair.strand_count(); ++i) {
    if (hair.group[i] != static_cast<std::uint16_t>(HairGroup::kTail)) continue;
    ++tied;
    float nearest = INFINITY;
    for (std::size_t p = hair.offsets[i]; p < hair.offsets[i + 1]; ++p)
      nearest = std::min(nearest, length(hair.points[p] - Vec3(0, 0.058f, -0.122f)));
    passed += nearest < 0.02f;
  }
  EXPECT_GT(tied, 1900u);
  EXPECT_GT(passed, tied * 98 / 100);
}

TEST(Grow, GravityPullsTheTipsDown) {
  GrowSettings s = small(HairStyle::kStraight);
  const auto mean_height = [](const StrandSet& hair) {
    double sum = 0;
    for (std::size_t i = 0; i < hair.strand_count(); ++i) sum += static_cast<double>(hair.points[hair.offsets[i + 1] - 1].y);
    return sum / static_cast<double>(hair.strand_count());
  };
  s.gravity = 0;
  const double standing = mean_height(grow(s, head()));
  s.gravity = 1;
  EXPECT_LT(mean_height(grow(s, head())), standing - 0.1);
}

TEST(Grow, HoldsLittleMemory) {
  const StrandSet hair = grow(small(HairStyle::kStraight, 2000), head());
  EXPECT_LE(resident_bytes(hair), hair.point_count() * 17);
}

TEST(Grow, SettingsOutOfRangeAreNamed) {
  using Change = void (*)(GrowSettings&);
  const std::pair<const char*, Change> wrong[] = {
      {"strands", [](GrowSettings& s) { s.strands = 0; }},
      {"strands", [](GrowSettings& s) { s.strands = 1000001; }},
      {"points", [](GrowSettings& s) { s.points = 3; }},
      {"points", [](GrowSettings& s) { s.points = 1025; }},
      {"length", [](GrowSettings& s) { s.length = 0; }},
      {"length", [](GrowSettings& s) { s.length = std::numeric_limits<float>::quiet_NaN(); }},
      {"length_variation", [](GrowSettings& s) { s.length_variation = 0.6f; }},
      {"width", [](GrowSettings& s) { s.width = -1; }},
      {"width_variation", [](GrowSettings& s) { s.width_variation = -0.1f; }},
      {"taper", [](GrowSettings& s) { s.taper = 1.1f; }},
      {"curl_radius", [](GrowSettings& s) { s.curl_radius = -1; }},
      {"curl_pitch", [](GrowSettings& s) { s.curl_pitch = 0; }},
      {"clumps", [](GrowSettings& s) { s.clumps = -1; }},
      {"clump_tightness", [](GrowSettings& s) { s.clump_tightness = 2; }},
      {"frizz", [](GrowSettings& s) { s.frizz = 2; }},
      {"flyaways", [](GrowSettings& s) { s.flyaways = -1; }},
      {"gravity", [](GrowSettings& s) { s.gravity = INFINITY; }},
      {"volume", [](GrowSettings& s) { s.volume = -1; }},
      {"parting", [](GrowSettings& s) { s.parting = 0.2f; }},
      {"undercoat", [](GrowSettings& s) { s.undercoat = 2; }},
  };
  for (const auto& [name, change] : wrong) {
    GrowSettings s = small(HairStyle::kStraight, 10);
    change(s);
    const std::string message = message_of(s, head());
    EXPECT_NE(message.find(std::string("grow: ") + name + ": "), std::string::npos) << name << ": " << message;
    EXPECT_NE(message.find("…"), std::string::npos) << message;
  }
}

TEST(Grow, AnyMeshWithArea) {
  const GrowSettings s = small(HairStyle::kCoat, 300);
  TriangleMesh one = square();
  one.triangles.resize(1);
  TriangleMesh holed = square();
  holed.triangles.push_back({0, 0, 1}), holed.triangles.push_back({2, 2, 2});  // no area, no hair
  TriangleMesh fan = square();                                                 // three faces at one edge
  fan.positions.push_back({0.5f, 1, -0.5f});
  fan.triangles.push_back({0, 2, 4});
  for (const TriangleMesh& mesh : {one, holed, fan}) {
    const StrandSet hair = grow(s, mesh);
    validate(hair, "grow");
    EXPECT_EQ(hair.strand_count(), 300u);
  }
  for (const HairStyle style : kStyles) validate(grow(small(style, 100), one), "grow");
}

TEST(Grow, HairStandsOnTheOuterSide) {
  GrowSettings s = small(HairStyle::kCoat, 200);
  s.gravity = 0;
  const StrandSet hair = grow(s, square());
  for (std::size_t i = 0; i < hair.strand_count(); ++i) EXPECT_GT(hair.points[hair.offsets[i + 1] - 1].y, -1e-3f);
}

TEST(Grow, MeshesWithoutAreaAreErrors) {
  const GrowSettings s = small(HairStyle::kCoat, 10);
  EXPECT_NE(message_of(s, TriangleMesh()).find("no triangles"), std::string::npos);
  TriangleMesh flat = square();
  for (Vec3& p : flat.positions) p = {1, 2, 3};
  EXPECT_NE(message_of(s, flat).find("no area"), std::string::npos);
  TriangleMesh wild = square();
  wild.triangles[1][2] = 4;
  EXPECT_NE(message_of(s, wild).find("triangle 1"), std::string::npos);
  TriangleMesh nan = square();
  nan.positions[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message_of(s, nan).find("vertex 2"), std::string::npos);
}

TEST(Grow, ProgressRunsAndCancels) {
  double last = -1;
  grow(small(HairStyle::kStraight), head(), [&](std::string_view stage, double share) {
    EXPECT_EQ(stage, "grow");
    EXPECT_GE(share, last);
    last = share;
    return true;
  });
  EXPECT_EQ(last, 1);
  EXPECT_THROW(grow(small(HairStyle::kStraight), head(), [](std::string_view, double) { return false; }), Error);
}

TEST(Grow, StylesHaveNames) {
  for (std::size_t i = 0; i < hair_style_names().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(hair_style_from_name(hair_style_names()[i])), i);
  try {
    hair_style_from_name("ponytale");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("\"ponytail\""), std::string::npos) << e.what();
  }
}

TEST(Grow, BenchmarkGroomsAreWhatTheirNamesSay) {
  ASSERT_EQ(benchmark_grooms().size(), 3u);
  for (const BenchmarkGroom& groom : benchmark_grooms()) {
    EXPECT_EQ(groom.settings.strands, groom.name == "curly200k" ? 200000 : 50000);
    EXPECT_EQ(groom.settings.points, 64);
  }
  EXPECT_THROW(benchmark_groom("bald"), Error);
}

}  // namespace
}  // namespace pelage
