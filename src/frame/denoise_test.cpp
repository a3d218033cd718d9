// denoise() against the frames that it takes the place of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/denoise.h>
#include <pelage/error.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rng.h"
#include "frame/camera_view.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

using test::add_tile;
using test::hairy_scene;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The published form of the filter, for hair that is a hundred pixels large.
void use_published_kernel(LinkSettings& link) { link.kernel_size = 0.03f, link.falloff = INFINITY; }

DenoiseSettings settings_for_thin_scenes() {
  DenoiseSettings settings;
  use_published_kernel(settings.link);
  return settings;
}

/// Thin curls, so that one sample misses most of them, before a tile.
Scene thin_scene(int width = 160, int height = 120) {
  Scene scene = hairy_scene(width, height);
  scene.grooms[0].width_scale = 3;
  add_tile(scene);
  scene.settings.samples = 1;
  use_published_kernel(scene.settings.link);
  return scene;
}

Image linked(Scene scene) {
  scene.settings.method = Method::kLink;
  return render(scene).linear;
}

Image supersampled(Scene scene, int samples) {
  scene.settings.method = Method::kSsaa, scene.settings.samples = samples;
  return render(scene).linear;
}

double mse(const Image& a, const Image& b) {
  EXPECT_EQ(a.width, b.width);
  const std::size_t n = a.channel_count(), m = b.channel_count();
  double sum = 0;
  for (std::size_t p = 0; p * n < a.pixels.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = static_cast<double>(a.pixels[p * n + c]) - static_cast<double>(b.pixels[p * m + c]);
      sum += d * d;
    }
  return sum / static_cast<double>(a.pixels.size() / n * 3);
}

std::size_t channel(const Image& image, const std::string& name) {
  const auto at = std::find(image.channels.begin(), image.channels.end(), name);
  EXPECT_NE(at, image.channels.end()) << name;
  return static_cast<std::size_t>(at - image.channels.begin());
}

/// The picture without some channels, or with others: `rename` gives the new name, "" to leave one away.
template <class Rename>
Image with_names(const Image& image, const Rename& rename) {
  std::vector<std::string> names;
  std::vector<std::size_t> from;
  for (std::size_t c = 0; c < image.channel_count(); ++c)
    if (const std::string name = rename(image.channels[c]); !name.empty()) names.push_back(name), from.push_back(c);
  Image out(image.width, image.height, names);
  for (std::size_t p = 0; p * image.channel_count() < image.pixels.size(); ++p)
    for (std::size_t c = 0; c < from.size(); ++c)
      out.pixels[p * from.size() + c] = image.pixels[p * image.channel_count() + from[c]];
  return out;
}

Image without(const Image& image, const std::string& prefix) {
  return with_names(image, [&](const std::string& name) { return name.starts_with(prefix) ? "" : name; });
}

/// The first pixel, from the middle of the picture on, that shows hair (or none).
std::size_t pixel_of(const Image& gbuffer, bool hair) {
  const std::size_t strand = channel(gbuffer, "strand"), n = gbuffer.channel_count();
  std::size_t p = gbuffer.pixels.size() / n / 2;
  while ((gbuffer.pixels[p * n + strand] != 0) != hair) ++p;
  return p;
}

