// Alpha fix: counts, energy, and the table that is full.
#include "filter/alpha_fix.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstring>
#include <map>

#include "core/rng.h"
#include "filter/segment_counts.h"

namespace pelage {
namespace {

/// Random samples, and random empty pixels filled from random samples: what linking could have left.
struct Linked {
  StrandLayer layer;
  Links links;
};

Linked random_links(std::uint32_t seed, int width, int height, int side = 1, std::uint32_t segments = 12) {
  Linked l;
  Rng rng(5, seed);
  l.layer.width = width, l.layer.height = height, l.layer.side = side;
  const std::size_t n = static_cast<std::size_t>(width * height);
  l.layer.visibility.resize(n), l.layer.depth.resize(n), l.layer.color.resize(n);
  std::vector<std::uint32_t> hits, empty;
  for (std::size_t p = 0; p < n; ++p) {
    const bool hair = rng.uniform() < 0.4f;
    const auto segment = static_cast<std::uint32_t>(rng.uniform() * static_cast<float>(segments));
    const float angle = 3 * rng.uniform();
    l.layer.visibility[p] =
        hair ? pack_visibility({std::cos(angle), std::sin(angle)}, 0.5f, segment, false) : VisibilitySample();
    l.layer.depth[p] = hair ? 1.f : INFINITY;
    l.layer.color[p] = hair ? Vec3(rng.uniform(), 3 * rng.uniform(), 0.1f) : Vec3();
    (hair ? hits : empty).push_back(static_cast<std::uint32_t>(p));
  }
  for (const std::uint32_t p : empty) {
    if (hits.empty() || rng.uniform() < 0.5f) continue;
    const std::uint32_t source = hits[static_cast<std::size_t>(rng.uniform() * static_cast<float>(hits.size()))];
    l.layer.visibility[p] = pack_visibility({1, 0}, 0.5f, 1000 + source, true);  // linked on another span than the source's
    l.layer.color[p] = l.layer.color[source], l.layer.depth[p] = 1;
    l.links.fills.push_back({p, source});
  }
  l.links.walks = l.links.fills.size();
  mark_hair(l.layer);
  return l;
}

constexpr int kBorder = 3;

/// Over all pixels, those of the border too.
double sum(const Matte& m, float Vec4::*channel) {
  double s = 0;
  for (const Vec4& c : m.color) s += static_cast<double>(c.*channel);
  return s;
}

/// Where screen pixel p lies in a matte.
std::size_t place(const Matte& m, std::size_t p) {
  const auto width = static_cast<std::size_t>(m.width);
  return m.index(static_cast<int>(p % width), static_cast<int>(p / width));
}

// Eq. 8 by maps and loops over pixels.
TEST(AlphaFix, IsHitOverAllOfASegment) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Linked l = random_links(seed, 31, 17);
    std::map<std::uint32_t, int> hit, filled;
    std::map<std::uint32_t, Vec3> color;
    for (std::size_t p = 0; p < l.layer.visibility.size(); ++p)
      if (const VisibilitySample& v = l.layer.visibility[p]; v.is_hair() && !v.is_filled())
        ++hit[v.primitive()], color[v.primitive()] += l.layer.color[p];
    std::map<std::uint32_t, std::uint32_t> segment_of_fill;
    for (const Fill& f : l.links.fills) {
      segment_of_fill[f.pixel] = l.layer.visibility[f.source].primitive();
      ++filled[segment_of_fill[f.pixel]];
    }
    AlphaStats stats;
    const Matte matte = fix_alpha(l.layer, l.links, LinkAlpha::kCount, kBorder, stats);
    EXPECT_EQ(stats.overflow, 0u);
    EXPECT_EQ(stats.segments, filled.size());
    for (std::uint32_t p = 0; p < l.layer.visibility.size(); ++p) {
      const VisibilitySample& v = l.layer.visibility[p];
      if (!v.is_hair()) {
        EXPECT_EQ(matte.color[place(matte, p)].w, 0.f);
        continue;
      }
      const std::uint32_t segment = v.is_filled() ? segment_of_fill[p] : v.primitive();
      const bool linked = filled.count(segment);
      const float m = static_cast<float>(hit[segment]), n = linked ? static_cast<float>(filled[segment]) : 0;
      EXPECT_FLOAT_EQ(matte.color[place(matte, p)].w, m / (m + n));
      const Vec3 c = linked ? color[segment] / m : l.layer.color[p];
      EXPECT_NEAR(matte.color[place(matte, p)].y, c.y * m / (m + n), 1e-5f);
    }
  }
}

// Eq. 10: nothing gets brighter or darker, whatever was filled.
TEST(AlphaFix, KeepsTheEnergyOfTheSamples) {
  for (const int side : {1, 2, 3})
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
      Linked l = random_links(seed, 36, 24, side);
      double red = 0, green = 0, hits = 0;
      for (std::size_t p = 0; p < l.layer.visibility.size(); ++p)
        if (const VisibilitySample& v = l.layer.visibility[p]; v.is_hair() && !v.is_filled())
          red += static_cast<double>(l.layer.color[p].x), green += static_cast<double>(l.layer.color[p].y), ++hits;
      AlphaStats stats;
      const Matte matte = fix_alpha(l.layer, l.links, LinkAlpha::kCount, kBorder, stats);
      EXPECT_EQ(matte.width, 36 / side);
      const double pixels = side * side;
      EXPECT_NEAR(sum(matte, &Vec4::x) * pixels, red, 1e-4 * red);
      EXPECT_NEAR(sum(matte, &Vec4::y) * pixels, green, 1e-4 * green);
      EXPECT_NEAR(sum(matte, &Vec4::w) * pixels, hits, 1e-4 * hits);
    }
}

