// The anti-aliasing methods against each other on small scenes.
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "frame/sample_positions.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

using test::add_tile;
using test::hairy_scene;

Image linear_of(Scene scene, Method method, int samples) {
  scene.settings.method = method;
  scene.settings.samples = samples;
  return render(scene).linear;
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double d = static_cast<double>(a.pixels[i] - b.pixels[i]);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

// Jittered frames see what the sample layers see: the same share of samples is covered, but for rounding at edges.
TEST(Ssaa, CoversTheSamplesThatMsaaCovers) {
  Scene scene = hairy_scene();
  add_tile(scene);
  scene.settings.transparent_background = true;
  for (const int samples : {1, 2, 8, 16}) {
    const Image together = linear_of(scene, Method::kMsaa, samples), apart = linear_of(scene, Method::kSsaa, samples);
    int different = 0;
    for (std::size_t i = 3; i < together.pixels.size(); i += 4)
      different += std::fabs(together.pixels[i] - apart.pixels[i]) > 1e-6f;
    EXPECT_LE(different, 96 * 64 / 500) << samples << " samples";
  }
}

TEST(Ssaa, OneSampleIsOneSample) {
  const Scene scene = hairy_scene();
  EXPECT_EQ(linear_of(scene, Method::kSsaa, 1).pixels, linear_of(scene, Method::kMsaa, 1).pixels);
}

// A band narrower than a pixel: with many samples its alpha is its area.
TEST(Ssaa, ConvergesToTheArea) {
  Scene scene;
  scene.settings.width = scene.settings.height = 40;
  scene.settings.transparent_background = true;
  scene.camera.projection = Camera::Projection::kOrthographic;
  scene.camera.height = 1;
  scene.grooms.emplace_back().strands =
      std::make_shared<StrandSet>(test::strand({{-0.31f, -0.8f, 0}, {0.117f, 0.8f, 0}}, 0.013f));
  scene.settings.shadows = false;
  const auto mean_alpha = [&](int samples) {
    const Image image = linear_of(scene, Method::kSsaa, samples);
    double sum = 0;
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) sum += static_cast<double>(image.pixels[i]);
    return sum / 1600;
  };
  const double area = 0.013 / std::cos(std::atan(0.427 / 1.6));
  EXPECT_NEAR(mean_alpha(64), area, 0.01 * area);
  EXPECT_NEAR(mean_alpha(100), area, 0.01 * area);
}

TEST(Ssaa, ComesCloserWithMoreSamples) {
  const Scene scene = hairy_scene();
  const Image reference = linear_of(scene, Method::kSsaa, 256);
  double before = rms(linear_of(scene, Method::kSsaa, 1), reference);
  for (const int samples : {4, 16, 64}) {
    const double now = rms(linear_of(scene, Method::kSsaa, samples), reference);
    EXPECT_LT(now, 0.6 * before) << samples;
    before = now;
  }
}

// Every yardstick comes closer to the supersampled picture than the one sample that it starts from.
TEST(Methods, SmoothTheirOneSample) {
  Scene scene = hairy_scene();
  add_tile(scene);
  const Image reference = linear_of(scene, Method::kSsaa, 64), one = linear_of(scene, Method::kSsaa, 1);
  const double before = rms(one, reference);
  EXPECT_LT(rms(linear_of(scene, Method::kFxaa, 1), reference), 0.85 * before);
  EXPECT_LT(rms(linear_of(scene, Method::kSmaa, 1), reference), 0.95 * before);
  EXPECT_LT(rms(linear_of(scene, Method::kTaa, 1), reference), 0.5 * before);
  EXPECT_LT(rms(linear_of(scene, Method::kMsaa, 8), reference), 0.4 * before);
}

// With sixteen frames TAA sees what sixteen samples see, but for the colors that it clips.
TEST(Taa, OfAStillCameraComesNearSupersampling) {
  Scene scene = hairy_scene();
  const Image reference = linear_of(scene, Method::kSsaa, 64);
  double before = INFINITY;
  for (const int frames : {1, 4, 16}) {
    scene.settings.frames = frames;
    const double now = rms(linear_of(scene, Method::kTaa, 1), reference);
    EXPECT_LT(now, 0.8 * before) << frames;
    before = now;
  }
  EXPECT_LT(before, 2.5 * rms(linear_of(scene, Method::kSsaa, 16), reference));
}