std::string error_of(const Image& gbuffer, const DenoiseSettings& settings = {}) {
  try {
    denoise(gbuffer, settings);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

// With the groom, the same strands are walked; the rounding of u may move a sample to the next span.
TEST(Denoise, WithTheGroomItIsMethodLink) {
  for (const int samples : {1, 4}) {
    Scene scene = thin_scene();
    scene.settings.samples = samples;
    DenoiseSettings settings = settings_for_thin_scenes();
    settings.scene = &scene, settings.samples = samples;
    const DenoiseResult result = denoise(render_gbuffer(scene), settings);
    const Image expected = linked(scene);
    EXPECT_EQ(result.linear.channels, expected.channels);
    std::size_t different = 0;
    for (std::size_t i = 0; i < expected.pixels.size(); ++i)
      different += std::fabs(result.linear.pixels[i] - expected.pixels[i]) > 1e-3f * (1 + expected.pixels[i]);
    EXPECT_LT(different, expected.pixels.size() / 500) << samples;
    EXPECT_GT(result.hair_pixels, 500u);
    EXPECT_GT(result.strands, 200u);
  }
}

// Without, the strands between the samples are guessed.
TEST(Denoise, WithoutTheGroomItIsNearlyAsGood) {
  const Scene scene = thin_scene();
  const Image gbuffer = render_gbuffer(scene), truth = supersampled(scene, 144);
  const double input = mse(gbuffer, truth), link = mse(linked(scene), truth);
  DenoiseResult result = denoise(gbuffer, settings_for_thin_scenes());
  const double made = mse(result.linear, truth);
  EXPECT_LT(link, 0.45 * input);
  EXPECT_LT(made, 1.1 * link);
  ASSERT_TRUE(result.camera_error);
  EXPECT_LT(*result.camera_error, 0.3f);
  DenoiseSettings filter_only = settings_for_thin_scenes();
  filter_only.link.link = false;
  EXPECT_LT(made, mse(denoise(gbuffer, filter_only).linear, truth));
}

// Samples of paths are noisy in what they show and in how bright it is.
TEST(Denoise, PathTracedSamplesComeCloserToManyOfThem) {
  Scene scene = thin_scene(96, 72);
  const auto traced = [&](int samples, std::vector<TraceLayer> layers) {
    TraceSettings settings;
    settings.samples = samples, settings.layers = std::move(layers);
    return trace(scene, settings).linear;
  };
  const Image gbuffer = traced(1, gbuffer_layers()), truth = traced(256, {});
  const double input = mse(gbuffer, truth);
  EXPECT_LT(mse(denoise(gbuffer).linear, truth), 0.45 * input);
  DenoiseSettings settings;
  settings.scene = &scene;
  EXPECT_LT(mse(denoise(gbuffer, settings).linear, truth), 0.45 * input);
}

TEST(Denoise, PixelsFarFromHairStayAsTheyAre) {
  const Scene scene = thin_scene();
  const Image gbuffer = render_gbuffer(scene), result = denoise(gbuffer, settings_for_thin_scenes()).linear;
  const std::size_t n = gbuffer.channel_count();
  for (const int x : {0, 159})
    for (int y = 0; y < 120; ++y)
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_EQ(result.at(x, y)[c], gbuffer.pixels[static_cast<std::size_t>(y * 160 + x) * n + c]);
}

// Without hair nothing changes; where all is hair there is no background to see.
TEST(Denoise, NoHairAndAllHair) {
  Scene bald = thin_scene();
  Image gbuffer = render_gbuffer(bald);
  const std::size_t n = gbuffer.channel_count(), strand = channel(gbuffer, "strand");
  Image none = gbuffer;
  for (std::size_t p = 0; p < none.pixels.size(); p += n) none.pixels[p + strand] = 0;
  const Image same = denoise(none).linear;
  for (std::size_t p = 0; p * n < none.pixels.size(); ++p)
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(same.pixels[4 * p + c], none.pixels[p * n + c]);
  Image all(7, 5, {"R", "G", "B", "Z", "strand", "u", "screen.X", "screen.Y"});
  for (std::size_t p = 0; p < 35; ++p) {
    const float values[] = {0.5f, 0.25f, 1, 2, static_cast<float>(p % 7 + 1), static_cast<float>(p / 7) / 4, 0, 1};
    std::copy_n(values, 8, all.pixels.data() + 8 * p);
  }
  const Image result = denoise(all).linear;
  for (std::size_t i = 0; i < result.pixels.size(); ++i)
    EXPECT_NEAR(result.pixels[i], i % 4 == 0 ? 0.5f : i % 4 == 1 ? 0.25f : 1.f, 1e-5f);
}

TEST(Denoise, FieldsMayHaveOtherNames) {
  const Image gbuffer = without(render_gbuffer(thin_scene()), "background");
  const Image own = denoise(gbuffer, settings_for_thin_scenes()).linear;
  const Image theirs = with_names(gbuffer, [](const std::string& name) -> std::string {
    if (name.size() == 1 && name != "Z" && name != "u") return "ViewLayer.Combined." + name;
    if (name == "Z") return "ViewLayer.Depth.Z";
    if (name == "strand" || name == "u") return "ViewLayer." + name + ".X";
    if (name.starts_with("tangent.")) return "ViewLayer.dir." + std::string(1, "RGB"[name.back() - 'X']);
    return name.starts_with("position.") ? "ViewLayer." + name : "";
  });
  DenoiseSettings settings = settings_for_thin_scenes();
  settings.names = {{"color", "ViewLayer.Combined"},
                    {"alpha", "ViewLayer.Combined.A"},
                    {"depth", "ViewLayer.Depth"},
                    {"strand", "ViewLayer.strand"},
                    {"u", "ViewLayer.u"},
                    {"tangent", "ViewLayer.dir"},
                    {"position", "ViewLayer.position"}};
  EXPECT_EQ(denoise(theirs, settings).linear.pixels, own.pixels);
  EXPECT_THAT(error_of(theirs), HasSubstr("channel color: is not there"));
  settings.names["u"] = "ViewLayer.v";
  EXPECT_THAT(error_of(theirs, settings), HasSubstr("channel ViewLayer.v (for u): is not there: place along the strand"));
  settings.names = {{"positon", "P"}};
  EXPECT_THAT(error_of(theirs, settings), HasSubstr("positon: no such field; did you mean position?"));
}

// Directions on the screen are enough, and nearly as good: only where the axis lies within a pixel is unknown.
TEST(Denoise, DirectionsOnTheScreenAreEnough) {
  const Scene scene = thin_scene();
  const Image gbuffer = render_gbuffer(scene), truth = supersampled(scene, 144);
  const CameraView view = make_camera_view(scene.camera, 160, 120);
  Image flat = with_names(gbuffer, [](const std::string& name) {
    if (name.starts_with("position")) return std::string();
    return name == "tangent.X" ? "screen.X" : name == "tangent.Y" ? "screen.Y" : name == "tangent.Z" ? "" : name;
  });
  const std::size_t t = channel(gbuffer, "tangent.X"), x = channel(gbuffer, "position.X"), s = channel(flat, "screen.X");
  for (std::size_t p = 0; p < 160 * 120; ++p) {
    const float* in = gbuffer.pixels.data() + p * gbuffer.channel_count();
    const Vec3 c = transform_point(view.world_to_camera, {in[x], in[x + 1], in[x + 2]});
    const Vec2 along = in[t] == 0 && in[t + 1] == 0 && in[t + 2] == 0
                           ? Vec2()
                           : project_direction(view, c, transform_vector(view.world_to_camera, {in[t], in[t + 1], in[t + 2]}));
    float* out = flat.pixels.data() + p * flat.channel_count() + s;
    out[0] = along.x, out[1] = along.y;
  }
  const DenoiseResult result = denoise(flat, settings_for_thin_scenes());
  EXPECT_FALSE(result.camera_error);
  EXPECT_LT(mse(result.linear, truth), 1.1 * mse(denoise(gbuffer, settings_for_thin_scenes()).linear, truth));
}

TEST(Denoise, NamesTheChannelThatIsMissing) {
  const Image gbuffer = render_gbuffer(thin_scene(48, 32));
  for (const auto& [field, prefix] : {std::pair("color", "G"),
                                      {"depth", "Z"},
                                      {"strand", "strand"},
                                      {"u", "u"},
                                      {"tangent", "tangent"},
                                      {"position", "position.Y"}}) {
    const std::string message = error_of(without(gbuffer, prefix));
    EXPECT_THAT(message, HasSubstr(std::string("G-buffer: channel ") + field + ": is not there")) << message;
    EXPECT_THAT(message, HasSubstr(std::string("say --channel ") + field + "=NAME; there are "));
  }
  for (const char* optional : {"A", "groom", "background", "background.A"})
    EXPECT_EQ(error_of(without(gbuffer, optional)), "no error") << optional;
  DenoiseSettings settings = settings_for_thin_scenes();
  settings.link.alpha = LinkAlpha::kCoverage;
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("channel coverage"));
}

TEST(Denoise, NamesThePixelThatIsWrong) {
  const Image sound = render_gbuffer(thin_scene(48, 32));
  const std::size_t n = sound.channel_count();
  struct Case {
    const char *channel, *words;
    float value;
  };
  for (const Case& c : {Case{"G", "color", kNan},
                        {"A", "color", INFINITY},
                        {"Z", "depth", kNan},
                        {"Z", "hair has none", 0},
                        {"u", "u", 1.5f},
                        {"u", "u", kNan},
                        {"tangent.Y", "tangent", kNan},
                        {"position.Z", "position", INFINITY},
                        {"strand", "strand", kNan},
                        {"groom", "strand", INFINITY},
                        {"background.G", "background", kNan}}) {
    Image gbuffer = sound;
    const std::size_t p = pixel_of(gbuffer, true);
    gbuffer.pixels[p * n + channel(gbuffer, c.channel)] = c.value;
    const std::string message = error_of(gbuffer);
    EXPECT_THAT(message, HasSubstr(c.words)) << c.channel;
    EXPECT_THAT(message, HasSubstr("at pixel (" + std::to_string(p % 48) + ", " + std::to_string(p / 48) + ")")) << c.channel;
  }
  // Where there is no hair nobody looks at what hair would have.
  Image gbuffer = sound;
  for (const char* name : {"u", "tangent.X", "position.X"})
    gbuffer.pixels[pixel_of(sound, false) * n + channel(sound, name)] = kNan;
  EXPECT_EQ(error_of(gbuffer), "no error");
}

// Files say anything: numbers of every size end in a picture or in an Error.
TEST(Denoise, SurvivesAnyNumbers) {
  const std::vector<std::string> world{"R",         "G",          "B",          "A",          "Z",
                                       "groom",     "strand",     "u",          "tangent.X",  "tangent.Y",
                                       "tangent.Z", "position.X", "position.Y", "position.Z", "coverage"};
  const std::vector<std::string> screen{"R", "G", "B", "Z", "strand", "u", "screen.X", "screen.Y"};
  const Scene scene = thin_scene(16, 12);
  int pictures = 0;
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    Rng rng(seed, 11);
    Image gbuffer(16, 12, seed % 2 ? world : screen);
    const float odd[] = {0, 1, -1, 0.5f, 1e-40f, 1e-30f, 1e8f, 1e30f, -1e30f, 3e38f, INFINITY, kNan};
    const std::size_t most = seed % 5 < 2 ? 4 : seed % 5 == 4 ? 12 : 10, n = gbuffer.channel_count();
    for (float& v : gbuffer.pixels)
      v = rng.uniform() < 0.02f * static_cast<float>(seed % 7)
              ? odd[static_cast<std::size_t>(rng.uniform() * static_cast<float>(most))]
              : rng.uniform();
    const std::size_t strand = channel(gbuffer, "strand"), depth = channel(gbuffer, "Z");
    for (std::size_t p = 0; p < gbuffer.pixels.size(); p += n) {
      gbuffer.pixels[p + strand] = std::floor(6 * rng.uniform());
      if (seed % 3) gbuffer.pixels[p + depth] = 0.5f + rng.uniform();
      for (std::size_t c = 0; seed % 2 && seed % 4 == 1 && c < 3; ++c)  // a camera that looks along z
        gbuffer.pixels[p + channel(gbuffer, "position.X") + c] = c == 0   ? static_cast<float>(p / n % 16)
                                                                 : c == 1 ? static_cast<float>(p / n / 16)
                                                                          : rng.uniform();
    }
    DenoiseSettings settings;
    settings.samples = seed % 6 == 5 ? 4 : 1, settings.reach = seed % 8 ? 16.f : 1e30f,
    settings.piece = seed % 9 ? 10.f : 1e-30f;
    settings.link.kernel_size = seed % 10 ? 0.f : 1.f;
    if (seed % 2) settings.link.alpha = seed % 12 == 1 ? LinkAlpha::kCoverage : LinkAlpha::kCount;
    if (seed % 16 == 3) settings.scene = &scene;
    pictures += error_of(gbuffer, settings) == "no error";
  }
  EXPECT_GT(pictures, 40);
}

