// Where both look at the same places of the pixels and light scatters once, render() and trace() draw the same picture, with all
// settings that decide about geometry left as they come.
#include <gtest/gtest.h>
#include <pelage/grow.h>
#include <pelage/metrics.h>
#include <pelage/render.h>
#include <pelage/trace.h>

#include <cstdio>
#include <string>
#include <utility>

namespace pelage {
namespace {

constexpr int kSamples = 64;
constexpr int kPasses = 8;         // skin takes light from everywhere, of which one pass is a noisy picture
constexpr double kLeastPsnr = 40;  // decibels, over the pixels with hair

/// With the mannequin below the hair where asked for.
Scene grown(HairStyle style, bool head) {
  GrowSettings settings = grow_defaults(style);
  settings.strands = 2000;
  Scene scene;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(grow(settings, mannequin_head()));
  scene.settings.width = scene.settings.height = 256;
  scene.settings.shadows = scene.settings.dual_scattering = false;
  if (head) scene.meshes.emplace_back().mesh = std::make_shared<TriangleMesh>(mannequin_head());
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

Picture rasterized(Scene scene) {
  scene.settings.method = Method::kSsaa;
  scene.settings.samples = kSamples;
  return {render(scene).linear, Encoding::kLinear, "raster"};
}

/// The environment is drawn by chance: `passes` times, the mean of which is the truth.
Picture traced(const Scene& scene, int passes) {
  TraceSettings settings;
  settings.integrator = Integrator::kSingle;
  settings.samples = kSamples;
  settings.raster_positions = true;
  settings.layers = {TraceLayer::kCoverage};
  Image sum = trace(scene, settings).linear;
  for (int pass = 1; pass < passes; ++pass) {
    ++settings.seed;
    const Image image = trace(scene, settings).linear;
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += image.pixels[i];
  }
  for (float& value : sum.pixels) value /= static_cast<float>(passes);
  return {std::move(sum), Encoding::kLinear, "truth"};
}

/// How alike raster and truth are where there is hair, decibels.
double psnr_on_hair(const Scene& scene, int passes) {
  const Picture truth = traced(scene, passes);
  const Comparison c = compare_images(rasterized(scene), truth, {.metrics = {"psnr"}, .mask = hair_mask(truth)});
  EXPECT_GT(c.pixels, 5000u);
  return c.value("psnr").value_or(0);
}

class RasterIsTruth : public testing::TestWithParam<std::string> {};

TEST_P(RasterIsTruth, AtTheSameSamples) {
  const double psnr = psnr_on_hair(grown(hair_style_from_name(GetParam()), false), 1);
  std::printf("%s: %.1f dB\n", GetParam().c_str(), psnr);
  EXPECT_GE(psnr, kLeastPsnr);
}

// The skin shows between the strands: light on it is the same too.
TEST_P(RasterIsTruth, WithAHeadBelow) {
  const double psnr = psnr_on_hair(grown(hair_style_from_name(GetParam()), true), kPasses);
  std::printf("%s: %.1f dB\n", GetParam().c_str(), psnr);
  EXPECT_GE(psnr, kLeastPsnr);
}

INSTANTIATE_TEST_SUITE_P(Styles, RasterIsTruth, testing::Values("straight", "wavy", "curly", "afro"),
                         [](const auto& style) { return style.param; });

}  // namespace
}  // namespace pelage