TEST(Sequence, StartsAsARenderedPicture) {
  Scene scene = hairy_scene();
  for (const Method method : {Method::kMsaa, Method::kTaa, Method::kSmaa}) {
    scene.settings.method = method;
    const RenderResult alone = render(scene), first = PictureSequence(scene).next(scene.camera);
    EXPECT_EQ(first.linear.pixels, alone.linear.pixels);
    EXPECT_EQ(first.display.pixels, alone.display.pixels);
  }
}

TEST(Sequence, MakesEveryPictureOfItsCameraAndItsLightOnce) {
  const Scene scene = hairy_scene();
  PictureSequence sequence(scene);
  for (int i = 0; i < 3; ++i) {
    Scene moved = scene;
    moved.camera.eye.x += 0.01f * static_cast<float>(i);
    const RenderResult result = sequence.next(moved.camera);
    EXPECT_EQ(result.linear.pixels, render(moved).linear.pixels) << i;
    int lights = 0;
    for (const StageStat& s : result.stats) lights += s.stage == "light";
    EXPECT_EQ(lights, i == 0) << i;
  }
}

// A camera that creeps on: the picture stays near that of a still one, and nearer to the reference than without history.
TEST(Sequence, TaaFollowsTheCamera) {
  Scene scene = hairy_scene();
  scene.settings.method = Method::kTaa;
  PictureSequence sequence(scene);
  Image last;
  for (int i = 0; i < 12; ++i) {
    scene.camera.eye.x += 2e-4f;
    scene.camera.target.x += 2e-4f;
    last = sequence.next(scene.camera).linear;
  }
  const Image reference = linear_of(scene, Method::kSsaa, 64);
  EXPECT_LT(rms(last, reference), 0.7 * rms(linear_of(scene, Method::kSsaa, 1), reference));
}

TEST(Sequence, TellsTheMotionOfItsCamera) {
  Scene scene = hairy_scene();
  scene.settings.view = View::kMotion;
  PictureSequence sequence(scene);
  const Image still = sequence.next(scene.camera).linear;
  Camera moved = scene.camera;
  moved.eye.x += 0.002f, moved.target.x += 0.002f;
  const Image motion = sequence.next(moved).linear;
  int things = 0;
  for (std::size_t i = 0; i < still.pixels.size(); i += 4) {
    ASSERT_EQ(still.pixels[i], 0);
    if (motion.pixels[i + 3] == 0) continue;
    ++things;
    EXPECT_GT(motion.pixels[i], 0) << "what is seen now was further right";
  }
  EXPECT_GT(things, 50);
}

TEST(Methods, DenoisingNeedsItsLibrary) {
#ifdef PELAGE_HAS_OIDN
  GTEST_SKIP() << "this build has Open Image Denoise";
#endif
  Scene scene = hairy_scene(8, 8);
  scene.settings.method = Method::kOidn;
  try {
    render(scene);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("openimagedenoise.org"), std::string::npos) << e.what();
  }
}

TEST(Methods, SettingsThatDoNotGoTogetherAreErrors) {
  Scene scene = hairy_scene(8, 8);
  scene.settings.samples = 3;
  EXPECT_THROW(render(scene), Error);
  scene.settings.method = Method::kSsaa;
  EXPECT_NO_THROW(render(scene));
  scene.settings.alpha = AlphaSource::kAnalytic;
  EXPECT_THROW(render(scene), Error);
  scene.settings.alpha = AlphaSource::kSamples;
  scene.settings.samples = 5000;
  EXPECT_THROW(render(scene), Error);
  scene.settings.samples = 8;
  scene.settings.frames = 0;
  EXPECT_THROW(render(scene), Error);
}

class EveryMethod : public testing::TestWithParam<Method> {};

TEST_P(EveryMethod, HasTheSameBitsForAnyThreadsAndInstructionSet) {
  Scene scene = hairy_scene(101, 67);
  add_tile(scene);
  scene.settings.method = GetParam();
  scene.settings.samples = 4;
  set_thread_count(1);
  const RenderResult one = render(scene);
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    const RenderResult many = render(scene);
    EXPECT_EQ(many.linear.pixels, one.linear.pixels) << threads << " threads";
    EXPECT_EQ(many.display.pixels, one.display.pixels) << threads << " threads";
  }
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(render(scene).linear.pixels, one.linear.pixels) << isa;
  }
  set_isa("");
  set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         testing::Values(Method::kMsaa, Method::kSsaa, Method::kTaa, Method::kFxaa, Method::kSmaa));

/// Rms difference of the linear pictures to 256 frames of one sample, over the pixels that hair touches there.
double error_of(const Scene& scene, const Image& reference, Method method, int samples = 1,
                LinkAlpha alpha = LinkAlpha::kCount) {
  Scene s = scene;
  s.settings.link.alpha = alpha;
  return rms(linear_of(s, method, samples), reference);
}

