// Where both look at the same places of the pixels and light scatters once, render() and trace() draw the same picture, with all
// settings that decide about geometry left as they come.
#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/metrics.h>
#include <pelage/render.h>
#include <pelage/trace.h>

#include <cstdio>
#include <string>

namespace pelage {
namespace {

constexpr int kSamples = 64;
constexpr double kLeastPsnr = 40;  // decibels, over the pixels with hair

Scene grown(HairStyle style) {
  GrowSettings settings = grow_defaults(style);
  settings.strands = 2000;
  Scene scene;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(grow(settings, mannequin_head()));
  scene.settings.width = scene.settings.height = 256;
  scene.settings.shadows = scene.settings.dual_scattering = false;
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

Picture rasterized(Scene scene) {
  scene.settings.method = Method::kSsaa;
  scene.settings.samples = kSamples;
  return {render(scene).linear, Encoding::kLinear, "raster"};
}

Picture traced(const Scene& scene) {
  TraceSettings settings;
  settings.integrator = Integrator::kSingle;
  settings.samples = kSamples;
  settings.raster_positions = true;
  settings.layers = {TraceLayer::kCoverage};
  return {trace(scene, settings).linear, Encoding::kLinear, "truth"};
}

class RasterIsTruth : public testing::TestWithParam<std::string> {};

TEST_P(RasterIsTruth, AtTheSameSamples) {
  const Scene scene = grown(hair_style_from_name(GetParam()));
  const Picture truth = traced(scene);
  const Comparison c = compare_images(rasterized(scene), truth, {.metrics = {"psnr"}, .mask = hair_mask(truth)});
  ASSERT_TRUE(c.value("psnr").has_value());
  std::printf("%s: %.1f dB over %zu pixels\n", GetParam().c_str(), *c.value("psnr"), c.pixels);
  EXPECT_GE(*c.value("psnr"), kLeastPsnr);
  EXPECT_GT(c.pixels, 5000u);
}

INSTANTIATE_TEST_SUITE_P(Styles, RasterIsTruth, testing::Values("straight", "wavy", "curly", "afro"),
                         [](const auto& style) { return style.param; });

}  // namespace
}  // namespace pelage
