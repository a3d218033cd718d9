// Small scenes from end to end.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <cmath>
#include <cstring>
#include <set>

#include "core/hash.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

using test::add_tile;
using test::hairy_scene;

// One upright band in the middle of the picture, `width` meters wide, as high as the picture and more.
Scene band_scene(int size, float width) {
  Scene scene;
  scene.settings.width = scene.settings.height = size;
  scene.settings.transparent_background = true;
  scene.camera.projection = Camera::Projection::kOrthographic;
  scene.camera.height = 1;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(test::strand({{0, -0.8f, 0}, {0, 0.8f, 0}}, width));
  return scene;
}

std::uint64_t hash(const Image& image) { return hash_bytes(image.pixels.data(), image.pixels.size() * sizeof(float)); }

double mean(const Image& image, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = channel; i < image.pixels.size(); i += image.channel_count()) sum += image.pixels[i];
  return sum / static_cast<double>(image.pixels.size() / image.channel_count());
}

void expect_finite(const Image& image) {
  for (const float v : image.pixels) ASSERT_TRUE(std::isfinite(v));
}

TEST(Frame, AnEmptySceneIsItsBackground) {
  Scene scene;
  scene.settings.width = 7, scene.settings.height = 5;
  const RenderResult result = render(scene);
  ASSERT_EQ(result.linear.width, 7);
  ASSERT_EQ(result.display.height, 5);
  for (std::size_t i = 0; i < result.linear.pixels.size(); i += 4) {
    EXPECT_EQ(result.linear.pixels[i], scene.settings.background.x);
    EXPECT_EQ(result.linear.pixels[i + 3], 1);
  }
  scene.settings.transparent_background = true;
  EXPECT_EQ(mean(render(scene).linear, 3), 0);
}

TEST(Frame, ShowsLitHairOverTheBackground) {
  Scene scene = hairy_scene();
  scene.settings.transparent_background = true;
  const RenderResult result = render(scene);
  expect_finite(result.linear);
  const double alpha = mean(result.linear, 3);
  EXPECT_GT(alpha, 0.02);
  EXPECT_LT(alpha, 0.9);
  EXPECT_GT(mean(result.linear, 0), 1e-4);
  scene.lights.clear();
  scene.environment = {};
  EXPECT_EQ(mean(render(scene).linear, 0), 0) << "no light, no color";
}

TEST(Frame, ExposureDoubles) {
  Scene scene = hairy_scene();
  const Image dark = render(scene).linear;
  scene.settings.exposure = 1;
  const Image bright = render(scene).linear;
  for (std::size_t i = 0; i < dark.pixels.size(); ++i) ASSERT_EQ(bright.pixels[i], dark.pixels[i] * (i % 4 == 3 ? 1 : 2));
}

TEST(Frame, MeshesHideHairAndShowBehindIt) {
  Scene scene = hairy_scene();
  scene.settings.transparent_background = true;
  const double hair = mean(render(scene).linear, 3);
  add_tile(scene);
  const RenderResult with = render(scene);
  EXPECT_GT(mean(with.linear, 3), hair) << "the tile is opaque";
  scene.settings.view = View::kStrandId;
  const double visible = mean(render(scene).linear, 3);
  scene.meshes.clear();
  EXPECT_LT(visible, mean(render(scene).linear, 3)) << "hair behind the tile is hidden";
}

class EveryView : public testing::TestWithParam<std::tuple<View, AlphaSource>> {};

TEST_P(EveryView, HasTheSameBitsForAnyThreadsAndInstructionSet) {
  Scene scene = hairy_scene(257, 89);
  add_tile(scene);
  std::tie(scene.settings.view, scene.settings.alpha) = GetParam();
  set_thread_count(1);
  const RenderResult one = render(scene);
  expect_finite(one.linear);
  expect_finite(one.display);
  for (const float v : one.display.pixels) ASSERT_TRUE(v >= 0 && v <= 1) << v;
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    EXPECT_EQ(hash(render(scene).linear), hash(one.linear)) << threads << " threads";
  }
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(hash(render(scene).linear), hash(one.linear)) << isa;
  }
  set_isa("");
  set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Views, EveryView,
                         testing::Combine(testing::Values(View::kBeauty),
                                          testing::Values(AlphaSource::kSamples, AlphaSource::kAnalytic)));
