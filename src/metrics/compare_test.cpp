// compare_images(): values that can be worked out by hand, domains, masks, regions, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/metrics.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <cmath>
#include <limits>

#include "core/srgb.h"
#include "metrics/test_pictures.h"

namespace pelage::metrics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Picture flat(int width, int height, float r, float g, float b, Encoding encoding = Encoding::kDisplay) {
  Picture picture = make_picture(width, height, encoding);
  for (std::size_t p = 0; p < picture.image.pixels.size(); p += 3)
    picture.image.pixels[p] = r, picture.image.pixels[p + 1] = g, picture.image.pixels[p + 2] = b;
  return picture;
}

// With one more channel, of one value.
Picture with_channel(const Picture& picture, const std::string& name, float value) {
  std::vector<std::string> names = picture.image.channels;
  names.push_back(name);
  Picture out{Image(picture.image.width, picture.image.height, names), picture.encoding, picture.name};
  const std::size_t n = picture.image.channel_count();
  for (std::size_t p = 0; p < picture.image.pixels.size() / n; ++p) {
    std::copy_n(picture.image.pixels.data() + p * n, n, out.image.pixels.data() + p * (n + 1));
    out.image.pixels[p * (n + 1) + n] = value;
  }
  return out;
}

template <class Function>
std::string message_of(const Function& function) {
  try {
    function();
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(Compare, ErrorsByHand) {
  const Comparison c = compare_images(flat(20, 20, 0.5f, 0.25f, 0.75f), flat(20, 20, 0.25f, 0.25f, 0.25f));
  EXPECT_EQ(c.domain, Encoding::kDisplay);
  EXPECT_EQ(c.pixels, 400u);
  EXPECT_NEAR(c.value("mse").value(), (0.0625 + 0 + 0.25) / 3, 1e-8);
  EXPECT_NEAR(c.value("psnr").value(), -10 * std::log10(0.3125 / 3), 1e-6);
}

TEST(Compare, RelativeErrorIsOfLinearValues) {
  const Comparison c = compare_images(flat(4, 4, 2, 2, 2, Encoding::kLinear), flat(4, 4, 1, 1, 1, Encoding::kLinear));
  EXPECT_EQ(c.domain, Encoding::kLinear);
  EXPECT_NEAR(c.value("relative_mse").value(), 1 / 1.01, 1e-7);
  EXPECT_NEAR(c.value("mse").value(), 1, 1e-7);
  const auto linear = [](float x) { return std::pow((x + 0.055) / 1.055, 2.4); };
  const Comparison d = compare_images(flat(4, 4, 0.5f, 0.5f, 0.5f), flat(4, 4, 0.75f, 0.75f, 0.75f));
  const double t = linear(0.5f), r = linear(0.75f);
  EXPECT_NEAR(d.value("relative_mse").value(), (t - r) * (t - r) / (r * r + 0.01), 1e-6);
}

TEST(Compare, EqualPicturesAreEqual) {
  const Picture picture = drawn(200, 180);
  const Comparison c = compare_images(picture, picture);
  EXPECT_EQ(c.value("mse"), 0);
  EXPECT_EQ(c.value("relative_mse"), 0);
  EXPECT_EQ(c.value("psnr"), std::nullopt);
  EXPECT_EQ(c.values.at(2).note, "infinite: the pixels are equal");
  EXPECT_EQ(c.value("ssim"), 1);
  EXPECT_EQ(c.value("ms_ssim"), 1);
  EXPECT_EQ(c.value("flip"), 0);
}

TEST(Compare, ADisplayShowsALinearPictureAsRenderWritesIt) {
  const Picture linear = with_channel(drawn(40, 30, Encoding::kLinear), "A", 1);
  for (const ToneMap tone_map : {ToneMap::kAces, ToneMap::kNone}) {
    const Picture shown{make_display(linear.image, tone_map), Encoding::kDisplay, "shown"};
    CompareOptions options;
    options.tone_map = tone_map;
    EXPECT_EQ(compare_images(linear, shown, options).value("mse"), 0);
    EXPECT_EQ(compare_images(shown, linear, options).value("mse"), 0);
    EXPECT_EQ(compare_images(linear, linear, options).domain, Encoding::kDisplay);
  }
  const Picture shown{make_display(linear.image, ToneMap::kAces), Encoding::kDisplay, "shown"};
  const Comparison mixed = compare_images(linear, shown);
  EXPECT_EQ(mixed.value("mse"), 0) << "ACES is the default";
  EXPECT_THAT(mixed.warnings, ElementsAre(HasSubstr("shown is display-encoded and picture scene-linear")));
}

TEST(Compare, TransparentPicturesAreLaidOverBlack) {
  // Straight display colors of alpha ½ against their composite, which is half the linear value.
  const auto encode = [](double x) { return static_cast<float>(1.055 * std::pow(x, 1 / 2.4) - 0.055); };
  const Picture half = with_channel(flat(4, 4, encode(0.5), encode(0.5), encode(0.5)), "A", 0.5f);
  EXPECT_NEAR(compare_images(half, flat(4, 4, encode(0.25), encode(0.25), encode(0.25))).value("mse").value(), 0, 1e-12);
  // The color of a pixel of alpha 0 is not seen.
  EXPECT_EQ(compare_images(with_channel(flat(4, 4, 1, 1, 1), "A", 0), flat(4, 4, 0, 0, 0)).value("mse"), 0);
}

TEST(Compare, CoverageComesFromItsChannelOrAlpha) {
  const Picture picture = flat(4, 4, 0, 0, 0, Encoding::kLinear);
  const Comparison c = compare_images(with_channel(picture, "coverage", 0.5f), with_channel(picture, "A", 0.75f));
  EXPECT_NEAR(c.value("coverage_error").value(), 0.25, 1e-7);
  EXPECT_NEAR(c.value("coverage_bias").value(), -0.25, 1e-7);
  const Comparison none = compare_images(picture, with_channel(picture, "A", 0.75f));
  EXPECT_EQ(none.value("coverage_error"), std::nullopt);
  EXPECT_THAT(none.values.at(6).note, HasSubstr("both pictures need"));
}

TEST(Compare, MasksAndRegionsChooseThePixels) {
  Picture test = flat(40, 30, 0.5f, 0.5f, 0.5f);
  const Picture reference = test;
  for (int y = 0; y < 15; ++y)
    for (int x = 0; x < 10; ++x) std::fill_n(test.image.at(x, y), 3, 0.75f);  // the upper left quarter of a half
  CompareOptions options;
  options.metrics = {"mse", "psnr"};
  options.regions = tile_regions(40, 30, 4, 2);
  const Comparison whole = compare_images(test, reference, options);
  EXPECT_NEAR(whole.value("mse").value(), 0.0625 / 8, 1e-9);
  EXPECT_EQ(whole.regions.size(), 8u);
  EXPECT_EQ(whole.regions[0].name, "0,0");
  EXPECT_NEAR(whole.regions[0].values[0].value.value(), 0.0625, 1e-9);
  for (int i = 1; i < 8; ++i) EXPECT_EQ(whole.regions[static_cast<std::size_t>(i)].values[0].value, 0) << i;
  options.mask.assign(40 * 30, 0);
  for (int y = 10; y < 20; ++y) options.mask[static_cast<std::size_t>(y) * 40 + 5] = 1;
  const Comparison masked = compare_images(test, reference, options);
  EXPECT_EQ(masked.pixels, 10u);
  EXPECT_NEAR(masked.value("mse").value(), 0.0625 / 2, 1e-9);
  EXPECT_EQ(masked.regions[0].pixels, 5u);
  EXPECT_EQ(masked.regions[1].values[0].value, std::nullopt);
  EXPECT_EQ(masked.regions[1].values[0].note, "no pixel counts here");
}

TEST(Compare, TilesCoverAPictureOfAnySize) {
  int area = 0;
  for (const Region& region : tile_regions(101, 53, 7, 3)) area += region.rect.width * region.rect.height;
  EXPECT_EQ(area, 101 * 53);
  EXPECT_THAT(message_of([] { tile_regions(3, 3, 4, 1); }), HasSubstr("has no such tiles"));
}

TEST(Compare, MapsHoldTheErrorOfEachPixel) {
  const Picture reference = drawn(60, 40), test = noisy(reference, 0.2f);
  CompareOptions options;
  options.maps = {"flip", "mse"};
  options.metrics = {"psnr"};
  const Comparison c = compare_images(test, reference, options);
  ASSERT_EQ(c.maps.size(), 2u);
  EXPECT_EQ(c.maps[0].key, "flip");
  for (const ErrorMap& map : c.maps) {
    double sum = 0;
    for (const float e : map.error.pixels) sum += static_cast<double>(e);
    EXPECT_NEAR(sum / (60 * 40), c.value(map.key).value(), 1e-7) << map.key;
  }
  EXPECT_THAT(message_of([&] {
                options.maps = {"psnr"};
                compare_images(test, reference, options);
              }),
              HasSubstr("no error per pixel"));
}

TEST(Compare, HairIsWhereCoverageOrIdOrAlphaIsAboveZero) {
  Picture picture = with_channel(with_channel(flat(2, 1, 0, 0, 0, Encoding::kLinear), "A", 1), "coverage", 0);
  EXPECT_THAT(message_of([&] { hair_mask(picture); }), HasSubstr("no pixel shows hair"));
  picture.image.at(1, 0)[4] = 0.01f;
  EXPECT_THAT(hair_mask(picture), ElementsAre(0, 1));
  Picture id = with_channel(with_channel(with_channel(flat(2, 1, 0, 0, 0), "id.R", 0), "id.G", 0), "id.B", 0);
  id.image.at(0, 0)[4] = 0.5f;
  EXPECT_THAT(hair_mask(id), ElementsAre(1, 0));
  Picture traced = with_channel(with_channel(flat(2, 1, 0, 0, 0), "A", 1), "strand", 0);
  traced.image.at(1, 0)[4] = 7;
  EXPECT_THAT(hair_mask(traced), ElementsAre(0, 1));
  Picture alpha = with_channel(flat(2, 1, 0, 0, 0), "A", 0);
  alpha.image.at(1, 0)[3] = 0.5f;
  std::string note;
  EXPECT_THAT(hair_mask(alpha, &note), ElementsAre(0, 1));
  EXPECT_THAT(note, HasSubstr("counts meshes too"));
  alpha.image.at(0, 0)[3] = 1;
  EXPECT_THAT(message_of([&] { hair_mask(alpha); }), HasSubstr("alpha is above 0 everywhere"));
  EXPECT_THAT(message_of([&] { hair_mask(flat(2, 1, 0, 0, 0)); }), HasSubstr("--layers coverage"));
}

TEST(Compare, AMaskImageCountsWhereItIsNotBlack) {
  Picture mask = with_channel(flat(2, 1, 0, 0, 0), "A", 1);
  EXPECT_THAT(message_of([&] { mask_from_image(mask); }), HasSubstr("black everywhere"));
  mask.image.at(0, 0)[1] = 0.1f;
  EXPECT_THAT(mask_from_image(mask), ElementsAre(1, 0));
}

TEST(Compare, BadPicturesAreRefusedByName) {
  const Picture good = flat(5, 4, 0, 0, 0, Encoding::kLinear);
  Picture bad = good;
  bad.name = "bad.exr";
  bad.image.at(3, 2)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message_of([&] { compare_images(bad, good); }), HasSubstr("bad.exr: pixel (3, 2): channel G is NaN"));
  bad.image.at(3, 2)[1] = -std::numeric_limits<float>::infinity();
  EXPECT_THAT(message_of([&] { compare_images(good, bad); }), HasSubstr("bad.exr: pixel (3, 2): channel G is -Inf"));
  Picture depth = with_channel(good, "Z", std::numeric_limits<float>::infinity());
  EXPECT_EQ(compare_images(depth, good).value("mse"), 0) << "what is not compared may be infinite";
  EXPECT_THAT(message_of([&] { compare_images(good, flat(4, 5, 0, 0, 0, Encoding::kLinear)); }),
              HasSubstr("5 × 4 pixels, but picture has 4 × 5"));
  Picture layers = good;
  layers.image.channels = {"u", "v", "w"};
  EXPECT_THAT(message_of([&] { compare_images(layers, good); }), HasSubstr("no channels R, G, B"));
  EXPECT_THAT(message_of([&] { compare_images(Picture{}, good); }), HasSubstr("an empty image"));
}

TEST(Compare, BadOptionsAreRefused) {
  const Picture picture = flat(20, 20, 0, 0, 0);
  const auto told = [&](const CompareOptions& options) {
    return message_of([&] { compare_images(picture, picture, options); });
  };
  EXPECT_THAT(told({.metrics = {"fli"}}), HasSubstr("did you mean `flip`?"));
  EXPECT_THAT(told({.metrics = {"coverage_error"}}), HasSubstr("both pictures need"));
  EXPECT_THAT(told({.metrics = {"ms_ssim"}}), HasSubstr("at least 161 a side"));
  EXPECT_THAT(told({.mask = PixelMask(3)}), HasSubstr("3 pixels; the pictures have 20 × 20"));
  EXPECT_THAT(told({.regions = {{"r", {10, 0, 11, 5}}}}), HasSubstr("do not lie in"));
  EXPECT_THAT(told({.regions = {{"r", {std::numeric_limits<int>::max(), 0, 2, 5}}}}), HasSubstr("do not lie in"));
  EXPECT_THAT(told({.pixels_per_degree = 0}), HasSubstr("pixels per degree"));
}

TEST(Compare, AMetricCanBePluggedIn) {
  register_metric({.key = "mean_difference",
                   .description = "for this test",
                   .domain = Encoding::kLinear,
                   .evaluate = [](const MetricInput& in) {
                     EXPECT_EQ(in.domain, Encoding::kLinear);
                     Image map(in.test.width, in.test.height, {"error"});
                     for (std::size_t p = 0; p < map.pixels.size(); ++p)
                       map.pixels[p] = in.test.pixels[3 * p] - in.reference.pixels[3 * p];
                     return MetricResult{map};
                   }});
  EXPECT_EQ(registered_metrics().back().key, "mean_difference");
  CompareOptions options;
  options.metrics = {"mean_difference"};
  EXPECT_EQ(compare_images(flat(3, 3, 1, 0, 0), flat(3, 3, 0, 0, 0), options).value("mean_difference"), 1);
  EXPECT_THAT(message_of([] { register_metric({}); }), HasSubstr("needs a key and a function"));
}

TEST(Compare, SameBitsForAnyNumberOfThreads) {
  const Picture reference = drawn(333, 222, Encoding::kLinear), test = noisy(reference, 0.3f);
  const Comparison once = compare_images(test, reference);
  for (const int threads : {1, 2, 7}) {
    set_thread_count(threads);
    const Comparison again = compare_images(test, reference);
    for (std::size_t i = 0; i < once.values.size(); ++i)
      EXPECT_EQ(again.values[i].value, once.values[i].value) << once.values[i].key;
  }
  set_thread_count(0);
}

TEST(Compare, CanBeCancelled) {
  const Picture picture = flat(20, 20, 0, 0, 0);
  CompareOptions options;
  options.progress = [](std::string_view, double share) { return share < 0.4; };
  EXPECT_THAT(message_of([&] { compare_images(picture, picture, options); }), HasSubstr("cancelled"));
}

TEST(ColorMap, EndsAreThoseOfThePublishedMaps) {
  const ErrorMap flip{"flip", Image(3, 1, {"error"})};
  ErrorMap map = flip;
  map.error.pixels = {0, 1, 7};
  const Image magma = color_error(map, 1);
  EXPECT_THAT(std::vector<float>(magma.pixels.begin(), magma.pixels.begin() + 3), ElementsAre(0, 0, 4 / 255.f));
  EXPECT_THAT(std::vector<float>(magma.pixels.begin() + 3, magma.pixels.begin() + 6),
              ElementsAre(252 / 255.f, 253 / 255.f, 191 / 255.f));
  EXPECT_EQ(magma.at(2, 0)[0], magma.at(1, 0)[0]) << "clamped";
  map.key = "mse";
  const Image viridis = color_error(map, 7);
  EXPECT_THAT(std::vector<float>(viridis.at(2, 0), viridis.at(2, 0) + 3), ElementsAre(253 / 255.f, 231 / 255.f, 37 / 255.f));
}

TEST(ColorMap, ScaleIsOneOrThe99thPercentile) {
  EXPECT_EQ(color_scale({"flip", Image(2, 2, {"error"})}), 1);
  ErrorMap map{"mse", Image(100, 1, {"error"})};
  EXPECT_EQ(color_scale(map), 1) << "nothing to show";
  for (int x = 0; x < 100; ++x) map.error.pixels[static_cast<std::size_t>(x)] = static_cast<float>(x);
  EXPECT_EQ(color_scale(map), 98);
}

TEST(Compare, EnergyIsTheShareOfTheReferencesLight) {
  Picture reference = make_picture(8, 4, Encoding::kLinear), test = reference;
  std::fill(reference.image.pixels.begin(), reference.image.pixels.end(), 0.5f);
  std::fill(test.image.pixels.begin(), test.image.pixels.end(), 0.5f);
  for (int x = 0; x < 8; ++x) test.image.at(x, 1)[1] = 2;
  EXPECT_NEAR(compare_images(test, reference).value("energy").value(), (12 * 0.5 - 0.5 + 2) / (12 * 0.5), 1e-6);
  CompareOptions options;
  options.mask = PixelMask(32), options.mask[0] = 1;
  EXPECT_EQ(compare_images(test, reference, options).value("energy"), 1);
  std::fill(reference.image.pixels.begin(), reference.image.pixels.end(), 0.f);
  EXPECT_EQ(compare_images(test, reference).value("energy"), std::nullopt) << "a black reference";
}

TEST(Compare, FlyawayPixelsAreThinlyCovered) {
  Picture picture{Image(4, 1, {"R", "coverage"}), Encoding::kLinear, "picture"};
  const float coverage[] = {0, 0.29f, 0.31f, 1};
  for (int x = 0; x < 4; ++x) picture.image.at(x, 0)[1] = coverage[x];
  EXPECT_EQ(flyaway_mask(picture), (PixelMask{0, 1, 0, 0}));
  EXPECT_EQ(flyaway_mask(picture, 0.5f), (PixelMask{0, 1, 1, 0}));
  EXPECT_THROW(flyaway_mask(picture, 0.1f), Error) << "no such pixel";
  EXPECT_THROW(flyaway_mask({Image(4, 1, {"R"}), Encoding::kLinear, "picture"}), Error) << "no coverage";
}

TEST(Compare, BackgroundFillsWhatIsTransparent) {
  Picture linear{Image(1, 1, {"R", "G", "B", "A"}), Encoding::kLinear, "picture"};
  const float hair[] = {0.1f, 0.2f, 0.3f, 0.5f};
  std::copy_n(hair, 4, linear.image.at(0, 0));
  const Picture over = over_background(linear, {1, 0.5f, 0});
  EXPECT_NEAR(over.image.pixels[0], 0.6f, 1e-6f);
  EXPECT_NEAR(over.image.pixels[1], 0.45f, 1e-6f);
  EXPECT_NEAR(over.image.pixels[2], 0.3f, 1e-6f);
  EXPECT_EQ(over.image.pixels[3], 1);
  Picture display{Image(1, 1, {"R", "G", "B", "A"}), Encoding::kDisplay, "picture"};
  const float straight[] = {1, 0, 0, 0.5f};
  std::copy_n(straight, 4, display.image.at(0, 0));
  EXPECT_NEAR(over_background(display, {0, 1, 0}).image.pixels[1], linear_to_srgb(0.5f), 1e-6f);
  const Picture opaque = make_picture(2, 2);
  EXPECT_EQ(over_background(opaque, {1, 1, 1}).image.pixels, opaque.image.pixels);
}

}  // namespace
}  // namespace pelage::metrics