TEST(AlphaFix, AFullTableTakesFillsBackAndCountsThem) {
  for (const int threads : {1, 4}) {
    set_thread_count(threads);
    Linked l = random_links(3, 64, 48, 1, 400);
    const std::size_t fills = l.links.fills.size();
    AlphaStats stats;
    const Matte matte = fix_alpha(l.layer, l.links, LinkAlpha::kCount, kBorder, 8, stats);
    EXPECT_EQ(stats.segments, 8u);
    EXPECT_GT(stats.overflow, fills / 2);
    std::size_t filled = 0;
    double hits = 0;
    for (const VisibilitySample& v : l.layer.visibility) filled += v.is_filled(), hits += v.is_hair() && !v.is_filled();
    EXPECT_EQ(filled + stats.overflow, fills);
    EXPECT_NEAR(sum(matte, &Vec4::w), hits, 1e-3 * hits);  // energy does not depend on the table
    set_thread_count(0);
  }
}

TEST(AlphaFix, CoverageIsTheAlpha) {
  Linked l = random_links(1, 20, 20, 2);
  Rng rng(1, 1);
  l.layer.coverage.resize(400);
  for (float& c : l.layer.coverage) c = rng.uniform();
  AlphaStats stats;
  const Matte matte = fix_alpha(l.layer, l.links, LinkAlpha::kCoverage, kBorder, stats);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) {
      float mean = 0, seen = 0;
      for (const int p : {40 * y + 2 * x, 40 * y + 2 * x + 1, 40 * y + 20 + 2 * x, 40 * y + 21 + 2 * x}) {
        mean += l.layer.coverage[static_cast<std::size_t>(p)] / 4;
        if (l.layer.visibility[static_cast<std::size_t>(p)].is_hair())
          seen += l.layer.coverage[static_cast<std::size_t>(p)] / 4;
      }
      const auto out = static_cast<std::size_t>(10 * y + x);
      EXPECT_NEAR(matte.coverage[place(matte, out)], mean, 1e-6f);
      EXPECT_NEAR(matte.color[place(matte, out)].w, seen, 1e-6f);
    }
}

TEST(AlphaFix, SameBitsForAnyThreads) {
  const auto fixed = [](int threads) {
    set_thread_count(threads);
    Linked l = random_links(7, 200, 150, 1, 3000);
    AlphaStats stats;
    Matte m = fix_alpha(l.layer, l.links, LinkAlpha::kCount, kBorder, stats);
    set_thread_count(0);
    return m;
  };
  const Matte one = fixed(1);
  for (const int threads : {2, 5}) {
    const Matte many = fixed(threads);
    EXPECT_EQ(std::memcmp(one.color.data(), many.color.data(), one.color.size() * sizeof(Vec4)), 0);
    EXPECT_EQ(std::memcmp(one.weight.data(), many.weight.data(), one.weight.size() * sizeof(float)), 0);
    one.hair.for_each(0, static_cast<std::size_t>(one.height), [&](int x, int y) {
      EXPECT_TRUE(many.hair.contains(x, y));
      EXPECT_EQ(one.tangent[one.index(x, y)], many.tangent[one.index(x, y)]);
    });
  }
}

TEST(SegmentTable, HasTheSizeOfTheBoxOrOfTheWalks) {
  StrandLayer layer;
  layer.width = 10, layer.height = 8;
  layer.visibility.resize(80);
  layer.visibility.fill({});
  mark_hair(layer);
  Links links;
  links.walks = 1000;
  EXPECT_EQ(segment_table_size(layer, links), 1u);
  layer.visibility[2 * 10 + 3] = layer.visibility[6 * 10 + 7] = pack_visibility({1, 0}, 0, 1, false);
  mark_hair(layer);
  EXPECT_EQ(segment_table_size(layer, links), 30u);  // 5 × 5 × 1.2
  links.walks = 6;
  EXPECT_EQ(segment_table_size(layer, links), 12u);
}

TEST(SegmentCounts, FindsWhatWasInsertedAndNothingElse) {
  SegmentCounts counts(1000);
  for (std::uint32_t k = 0; k < 700; ++k) EXPECT_TRUE(counts.insert(3 * k));
  EXPECT_EQ(counts.used(), 700u);
  for (std::uint32_t k = 0; k < 2100; ++k) EXPECT_EQ(counts.find(k) != SegmentCounts::kNone, k % 3 == 0) << k;
  SegmentCounts::Slot& slot = counts[counts.find(33)];
  SegmentCounts::add_hit(slot, {1, 2, 3});
  SegmentCounts::add_hit(slot, {2, 4, 0});
  EXPECT_EQ(counts[counts.find(33)].hit, 2u);
  EXPECT_EQ(SegmentCounts::mean_color(slot), Vec3(1.5f, 3, 1.5f));
  counts.clear();
  EXPECT_EQ(counts.find(33), SegmentCounts::kNone);
}

}  // namespace
}  // namespace pelage