INSTANTIATE_TEST_SUITE_P(DebugViews, EveryView,
                         testing::Combine(testing::Values(View::kStrandId, View::kU, View::kTangent, View::kDepth,
                                                          View::kCoverage, View::kOverdraw, View::kAlbedo, View::kMotion,
                                                          View::kLinked, View::kLinkAlpha),
                                          testing::Values(AlphaSource::kSamples)));

// A band of a tenth of the picture: its alpha is a tenth.
TEST(Frame, AlphaIsTheShareOfCoveredSamples) {
  Scene scene = band_scene(50, 0.103f);  // 5.15 pixels
  scene.settings.samples = 16;
  EXPECT_NEAR(mean(render(scene).linear, 3), 0.103, 0.002);
}

// A tenth of a pixel is a tenth by area; the strand's edge lends the color where no sample meets it.
TEST(Frame, AnalyticAlphaIsTheArea) {
  Scene scene = band_scene(50, 0.103f);
  scene.settings.alpha = AlphaSource::kAnalytic;
  EXPECT_NEAR(mean(render(scene).linear, 3), 0.103, 0.002);
  scene.grooms[0].strands = band_scene(50, 0.002f).grooms[0].strands;
  scene.settings.samples = 1;
  EXPECT_NEAR(mean(render(scene).linear, 3), 0.002, 0.0001);
}

TEST(Frame, BandsOfALargePictureMeetWithoutASeam) {
  Scene scene = band_scene(1100, 0.01f);  // 1100² pixels of 16 samples are more than one band
  scene.settings.samples = 16;
  scene.settings.shadows = false;
  const Image image = render(scene).linear;
  for (int y = 1; y < image.height; ++y)
    ASSERT_EQ(std::memcmp(image.at(0, y), image.at(0, 0), 1100 * 4 * sizeof(float)), 0) << "row " << y;
}

// A strand that goes one pixel aside with every row: each row is the one before, moved by a pixel. A band that stood a row
// too high or low would break it, which an upright strand cannot show.
TEST(Frame, ASlantedStrandCrossesBandsWithoutAStep) {
  const int size = 1100;
  Scene scene = band_scene(size, 0.01f);
  scene.grooms[0].strands = std::make_shared<StrandSet>(test::strand({{-0.8f, -0.8f, 0}, {0.8f, 0.8f, 0}}, 0.01f));
  scene.settings.samples = 16;
  scene.settings.shadows = false;
  const Image image = render(scene).linear;
  double covered = 0;
  for (int y = 1; y < size; ++y)
    for (int x = 0; x + 1 < size; ++x) {
      const float here = image.at(x, y)[3];
      ASSERT_NEAR(here, image.at(x + 1, y - 1)[3], 2.f / 16) << x << ", " << y;  // rounding may decide single samples
      covered += static_cast<double>(here);
    }
  EXPECT_NEAR(covered / size, 0.01 * std::sqrt(2.) * size, 0.2) << "pixels a row; the corners cut a little off";
}

TEST(DebugViews, SayWhatIsThere) {
  Scene scene = band_scene(40, 0.2f);
  const auto middle = [&](View view) {
    scene.settings.view = view;
    const Image image = render(scene).linear;
    const float* p = image.at(20, 20);
    return Vec4(p[0], p[1], p[2], p[3]);
  };
  EXPECT_NEAR(middle(View::kU).x, 0.5f, 0.02f);
  EXPECT_NEAR(middle(View::kDepth).x, 1, 1e-5f) << "the camera stands a meter away";
  EXPECT_NEAR(middle(View::kTangent).y, 1, 1e-5f);
  EXPECT_NEAR(middle(View::kCoverage).x, 1, 1e-3f);
  EXPECT_EQ(middle(View::kOverdraw).x, 1);
  scene.grooms[0].material.color_source = HairMaterial::ColorSource::kRgb;
  EXPECT_NEAR(middle(View::kAlbedo).x, scene.grooms[0].material.color.x, 1e-6f);
  scene.settings.view = View::kStrandId;
  EXPECT_EQ(render(scene).linear.at(0, 20)[3], 0) << "nothing beside the strand";
}

