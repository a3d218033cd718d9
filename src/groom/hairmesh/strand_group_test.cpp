#include "groom/hairmesh/strand_group.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "groom/hairmesh/strand_traits.h"
#include "kernel/scalar.h"
#include "kit/test_hair_mesh.h"

namespace pelage {
namespace {

using Kind = StyleOperator::Kind;
using testing::every_operator;
using testing::small_hair_mesh;

struct D3 {
  double x, y, z;
};
D3 operator+(D3 a, D3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
D3 operator*(D3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double inner(D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
D3 unit(D3 a) { return a * (1 / std::sqrt(inner(a, a))); }
D3 outer(D3 a, D3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
D3 wide(Vec3 v) { return {v.x, v.y, v.z}; }
double smooth(double t) {
  t = std::fmin(std::fmax(t, 0), 1);
  return t * t * (3 - 2 * t);
}

// A strand as the paper tells it, in doubles: vertices and tangents of each layer interpolated across, then the Hermite basis
// functions along; straight on past the end.
struct Oracle {
  const HairMesh& mesh;
  const HairMesh::Bundle& bundle;
  const StrandTraits& traits;
  std::size_t lane;
  int points;

  static constexpr double kTurn = 2 * 3.14159265358979323846;
  int spans() const { return static_cast<int>(mesh.layers(bundle)) - 1; }
  D3 vertex(int column, int layer) const {
    return wide(mesh.positions[mesh.column_offsets[bundle.columns[static_cast<std::size_t>(column)]] +
                               static_cast<std::size_t>(layer)]);
  }
  D3 across(int layer, double u, double v) const {
    return (vertex(0, layer) * (1 - u) + vertex(1, layer) * u) * (1 - v) +
           (vertex(3, layer) * (1 - u) + vertex(2, layer) * u) * v;
  }
  D3 slope(int layer, double u, double v) const {
    const int before = std::max(layer - 1, 0), behind = std::min(layer + 1, spans());
    return (across(behind, u, v) + across(before, u, v) * -1) * (1. / (behind - before));
  }
  double edge(int layer, int axis) const {
    const D3 n = unit(vertex(1, layer) + vertex(0, layer) * -1 + vertex(2, layer) + vertex(3, layer) * -1);
    return axis == 0 ? n.x : axis == 1 ? n.y : n.z;
  }
  const StyleOperator* find(Kind kind) const {
    for (const StyleOperator& o : mesh.styles[bundle.style])
      if (o.kind == kind) return &o;
    return nullptr;
  }
  double onset(double w, const StyleOperator& o) const { return smooth((w - static_cast<double>(o.start)) / 0.25); }

  void place(double w, double& u, double& v) const {
    u = traits.u[lane], v = traits.v[lane];
    if (const StyleOperator* o = find(Kind::kClump)) {
      const double share = traits.clump[lane] * smooth((w - o->start) / (1 - o->start));
      u += (traits.clump_u[lane] - u) * share, v += (traits.clump_v[lane] - v) * share;
    }
    if (const StyleOperator* o = find(Kind::kBraid)) {
      const double lock = std::fmin(std::floor(u * 3), 2), angle = kTurn * (w * o->frequency + lock / 3);
      const double to_u = 0.5 + 0.32 * std::sin(angle) + (u * 3 - lock - 0.5) * traits.braid[lane];
      const double to_v = 0.5 + 0.2 * std::sin(2 * angle) + (v - 0.5) * traits.braid[lane], share = onset(w, *o);
      u += (to_u - u) * share, v += (to_v - v) * share;
    }
  }

  // Control point i of `points`: out of the bend by what chords cut off.
  D3 control_point(int i) const {
    const auto at = [&](int k) { return point(static_cast<double>(k) / (points - 1)); };
    if (i == 0 || i == points - 1) return at(i);
    return at(i) + (at(i - 1) + at(i) * -2 + at(i + 1)) * (-1. / 12);
  }

  D3 point(double share_of_strand) const {
    const double w = traits.length[lane] * share_of_strand, at = w * spans();
    const int k = std::min(static_cast<int>(std::floor(at)), spans() - 1);
    const double t = at - k, s = std::fmin(t, 1);
    double u, v;
    place(w, u, v);
    const D3 p0 = across(k, u, v), p1 = across(k + 1, u, v), m0 = slope(k, u, v), m1 = slope(k + 1, u, v);
    const D3 along =
        p0 * (6 * s * s - 6 * s) + m0 * (3 * s * s - 4 * s + 1) + p1 * (6 * s - 6 * s * s) + m1 * (3 * s * s - 2 * s);
    const D3 base = p0 * (2 * s * s * s - 3 * s * s + 1) + m0 * (s * s * s - 2 * s * s + s) + p1 * (3 * s * s - 2 * s * s * s) +
                    m1 * (s * s * s - s * s) + along * (t - s);
    const D3 tangent = unit(along);
    const auto side_at = [&](int axis) { return edge(k, axis) * (1 - s) + edge(k + 1, axis) * s; };
    const D3 side{side_at(0), side_at(1), side_at(2)};
    const D3 normal = unit(side + tangent * -inner(side, tangent)), binormal = outer(tangent, normal);
    return base + normal * shift(w).x + binormal * shift(w).y;
  }

  D3 shift(double w) const {
    double x = 0, y = 0;
    if (const StyleOperator* o = find(Kind::kWave)) {
      const double swing = onset(w, *o) * std::sin(kTurn * (w * o->frequency + traits.wave_phase[lane]));
      x += traits.wave_x[lane] * swing, y += traits.wave_y[lane] * swing;
    }
    if (const StyleOperator* o = find(Kind::kCurl)) {
      const double angle = kTurn * (w * o->frequency + traits.curl_phase[lane]);
      const double size = o->amount * onset(w, *o);
      x += size * std::cos(angle), y += size * std::sin(angle);
    }
    if (const StyleOperator* o = find(Kind::kNoise)) {
      const double u = traits.groom_u[lane], v = traits.groom_v[lane], phase = traits.noise_phase[lane];
      const double a = kTurn * (o->frequency * (0.82 * u + 0.39 * v + 0.42 * w) + phase);
      const double b = kTurn * (o->frequency * (-0.53 * u + 0.71 * v + 0.61 * w) + phase + 0.37);
      const double c = kTurn * (o->frequency * (0.31 * u - 0.88 * v + 0.97 * w) + phase + 0.71);
      const double size = o->amount * onset(w, *o) / 3;
      x += size * (std::sin(a) + std::sin(b) + std::sin(c)), y += size * (std::cos(a) + std::cos(b) + std::cos(c));
    }
    if (const StyleOperator* o = find(Kind::kFrizz)) {
      const double turns = w * o->frequency, size = traits.frizz[lane] * onset(w, *o);
      const double a = kTurn * (turns + traits.frizz_a[lane]), b = kTurn * (1.71 * turns + traits.frizz_b[lane]);
      const double c = kTurn * (0.59 * turns + traits.frizz_c[lane]);
      x += size * (0.4 * std::sin(a) + 0.3 * std::sin(b)), y += size * (0.4 * std::cos(c) + 0.3 * std::cos(b));
    }
    return {x, y, 0};
  }
};

double distance(D3 a, Vec3 b) {
  const D3 d = a + wide(b) * -1;
  return std::sqrt(inner(d, d));
}

Vec3 point_of(const StrandGroup& g, std::size_t i, std::size_t l) {
  const std::size_t at = i * StrandGroup::kLanes + l;
  return {g.x[at], g.y[at], g.z[at]};
}

// Metres. Strands are 0.2 m; a float of that size has steps of 1.5e-8.
constexpr double kTolerance = 3e-7;

void expect_like_oracle(const std::vector<StyleOperator>& style) {
  const HairMesh mesh = small_hair_mesh(style);
  validate(mesh, "test");
  for (const HairMesh::Bundle& bundle : mesh.bundles) {
    const BundleCage cage(mesh, bundle);
    for (const std::uint32_t points : {2u, 9u, 64u, 127u}) {
      StrandGroup group;
      make_strands(cage, 16, 7, points, group);
      StrandTraits traits;
      make_traits(cage, 16, 7, traits);
      for (std::size_t l = 0; l < group.strands; ++l) {
        const Oracle oracle{mesh, bundle, traits, l, static_cast<int>(points)};
        for (std::size_t i = 0; i < points; ++i)
          ASSERT_LT(distance(oracle.control_point(static_cast<int>(i)), point_of(group, i, l)), kTolerance)
              << "strand " << l << " point " << i << " of " << points;
      }
    }
  }
}

TEST(StyleOperators, LocksOfABraidAreThirdsOfTheBundle) {
  const std::pair<float, float> places[] = {{0, 0}, {0.332f, 0}, {0.334f, 1}, {0.665f, 1}, {0.668f, 2}, {0.999f, 2}, {1, 2}};
  for (const auto& [u, lock] : places) EXPECT_EQ(kernel::style_braid_lock(u), lock) << u;
}

// From there on that late it would be a step.
TEST(StyleOperators, GrowOverAThousandthOfTheStrandAtLeast) {
  EXPECT_NEAR(kernel::style_growth(1, 0.9995f), 0.5f, 2e-3f);
  EXPECT_EQ(kernel::style_growth(1, 1), 0);
  EXPECT_EQ(kernel::style_growth(1, 0.5f), 1);
  EXPECT_EQ(kernel::style_growth(0.75f, 0.5f), 0.5f);
}

// The polyline of a circle encloses the circle's area but for a fifth of what the inscribed one lacks, and a wave keeps its
// amplitude.
TEST(StyleOperators, ChordsCutOffNothingInTheMean) {
  constexpr double kPi = 3.14159265358979323846;
  for (const int n : {6, 8, 16, 64}) {
    const auto on_circle = [&](int i) {
      return Vec3(static_cast<float>(std::cos(2 * kPi * i / n)), static_cast<float>(std::sin(2 * kPi * i / n)), 0);
    };
    const double radius = static_cast<double>(length(kernel::style_chord_point(on_circle(0), on_circle(1), on_circle(2))));
    const double inscribed = n * std::sin(2 * kPi / n) / 2, area = inscribed * radius * radius;
    EXPECT_LT(std::fabs(area - kPi), (kPi - inscribed) / 5) << n;
  }
}

TEST(StrandGroup, FollowsTheCageAsTheOracleDoes) { expect_like_oracle({}); }

TEST(StrandGroup, EveryOperatorDoesWhatTheOracleDoes) {
  for (const StyleOperator& o : every_operator()) {
    SCOPED_TRACE(style_operator_names()[static_cast<std::size_t>(o.kind)]);
    expect_like_oracle({o});
  }
}

TEST(StrandGroup, OperatorsComposeAsTheOracleDoes) { expect_like_oracle(every_operator()); }

bool same_bits(const Buffer<float>& a, const Buffer<float>& b, std::size_t count) {
  return std::memcmp(a.data(), b.data(), count * sizeof(float)) == 0;
}

TEST(StrandGroup, SameBitsOnEveryInstructionSet) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  const BundleCage cage(mesh, mesh.bundles[1]);
  StrandGroup expected;
  make_strands_scalar(cage, 3, 16, 65, expected);
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    StrandGroup group;
    make_strands(cage, 3, 16, 65, group);
    const std::size_t n = 65 * StrandGroup::kLanes;
    EXPECT_TRUE(same_bits(group.x, expected.x, n) && same_bits(group.y, expected.y, n) && same_bits(group.z, expected.z, n))
        << isa;
    EXPECT_TRUE(same_bits(group.tx, expected.tx, n) && same_bits(group.ty, expected.ty, n) &&
                same_bits(group.tz, expected.tz, n));
    EXPECT_TRUE(same_bits(group.width, expected.width, n) && same_bits(group.occlusion, expected.occlusion, n)) << isa;
  }
  set_isa("");
}

TEST(StrandGroup, TangentsPointFromThePreviousPointToTheNext) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  const BundleCage cage(mesh, mesh.bundles[0]);
  StrandGroup g;
  make_strands(cage, 0, 16, 33, g);
  for (std::size_t l = 0; l < 16; ++l)
    for (std::size_t i = 0; i < 33; ++i) {
      const Vec3 along = normalize(point_of(g, std::min<std::size_t>(i + 1, 32), l) - point_of(g, i > 0 ? i - 1 : 0, l));
      const std::size_t at = i * StrandGroup::kLanes + l;
      EXPECT_LT(length(along - Vec3(g.tx[at], g.ty[at], g.tz[at])), 1e-5f);
    }
}

TEST(StrandGroup, WidthAndOcclusionAreThoseOfThePlace) {
  HairMesh mesh = small_hair_mesh({{Kind::kTaper, 0.25f, 0, 0.5f, 0}});
  mesh.width = 1e-4f;
  const HairMesh::Bundle& bundle = mesh.bundles[0];
  const BundleCage cage(mesh, bundle);
  StrandGroup g;
  make_strands(cage, 0, 16, 5, g);
  for (std::size_t l = 0; l < 16; ++l) {
    EXPECT_FLOAT_EQ(g.width[l], 1e-4f);
    EXPECT_FLOAT_EQ(g.width[2 * StrandGroup::kLanes + l], 1e-4f);  // where it sets in
    EXPECT_FLOAT_EQ(g.width[4 * StrandGroup::kLanes + l], 0.25e-4f);
    const Vec2 uv = strand_place(bundle, static_cast<std::uint32_t>(l));
    for (std::uint32_t k = 0; k < 5; ++k) {  // as many points as layers
      const auto at = [&](std::size_t c) { return mesh.occlusion[mesh.column_offsets[bundle.columns[c]] + k]; };
      const float low = at(0) + (at(1) - at(0)) * uv.x, high = at(3) + (at(2) - at(3)) * uv.x;
      EXPECT_NEAR(g.occlusion[k * StrandGroup::kLanes + l], low + (high - low) * uv.y, 1e-5f);
    }
  }
}

// The first strands of a bundle are those of a coarser level of detail.
TEST(StrandGroup, EveryPrefixIsSpreadEvenly) {
  const HairMesh::Bundle bundle{{}, 4096, 0, 99};
  for (const std::uint32_t n : {64u, 256u, 1000u, 4096u}) {
    std::array<int, 16> cells{};
    for (std::uint32_t s = 0; s < n; ++s) {
      const Vec2 p = strand_place(bundle, s);
      ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
      ++cells[static_cast<std::size_t>(p.y * 4) * 4 + static_cast<std::size_t>(p.x * 4)];
    }
    for (const int count : cells) EXPECT_NEAR(count, n / 16., 3.5) << n;
  }
}

TEST(StrandGroup, LanesBeyondTheLastStrandRepeatTheFirst) {
  const HairMesh mesh = small_hair_mesh(every_operator());
  const BundleCage cage(mesh, mesh.bundles[0]);
  StrandGroup g;
  make_strands(cage, 5, 3, 4, g);
  EXPECT_EQ(g.strands, 3u);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t l = 3; l < StrandGroup::kLanes; ++l) EXPECT_EQ(point_of(g, i, l), point_of(g, i, 0));
}

}  // namespace
}  // namespace pelage
