// Resolve against a pixel computed by hand, and the display encoding against the scalar kernel on every instruction set.
#include "composite/composite.h"

#include <gtest/gtest.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rng.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr Vec3 kHair{0.5f, 0.25f, 0.125f}, kMesh{0.1f, 0.9f, 0.3f}, kSky{1, 2, 4};

// One pixel of four samples: hair, mesh, sky, hair.
struct OnePixel {
  GBuffer gbuffer;
  Radiance radiance, edges;
  OpaqueLayer opaque;
  Backdrop backdrop;
  RenderSettings settings;
  Image linear{1, 1, {"R", "G", "B", "A"}};

  OnePixel() {
    gbuffer.width = gbuffer.height = 1;
    gbuffer.samples = 4;
    gbuffer.coverage.resize(1);
    gbuffer.coverage[0] = 0;
    radiance.index.resize(4);
    radiance.color.resize(1);
    radiance.color[0] = kHair;
    edges.index.resize(1);
    edges.index[0] = Radiance::kNone;
    opaque.width = opaque.height = 1;
    opaque.samples = 4;
    opaque.first.resize(1), opaque.shade.resize(4), opaque.color.resize(1);
    opaque.first[0] = 0, opaque.color[0] = kMesh;
    for (std::size_t s = 0; s < 4; ++s) {
      radiance.index[s] = s == 0 || s == 3 ? 0 : Radiance::kNone;
      opaque.shade[s] = s < 2 ? 0 : OpaqueLayer::kNone;
    }
    backdrop.color = kSky;
  }
  Vec4 pixel() {
    resolve({gbuffer, radiance, edges, opaque, backdrop}, settings, 0, 0, linear);
    const float* p = linear.at(0, 0);
    return {p[0], p[1], p[2], p[3]};
  }
};

void expect_near(Vec4 a, Vec3 color, float alpha) {
  EXPECT_NEAR(a.x, color.x, 1e-6f);
  EXPECT_NEAR(a.y, color.y, 1e-6f);
  EXPECT_NEAR(a.z, color.z, 1e-6f);
  EXPECT_NEAR(a.w, alpha, 1e-6f);
}

TEST(Resolve, AveragesTheSamples) {
  OnePixel p;
  expect_near(p.pixel(), (kHair * 2.f + kMesh + kSky) * 0.25f, 1);
}

TEST(Resolve, KeepsAlphaOfATransparentBackdrop) {
  OnePixel p;
  p.backdrop.color = {};
  p.backdrop.alpha = 0;
  expect_near(p.pixel(), (kHair * 2.f + kMesh) * 0.25f, 0.75f);
}

TEST(Resolve, ExposureIsInStopsAndLeavesAlpha) {
  OnePixel p;
  p.settings.exposure = 3;
  expect_near(p.pixel(), (kHair * 2.f + kMesh + kSky) * (8 * 0.25f), 1);
}

TEST(Resolve, AnalyticLaysTheAreaOverEverything) {
  OnePixel p;
  p.settings.alpha = AlphaSource::kAnalytic;
  p.gbuffer.coverage[0] = static_cast<std::uint32_t>(0.3f / GBuffer::kCoverageUnit);
  const float a = -std::expm1(-static_cast<float>(p.gbuffer.coverage[0]) * GBuffer::kCoverageUnit);
  expect_near(p.pixel(), kHair * a + (kMesh * 2.f + kSky * 2.f) * (0.25f * (1 - a)), 1);
  p.backdrop.color = {};
  p.backdrop.alpha = 0;
  expect_near(p.pixel(), kHair * a + kMesh * (0.5f * (1 - a)), a + (1 - a) * 0.5f);
}

TEST(Resolve, AnalyticTakesTheEdgeColorWhereNoSampleIsCovered) {
  OnePixel p;
  p.settings.alpha = AlphaSource::kAnalytic;
  p.gbuffer.coverage[0] = static_cast<std::uint32_t>(0.01f / GBuffer::kCoverageUnit);
  p.radiance.index.fill(Radiance::kNone);
  expect_near(p.pixel(), (kMesh + kSky) * 0.5f, 1);
  p.edges.index[0] = 0;
  p.edges.color.resize(1);
  p.edges.color[0] = kHair;
  const float a = -std::expm1(-static_cast<float>(p.gbuffer.coverage[0]) * GBuffer::kCoverageUnit);
  expect_near(p.pixel(), kHair * a + (kMesh + kSky) * (0.5f * (1 - a)), 1);
}

TEST(Resolve, PlentyOfStrandsCoverThePixel) {
  OnePixel p;
  p.settings.alpha = AlphaSource::kAnalytic;
  p.gbuffer.coverage[0] = static_cast<std::uint32_t>(50 / GBuffer::kCoverageUnit);
  expect_near(p.pixel(), kHair, 1);
}