TEST(Denoise, RefusesSizesAndSettings) {
  Image gbuffer = render_gbuffer(thin_scene(47, 32));
  DenoiseSettings settings = settings_for_thin_scenes();
  settings.samples = 4;
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("47 × 32 pixels do not make pixels of 4 samples"));
  settings.samples = 3;
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("samples: 3 is out of range"));
  settings = {}, settings.piece = 0;
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("piece"));
  settings = {}, settings.link.kernel_size = kNan;
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("kernel_size"));
  gbuffer.pixels.pop_back();
  EXPECT_THAT(error_of(gbuffer), HasSubstr("47 × 32 pixels of"));
  EXPECT_THAT(error_of(Image()), HasSubstr("0 × 0 pixels"));
}

TEST(Denoise, RefusesAGroomOfAnotherPicture) {
  const Scene scene = thin_scene(96, 64);
  const Image gbuffer = render_gbuffer(scene);
  DenoiseSettings settings = settings_for_thin_scenes();
  Scene other = scene;
  settings.scene = &other;
  other.camera.eye = other.camera.eye + Vec3(0.1f, 0, 0);
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("pixels away from where the G-buffer shows them"));
  other = scene, other.grooms[0].strands = std::make_shared<StrandSet>(test::helices(5, 16));
  EXPECT_THAT(error_of(gbuffer, settings), HasSubstr("none of the scene's, which are 1 to 5"));
}