TEST(Link, IsNearerToTheReferenceThanItsInput) {
  Scene scene = hairy_scene(160, 120);
  scene.grooms[0].strands = std::make_shared<StrandSet>(test::helices(2000, 24, 0.001f));
  const Image reference = linear_of(scene, Method::kSsaa, 256);
  const double input = error_of(scene, reference, Method::kMsaa), linked = error_of(scene, reference, Method::kLink),
               exact = error_of(scene, reference, Method::kLink, 1, LinkAlpha::kCoverage);
  EXPECT_LT(linked, 0.5 * input);
  EXPECT_LT(exact, 0.4 * input);
  EXPECT_LT(error_of(scene, reference, Method::kLink, 16), 0.8 * linked);
}

// Neither links nor filter: a picture of one sample a pixel, or the mean of those of finer pixels.
TEST(Link, WithoutLinksAndFilterItIsTheInput) {
  Scene scene = hairy_scene();
  add_tile(scene);
  scene.settings.link.link = scene.settings.link.filter = false;
  const Image one = linear_of(scene, Method::kLink, 1), input = linear_of(scene, Method::kMsaa, 1);
  for (std::size_t i = 0; i < one.pixels.size(); ++i) EXPECT_NEAR(one.pixels[i], input.pixels[i], 1e-6f);
  scene.settings.subdivisions = 4;
  const Image four = linear_of(scene, Method::kLink, 4);
  scene.settings.width *= 2, scene.settings.height *= 2;
  const Image fine = linear_of(scene, Method::kMsaa, 1);
  for (int y = 0; y < four.height; ++y)
    for (int x = 0; x < four.width; ++x)
      for (int c = 0; c < 4; ++c) {
        const float mean = (fine.at(2 * x, 2 * y)[c] + fine.at(2 * x + 1, 2 * y)[c] + fine.at(2 * x, 2 * y + 1)[c] +
                            fine.at(2 * x + 1, 2 * y + 1)[c]) /
                           4;
        EXPECT_NEAR(four.at(x, y)[c], mean, 1e-5f) << x << " " << y << " " << c;
      }
}

TEST(Link, SameBitsForAnyThreads) {
  Scene scene = hairy_scene();
  add_tile(scene);
  for (const LinkAlpha alpha : {LinkAlpha::kCount, LinkAlpha::kCoverage}) {
    scene.settings.link.alpha = alpha;
    set_thread_count(1);
    const Image one = linear_of(scene, Method::kLink, 1);
    for (const int threads : {2, 5}) {
      set_thread_count(threads);
      EXPECT_EQ(linear_of(scene, Method::kLink, 1).pixels, one.pixels) << threads;
    }
    set_thread_count(0);
  }
}

TEST(Link, TakesScenesWithoutHairAndTellsOfWrongSamples) {
  Scene scene = hairy_scene();
  scene.grooms[0].strands = std::make_shared<StrandSet>(test::helices(1, 2));
  scene.camera.target = {0, 5, 0};  // away from it
  scene.camera.eye = {0, 4, 0.1f};
  const Image empty = linear_of(scene, Method::kLink, 1);
  for (const float v : empty.pixels) EXPECT_TRUE(std::isfinite(v));
  for (const int samples : {2, 8, 25}) EXPECT_THROW(linear_of(scene, Method::kLink, samples), Error);
}

// From eq. 10 on: without alpha fix, linked hair is as opaque as hair that was hit, so there is more of it.
TEST(Link, WithoutAlphaFixLinkedHairIsOpaque) {
  Scene scene = hairy_scene();
  scene.settings.transparent_background = true;
  scene.settings.link.filter = false;
  const Image fixed = linear_of(scene, Method::kLink, 1);
  scene.settings.link.alpha = LinkAlpha::kNone;
  const Image opaque = linear_of(scene, Method::kLink, 1);
  std::size_t thinned = 0;
  for (std::size_t i = 3; i < opaque.pixels.size(); i += 4) {
    ASSERT_EQ(opaque.pixels[i], fixed.pixels[i] > 0 ? 1.f : 0.f) << "the same pixels show hair";
    thinned += fixed.pixels[i] > 0 && fixed.pixels[i] < 1;
  }
  EXPECT_GT(thinned, 20u);
}

/// One strand of `points` that is seen from +z, a meter a picture.
Scene ortho_scene(int width, int height, std::initializer_list<Vec3> points, float strand_width) {
  Scene scene;
  scene.settings.width = width, scene.settings.height = height;
  scene.camera.projection = Camera::Projection::kOrthographic;
  scene.camera.height = 1;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(test::strand(points, strand_width));
  return scene;
}

