#include "reference/film.h"

#include <gtest/gtest.h>
#include <pelage/error.h>

#include <cmath>

#include "core/rng.h"

namespace pelage {
namespace {

PathSample random_sample(Rng& rng) {
  PathSample s;
  s.radiance = {rng.uniform(), 2 * rng.uniform(), 0.5f * rng.uniform()};
  s.alpha = rng.uniform() < 0.7f ? 1.f : 0.f;
  s.hair = s.alpha > 0 && rng.uniform() < 0.8f;
  s.albedo = {0.2f, rng.uniform(), 0.1f};
  s.depth = s.alpha > 0 ? 1 + rng.uniform() : INFINITY;
  s.groom = 0, s.strand = static_cast<std::uint32_t>(100 * rng.uniform());
  s.split.emplace();
  s.split->bounces[0] = s.radiance;
  s.split->lobes[1] = s.radiance;
  return s;
}

TEST(Film, MeanAndVarianceAreThoseOfTheSamples) {
  Film film(1, 1, false, false);
  Rng rng(1, 2);
  std::vector<double> green;
  for (int i = 0; i < 1000; ++i) {
    const PathSample s = random_sample(rng);
    green.push_back(static_cast<double>(s.radiance.y));
    add_sample(film, 0, s);
  }
  double mean = 0, squares = 0;
  for (const double g : green) mean += g / 1000;
  for (const double g : green) squares += (g - mean) * (g - mean);
  const std::array layers{TraceLayer::kVariance};
  const Image image = develop(film, layers, {}, 0);
  EXPECT_NEAR(static_cast<double>(image.pixels[1]), mean, 1e-6);
  EXPECT_NEAR(static_cast<double>(image.pixels[5]), squares / 999 / 1000, 1e-9);
}

TEST(Film, FirstHitLayersShowTheNearestSample) {
  Film film(1, 1, false, false);
  Rng rng(3, 4);
  float nearest = INFINITY;
  std::uint32_t strand = 0;
  for (int i = 0; i < 64; ++i) {
    const PathSample s = random_sample(rng);
    if (s.depth < nearest) nearest = s.depth, strand = s.hair ? s.strand + 1 : 0;
    add_sample(film, 0, s);
  }
  const std::array layers{TraceLayer::kDepth, TraceLayer::kStrand};
  const Image image = develop(film, layers, {}, 0);
  ASSERT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A", "Z", "groom", "strand"}));
  EXPECT_EQ(image.pixels[4], nearest);
  EXPECT_EQ(image.pixels[6], static_cast<float>(strand));
}

TEST(Film, BackdropFillsWhatNothingCoversAndExposureScalesBoth) {
  Film film(1, 1, false, false);
  PathSample hit, miss;
  hit.radiance = {1, 1, 1}, hit.alpha = 1, hit.depth = 2;
  add_sample(film, 0, hit);
  add_sample(film, 0, miss);
  const Image solid = develop(film, {}, {{0.5f, 0, 0}, 1}, 1);
  EXPECT_FLOAT_EQ(solid.pixels[0], 2 * (0.5f + 0.25f));
  EXPECT_FLOAT_EQ(solid.pixels[1], 2 * 0.5f);
  EXPECT_FLOAT_EQ(solid.pixels[3], 1);
  EXPECT_FLOAT_EQ(develop(film, {}, {{0, 0, 0}, 0}, 0).pixels[3], 0.5f);
}

TEST(Film, BouncesAndLobesAddUpToTheRadiance) {
  Film film(1, 1, true, true);
  Rng rng(5, 6);
  for (int i = 0; i < 10; ++i) add_sample(film, 0, random_sample(rng));
  const std::array layers{TraceLayer::kBounces, TraceLayer::kLobes};
  const Image image = develop(film, layers, {{0, 0, 0}, 1}, 2);
  ASSERT_EQ(image.channel_count(), 4 + 3 * (Film::kBounces + Film::kLobes));
  float bounces = 0, lobes = 0;
  for (std::size_t b = 0; b < Film::kBounces; ++b) bounces += image.pixels[4 + 3 * b];
  for (std::size_t l = 0; l < Film::kLobes; ++l) lobes += image.pixels[4 + 3 * (Film::kBounces + l)];
  EXPECT_FLOAT_EQ(bounces, image.pixels[0]);
  EXPECT_FLOAT_EQ(lobes, image.pixels[0]);
}

TEST(Film, NoiseFallsWithTheRootOfTheSamples) {
  const auto noise = [](int samples) {
    Film film(32, 32, false, false);
    for (std::size_t p = 0; p < film.pixels.size(); ++p) {
      Rng rng(7, static_cast<std::uint32_t>(p));
      for (int i = 0; i < samples; ++i) add_sample(film, p, random_sample(rng));
    }
    return picture_noise(film);
  };
  EXPECT_EQ(noise(1), INFINITY);
  EXPECT_NEAR(noise(16) / noise(256), 4, 0.2);
}

TEST(Film, RefusesWhatIsNotFiniteAndNamesThePixel) {
  Film film(3, 2, false, false);
  PathSample s;
  s.radiance = {0, NAN, 0};
  try {
    add_sample(film, 5, s);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("pixel (2, 1)"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace pelage