// What is behind the hair is guessed where the file does not tell; a plain background is guessed right.
TEST(Denoise, GuessesTheBackground) {
  Scene scene = thin_scene();
  scene.meshes.clear();
  const Image gbuffer = render_gbuffer(scene), told = denoise(gbuffer, settings_for_thin_scenes()).linear,
              guessed = denoise(without(gbuffer, "background"), settings_for_thin_scenes()).linear;
  for (std::size_t i = 0; i < told.pixels.size(); ++i) EXPECT_NEAR(told.pixels[i], guessed.pixels[i], 1e-5f);
}

TEST(Denoise, TransparentBackgroundStaysTransparent) {
  Scene scene = thin_scene();
  scene.settings.transparent_background = true;
  const Image result = denoise(render_gbuffer(scene), settings_for_thin_scenes()).linear, expected = linked(scene);
  EXPECT_EQ(result.at(0, 0)[3], 0.f);
  double got = 0, wanted = 0;
  for (std::size_t i = 3; i < result.pixels.size(); i += 4)
    got += static_cast<double>(result.pixels[i]), wanted += static_cast<double>(expected.pixels[i]);
  EXPECT_NEAR(got, wanted, 0.01 * wanted);
}

// The noisier the colors, the wider they are smoothed, and no less sharp is what they cover.
TEST(Denoise, NoiseOfColorDoesNotBlurOpacity) {
  Scene scene = thin_scene();
  scene.settings.transparent_background = true;
  const Image clean = render_gbuffer(scene);
  Image noisy = clean;
  Rng rng(1, 7);
  for (std::size_t p = 0; p < noisy.pixels.size(); p += noisy.channel_count())
    if (const float factor = rng.uniform() < 0.1f ? 10.f : 0.f; noisy.pixels[p + channel(noisy, "strand")] != 0)
      for (std::size_t c = 0; c < 3; ++c) noisy.pixels[p + c] *= factor;
  const DenoiseResult of_clean = denoise(clean), of_noisy = denoise(noisy);
  EXPECT_LT(of_clean.noise, 0.3f);
  EXPECT_GT(of_noisy.noise, 0.7f);
  EXPECT_EQ(of_noisy.radius, of_clean.radius);
  EXPECT_GT(of_noisy.color_radius, 1.5f * of_noisy.radius);
  for (std::size_t i = 3; i < of_clean.linear.pixels.size(); i += 4)
    EXPECT_NEAR(of_clean.linear.pixels[i], of_noisy.linear.pixels[i], 1e-5f);
}

TEST(Denoise, ExactCoverageGivesTheOpacity) {
  Scene scene = thin_scene();
  scene.settings.link.alpha = LinkAlpha::kCoverage;
  DenoiseSettings settings = settings_for_thin_scenes();
  settings.link.alpha = LinkAlpha::kCoverage, settings.scene = &scene;
  EXPECT_LT(mse(denoise(render_gbuffer(scene), settings).linear, linked(scene)), 1e-6);
}

TEST(Denoise, SameBitsForAnyThreads) {
  const Image gbuffer = without(render_gbuffer(thin_scene()), "background");
  set_thread_count(1);
  const Image one = denoise(gbuffer, settings_for_thin_scenes()).linear;
  set_thread_count(5);
  const Image five = denoise(gbuffer, settings_for_thin_scenes()).linear;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, five.pixels);
}

TEST(Denoise, EndsWhenAsked) {
  const Image gbuffer = render_gbuffer(thin_scene(48, 32));
  EXPECT_THROW(denoise(gbuffer, {}, [](std::string_view stage, double) { return stage != "filter.curves"; }), Error);
}

}  // namespace
}  // namespace pelage