TEST(Resolve, AnEmptyOpaqueLayerIsAllBackdrop) {
  OnePixel p;
  p.opaque = {};
  expect_near(p.pixel(), (kHair + kSky) * 0.5f, 1);
}

TEST(Resolve, BandsGoToTheirPlace) {
  OnePixel p;
  p.linear = Image(2, 3, {"R", "G", "B", "A"});
  resolve({p.gbuffer, p.radiance, p.edges, p.opaque, p.backdrop}, p.settings, 1, 2, p.linear);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(p.linear.at(i % 2, i / 2)[3], i == 5) << i;
}

// A band beside which nothing is: its empty pixels have the same bits as those around it.
TEST(Resolve, EmptyPixelsAreTheBackdrop) {
  OnePixel p;
  p.opaque = {};
  p.radiance.index.fill(Radiance::kNone);
  p.backdrop.color = {0.1f, 0.7f, 1.3f};
  p.settings.width = p.settings.height = 1, p.settings.exposure = 0.3f;
  for (const AlphaSource alpha : {AlphaSource::kSamples, AlphaSource::kAnalytic}) {
    p.settings.alpha = alpha;
    p.pixel();
    EXPECT_EQ(p.linear.pixels, backdrop_picture(p.backdrop, p.settings).pixels);
  }
}

Image noise(int width, int height) {
  Image image(width, height, {"R", "G", "B", "A"});
  Rng rng(7, 0);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = i % 4 == 3 ? rng.uniform() : std::exp2(rng.uniform() * 16 - 10);
  for (std::size_t i = 3; i < image.pixels.size(); i += 28) image.pixels[i] = 0;
  return image;
}

class Display : public testing::TestWithParam<ToneMap> {};

TEST_P(Display, EqualsTheScalarKernelOnEveryInstructionSet) {
  Image linear = noise(257, 3);
  for (std::size_t i = 4 * 300; i < 4 * 420; i += 4) std::copy_n(linear.at(20, 0), 4, &linear.pixels[i]);  // a backdrop
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    const Image display = make_display(linear, GetParam());
    for (std::size_t i = 0; i < linear.pixels.size(); i += 4) {
      const float a = linear.pixels[i + 3];
      Vec3 c = Vec3(linear.pixels[i], linear.pixels[i + 1], linear.pixels[i + 2]) / (a > 0 ? a : 1);
      if (GetParam() == ToneMap::kAces) c = kernel::composite_tone_map_aces(c);
      const Vec4 expected(kernel::composite_srgb_encode(c.x), kernel::composite_srgb_encode(c.y),
                          kernel::composite_srgb_encode(c.z), a);
      ASSERT_EQ(std::memcmp(&expected, &display.pixels[i], sizeof expected), 0) << isa << " pixel " << i / 4;
    }
  }
  set_isa("");
}

INSTANTIATE_TEST_SUITE_P(Curves, Display, testing::Values(ToneMap::kAces, ToneMap::kNone));

CameraView straight_view(int size) {
  CameraView view;
  view.width = view.height = size;
  view.center_x = view.center_y = static_cast<float>(size) / 2;
  view.focal = static_cast<float>(size) / 2;  // 90° across
  // Camera at the origin that looks along −Z: x right, y down, z forward.
  view.camera_to_world = {{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}}};
  view.world_to_camera = view.camera_to_world;
  return view;
}

TEST(Backdrop, ShowsTheMapWhereItLooks) {
  // Left half red, right half green; the middle column is −Z, so left of the view is red. Top row blue.
  auto map = std::make_shared<Image>(64, 32, std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) map->at(x, y)[y < 10 ? 2 : x < 32 ? 0 : 1] = 1;
  Scene scene;
  scene.environment.map = map;
  scene.environment.radiance = {2, 2, 2};
  scene.environment.visible = true;
  const CameraView view = straight_view(16);
  const Backdrop backdrop = make_backdrop(scene, view);
  EXPECT_EQ(backdrop.pixels[8 * 16 + 2], Vec3(2, 0, 0));
  EXPECT_EQ(backdrop.pixels[8 * 16 + 13], Vec3(0, 2, 0));
  EXPECT_EQ(backdrop.pixels[0 * 16 + 8], Vec3(0, 0, 2)) << "45° up";
  scene.environment.visible = false;
  EXPECT_EQ(make_backdrop(scene, view).color, scene.settings.background);
  scene.settings.transparent_background = true;
  EXPECT_EQ(make_backdrop(scene, view).alpha, 0);
}

}  // namespace
}  // namespace pelage