TEST(DebugViews, StrandsHaveColorsOfTheirOwn) {
  Scene scene = hairy_scene(200, 200);
  scene.settings.view = View::kStrandId;
  const Image image = render(scene).linear;
  std::set<std::array<float, 3>> colors;
  for (std::size_t i = 0; i < image.pixels.size(); i += 4)
    if (image.pixels[i + 3] > 0) colors.insert({image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]});
  EXPECT_GT(colors.size(), 150u);
  EXPECT_LE(colors.size(), 300u);
}

// Alpha is M/(M+N): over the M hit and N filled pixels of all strands it adds up to the hits (Huang 2025, eq. 10).
TEST(DebugViews, ShowWhatLinkingFillsAndItsAlpha) {
  Scene scene = hairy_scene(101, 67);
  const auto show = [&](View view) {
    scene.settings.view = view;
    return render(scene).linear;
  };
  const Image strands = show(View::kStrandId), linked = show(View::kLinked), alpha = show(View::kLinkAlpha);
  double hit = 0, filled = 0, sum = 0;
  for (std::size_t i = 0; i < linked.pixels.size(); i += 4) {
    const float value = linked.pixels[i];
    ASSERT_EQ(value == 1, strands.pixels[i + 3] == 1) << "hits are what one sample shows";
    ASSERT_EQ(value > 0, alpha.pixels[i] > 0);
    hit += value == 1, filled += value == 2, sum += static_cast<double>(alpha.pixels[i]);
  }
  EXPECT_GT(filled, 20);
  EXPECT_NEAR(sum, hit, 1e-3);
  scene.settings.link.link = false;
  const Image input = show(View::kLinked);
  for (std::size_t i = 0; i < input.pixels.size(); ++i) ASSERT_EQ(input.pixels[i], strands.pixels[i / 4 * 4 + 3]) << i;
}

TEST(Frame, StatsNameTheStages) {
  Scene scene = hairy_scene();
  add_tile(scene);
  std::vector<std::string> names;
  for (const StageStat& s : render(scene).stats) names.push_back(s.stage);
  EXPECT_EQ(names, (std::vector<std::string>{"groom", "light", "opaque", "raster", "shade", "composite", "display"}));
}

TEST(Frame, ProgressGrowsAndCancels) {
  const Scene scene = hairy_scene();
  std::string stage;
  double before = 0;
  render(scene, [&](std::string_view name, double share) {
    if (name != stage) stage = name, before = 0;
    EXPECT_GE(share, before) << name;
    EXPECT_LE(share, 1) << name;
    before = share;
    return true;
  });
  EXPECT_EQ(stage, "display");
  for (const char* stop : {"light", "raster", "shade", "composite", "display"})
    EXPECT_THROW(render(scene, [&](std::string_view name, double) { return name != stop; }), Error) << stop;
}

TEST(Frame, SettingsOutOfRangeAreErrors) {
  const auto broken = [](auto change) {
    Scene scene;
    change(scene.settings);
    EXPECT_THROW(render(scene), Error);
  };
  broken([](RenderSettings& s) { s.width = 0; });
  broken([](RenderSettings& s) { s.height = 16385; });
  broken([](RenderSettings& s) { s.samples = 3; });
  broken([](RenderSettings& s) { s.opacity_map_size = 1; });
  broken([](RenderSettings& s) { s.subdivisions = -1; });
  broken([](RenderSettings& s) { s.exposure = NAN; });
  Scene scene;
  scene.grooms.emplace_back();
  EXPECT_THROW(render(scene), Error) << "a groom without strands";
}

}  // namespace
}  // namespace pelage