// A strand that runs to the eye is a line of no length on the screen: one pixel that is hit, or none, and nothing is filled.
TEST(Link, OneStrandSeenEndOnFillsNothing) {
  for (const float lean : {0.f, 0.001f}) {
    Scene scene = ortho_scene(31, 31, {{-lean, 0, -0.3f}, {0, 0, 0}, {lean, 0, 0.3f}}, 0.04f);
    scene.settings.view = View::kLinked;
    const Image shown = render(scene).linear;
    EXPECT_EQ(std::count(shown.pixels.begin(), shown.pixels.end(), 2.f), 0) << "filled";
    EXPECT_EQ(std::count(shown.pixels.begin(), shown.pixels.end(), 1.f), lean > 0 ? 4 : 0) << "four channels of a pixel";
    scene.settings.view = View::kBeauty;
    scene.settings.link.filter = false;
    const Image input = linear_of(scene, Method::kMsaa, 1);
    for (const LinkAlpha alpha : {LinkAlpha::kCount, LinkAlpha::kCoverage, LinkAlpha::kNone}) {
      scene.settings.link.alpha = alpha;
      const Image linked = linear_of(scene, Method::kLink, 1);
      for (std::size_t i = 0; i < linked.pixels.size(); ++i) {
        ASSERT_TRUE(std::isfinite(linked.pixels[i]));
        if (alpha != LinkAlpha::kCoverage) {
          ASSERT_NEAR(linked.pixels[i], input.pixels[i], 1e-5f) << i;
        }
      }
    }
  }
}

TEST(Link, StrandsBehindTheHeadStayThere) {
  Scene scene = hairy_scene(101, 67);
  scene.settings.shadows = false;
  const Vec3 eye = scene.camera.eye, middle = eye + (scene.camera.target - eye) * 0.1f;
  const Vec3 side = normalize(cross(middle - eye, Vec3(0, 1, 0))) * 9, up = normalize(cross(side, middle - eye)) * 9;
  auto wall = std::make_shared<TriangleMesh>();
  wall->positions = {middle - side - up, middle + side - up, middle + up};
  wall->triangles = {{0, 1, 2}};
  scene.meshes.emplace_back().mesh = wall;
  const Image behind = linear_of(scene, Method::kLink, 1);
  scene.grooms.clear();
  EXPECT_EQ(behind.pixels, linear_of(scene, Method::kLink, 1).pixels);
}

// Where hair covers all of the picture there is nothing to link: the input, smoothed.
TEST(Link, TakesPicturesThatAreAllHair) {
  Scene scene = ortho_scene(23, 17, {{0, -3, 0}, {0, 0, 0}, {0, 3, 0}}, 4);
  scene.settings.transparent_background = true;
  scene.settings.view = View::kLinked;
  for (const float value : render(scene).linear.pixels) ASSERT_EQ(value, 1);
  scene.settings.view = View::kBeauty;
  const Image linked = linear_of(scene, Method::kLink, 1), input = linear_of(scene, Method::kMsaa, 1);
  for (std::size_t i = 3; i < linked.pixels.size(); i += 4) ASSERT_NEAR(linked.pixels[i], 1, 1e-6f);
  scene.settings.link.filter = false;
  EXPECT_EQ(linear_of(scene, Method::kLink, 1).pixels, input.pixels);
}

TEST(Link, TakesPicturesOfAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 67}, std::pair{3, 2}, std::pair{257, 89}}) {
    Scene scene = hairy_scene(width, height);
    for (const int samples : {1, 9}) {
      const Image image = linear_of(scene, Method::kLink, samples);
      ASSERT_EQ(image.width, width);
      ASSERT_EQ(image.height, height);
      for (const float v : image.pixels) ASSERT_TRUE(std::isfinite(v)) << width << "x" << height;
    }
  }
}

TEST(LinkTaa, GoesOnFromFrameToFrame) {
  Scene scene = hairy_scene(160, 120);
  scene.grooms[0].strands = std::make_shared<StrandSet>(test::helices(2000, 24, 0.001f));
  const Image reference = linear_of(scene, Method::kSsaa, 256);
  scene.settings.frames = 8;
  const double linked = error_of(scene, reference, Method::kLinkTaa);
  EXPECT_LT(linked, 0.95 * error_of(scene, reference, Method::kLink));
  EXPECT_LT(linked, 0.7 * error_of(scene, reference, Method::kTaa));
}

}  // namespace
}  // namespace pelage
