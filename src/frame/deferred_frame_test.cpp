#include "frame/deferred_frame.h"

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/metrics.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <cmath>

#include "composite/side_by_side.h"
#include "kit/hair_mesh_scene.h"
#include "raster/test_scene.h"

namespace pelage {
namespace {

using testing::every_operator;
using testing::hair_mesh_scene;
using testing::small_hair_mesh;

/// A tuft of some thousand strands under the default lights.
Scene tuft() {
  HairMesh mesh = small_hair_mesh(
      {{StyleOperator::Kind::kNoise, 0.004f, 3, 0, 0.3f}, {StyleOperator::Kind::kFrizz, 0.001f, 20, 0, 0.7f}}, 2, 5, 1500);
  mesh.width = 2e-4f;
  Scene scene = hair_mesh_scene(std::move(mesh));
  add_default_lights(scene);
  scene.settings.width = 160, scene.settings.height = 120;
  scene.settings.opacity_map_size = 256;
  return scene;
}

double mean_square(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (i % 4 != 3) sum += (static_cast<double>(a.pixels[i]) - b.pixels[i]) * (static_cast<double>(a.pixels[i]) - b.pixels[i]);
  return sum / static_cast<double>(a.pixels.size());
}

double mean(const Image& a, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = channel; i < a.pixels.size(); i += 4) sum += a.pixels[i];
  return sum / static_cast<double>(a.pixels.size() / 4);
}

Image picture(Scene scene, Method method, int samples) {
  scene.settings.method = method, scene.settings.samples = samples;
  return render(scene).linear;
}

// The same strands, made on the fly or beforehand: pictures of many samples agree.
TEST(DeferredFrame, ShowsWhatItsStrandsShow) {
  Scene scene = tuft();
  const Image truth = picture(scene, Method::kSsaa, 64);
  const Image msaa = picture(scene, Method::kMsaa, 8), deferred = picture(scene, Method::kSwr, 8);
  const double reference = mean_square(msaa, truth), ours = mean_square(deferred, truth);
  EXPECT_LT(ours, 1.3 * reference);
  for (const std::size_t channel : {0, 1, 2, 3})
    EXPECT_NEAR(mean(deferred, channel) / mean(truth, channel), 1, 0.02) << channel;
}

TEST(DeferredFrame, TheFilterIsWorthSeveralSamples) {
  Scene scene = tuft();
  const Image truth = picture(scene, Method::kSsaa, 64);
  const Image two = picture(scene, Method::kSwr, 2), filtered = picture(scene, Method::kSwr, 1);
  scene.settings.swr.filter = false;
  const Image one = picture(scene, Method::kSwr, 1);
  EXPECT_LT(mean_square(filtered, truth), 0.5 * mean_square(one, truth));
  EXPECT_LT(mean_square(filtered, truth), mean_square(two, truth));
}

TEST(DeferredFrame, SameBitsForAnyNumberOfThreads) {
  const Scene scene = tuft();
  set_thread_count(1);
  const Image one = picture(scene, Method::kSwr, 1);
  set_thread_count(3);
  const Image three = picture(scene, Method::kSwr, 1);
  set_thread_count(0);
  EXPECT_EQ(one.pixels, three.pixels);
}

/// What both eyes see of `scene`, and what each of them does alone.
struct Eyes {
  Image together, left, right;
};

Eyes see(Scene scene) {
  Eyes seen;
  seen.together = render(scene).linear;
  const std::vector<Camera> cameras = eyes(scene.camera);
  scene.camera = cameras[0], seen.left = render(scene).linear;
  scene.camera = cameras[1], seen.right = render(scene).linear;
  return seen;
}

// Strands that are made once show what each eye sees alone; the left one sees bundles that the right one does not.
TEST(DeferredFrame, EyesSeeWhatEachSeesAlone) {
  Scene scene = tuft();
  scene.camera.stereo = Stereo{.separation = 0.1f, .convergence = 1.2f};
  scene.camera.target.x += 0.13f;
  scene.settings.swr.lod = false;
  test::add_tile(scene);
  for (const int samples : {1, 4})
    for (const SwrAlpha alpha : {SwrAlpha::kRatio, SwrAlpha::kCoverage}) {
      scene.settings.samples = samples, scene.settings.swr.alpha = alpha;
      const Eyes seen = see(scene);
      EXPECT_EQ(part_of(seen.together, 0, 2).pixels, seen.left.pixels) << samples;
      EXPECT_EQ(part_of(seen.together, 1, 2).pixels, seen.right.pixels) << samples;
      EXPECT_NE(seen.left.pixels, seen.right.pixels);
    }
}

// With level of detail both eyes show the strands that the one which asks for more does: alike, and not the same bits.
TEST(DeferredFrame, EyesShareTheirLevelOfDetail) {
  Scene scene = tuft();
  scene.camera.stereo = Stereo();
  scene.camera.eye = scene.camera.target + 4.f * (scene.camera.eye - scene.camera.target);
  const Eyes seen = see(scene);
  EXPECT_LT(mean_square(part_of(seen.together, 0, 2), seen.left), 1e-4);
  EXPECT_LT(mean_square(part_of(seen.together, 1, 2), seen.right), 1e-4);
}

TEST(DeferredFrame, EyesHaveTheSameBitsForAnyNumberOfThreads) {
  Scene scene = tuft();
  scene.camera.stereo = Stereo();
  set_thread_count(1);
  const Image one = picture(scene, Method::kSwr, 1);
  set_thread_count(3);
  const Image three = picture(scene, Method::kSwr, 1);
  set_thread_count(0);
  EXPECT_EQ(one.width, 2 * scene.settings.width);
  EXPECT_EQ(one.pixels, three.pixels);
}

TEST(DeferredFrame, AnEmptyViewIsABackground) {
  Scene scene = tuft();
  scene.camera.target = scene.camera.eye + Vec3(0, 0, 1);
  for (const int samples : {1, 4}) {
    const Image image = picture(scene, Method::kSwr, samples);
    EXPECT_FLOAT_EQ(image.at(3, 3)[0], scene.settings.background.x);
  }
}

TEST(DeferredFrame, SaysWhatItCannotDraw) {
  Scene scene = tuft();
  expand_hair_meshes(scene);
  scene.grooms[0].hair_mesh.reset();
  EXPECT_THROW(render(scene), Error);
  scene = tuft();
  scene.grooms[0].lod_lambda = NAN;
  EXPECT_THROW(render(scene), Error);
  scene = tuft();
  scene.settings.samples = 3;
  EXPECT_THROW(render(scene), Error);
}

// Other views show the strands of the mesh.
TEST(DeferredFrame, OtherViewsShowStrands) {
  Scene scene = tuft();
  scene.settings.view = View::kStrandId;
  EXPECT_GT(mean(render(scene).linear, 0), 0);
}

}  // namespace
}  // namespace pelage
