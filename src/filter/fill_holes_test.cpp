// Pixels that are guessed from those around them.
#include "filter/fill_holes.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <cstring>
#include <vector>

#include "core/rng.h"

namespace pelage {
namespace {

struct Picture {
  int width, height;
  Buffer<Vec4> values;
  Buffer<std::uint8_t> known;

  Picture(int w, int h) : width(w), height(h), values(size()), known(size()) { values.fill({}), known.fill(0); }
  std::size_t size() const { return static_cast<std::size_t>(width * height); }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * width + x); }
  void set(int x, int y, Vec4 v) { values[at(x, y)] = v, known[at(x, y)] = 1; }
  void fill() { fill_holes(values, known, width, height); }
};

TEST(FillHoles, OneColorFillsEverything) {
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(17, 5), std::pair(64, 33)}) {
    Picture p(w, h);
    p.set(w / 2, h / 3, {0.25f, 0.5f, 2, 1});
    p.fill();
    for (const Vec4& v : p.values) EXPECT_EQ(v, Vec4(0.25f, 0.5f, 2, 1));
  }
}

TEST(FillHoles, KnownPixelsStayAndOthersLieBetweenThem) {
  Picture p(37, 29);
  Rng rng(1, 1);
  for (int i = 0; i < 200; ++i)
    p.set(static_cast<int>(37 * rng.uniform()), static_cast<int>(29 * rng.uniform()), {rng.uniform() + 1, 0, 0, 1});
  const std::vector<Vec4> before(p.values.begin(), p.values.end());
  p.fill();
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_TRUE(!p.known[i] || p.values[i] == before[i]);
    EXPECT_GE(p.values[i].x, 1 - 1e-5f);
    EXPECT_LE(p.values[i].x, 2 + 1e-5f);
    EXPECT_NEAR(p.values[i].w, 1, 1e-5f);
  }
}

// A hole in a ramp is filled by the ramp, about.
TEST(FillHoles, FollowsItsSurroundings) {
  Picture p(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if (x < 24 || x >= 32 || y < 24 || y >= 32) p.set(x, y, {static_cast<float>(x), 0, 0, 1});
  p.fill();
  for (int y = 24; y < 32; ++y)
    for (int x = 24; x < 32; ++x) EXPECT_NEAR(p.values[p.at(x, y)].x, static_cast<float>(x), 4.5f);
  EXPECT_LT(p.values[p.at(24, 28)].x + 3, p.values[p.at(31, 28)].x);
}

TEST(FillHoles, NothingKnownChangesNothing) {
  Picture p(9, 4);
  p.values.fill({3, 2, 1, 0});
  p.fill();
  for (const Vec4& v : p.values) EXPECT_EQ(v, Vec4(3, 2, 1, 0));
}

TEST(FillHoles, SameBitsForAnyThreads) {
  const auto filled = [](int threads) {
    set_thread_count(threads);
    Picture p(203, 151);
    Rng rng(2, 1);
    for (int i = 0; i < 900; ++i)
      p.set(static_cast<int>(203 * rng.uniform()), static_cast<int>(151 * rng.uniform()), {rng.uniform(), rng.uniform(), 0, 1});
    p.fill();
    set_thread_count(0);
    return std::move(p.values);
  };
  const Buffer<Vec4> one = filled(1), three = filled(3);
  EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof(Vec4)), 0);
}

}  // namespace
}  // namespace pelage
