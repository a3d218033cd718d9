#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/runtime.h>
#include <pelage/trace.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

namespace pelage {
namespace {

Scene small_scene() {
  Scene scene;
  GrowSettings wavy = grow_defaults(HairStyle::kWavy);
  wavy.strands = 200;
  scene.grooms.emplace_back().strands = std::make_shared<StrandSet>(grow(wavy, mannequin_head()));
  scene.settings.width = 40, scene.settings.height = 30;
  add_default_camera(scene);
  add_default_lights(scene);
  return scene;
}

class Trace : public testing::Test {
 protected:
  ~Trace() override {
    std::remove(checkpoint_.c_str());
    set_thread_count(0);
  }
  std::string checkpoint_ = testing::TempDir() + "pelage_trace_" + std::to_string(getpid());
};

TEST_F(Trace, SameBitsForAnyNumberOfThreads) {
  const Scene scene = small_scene();
  TraceSettings settings;
  settings.samples = 4;
  settings.layers = {TraceLayer::kVariance, TraceLayer::kDepth, TraceLayer::kLobes};
  set_thread_count(1);
  const TraceResult one = trace(scene, settings);
  set_thread_count(3);
  EXPECT_EQ(trace(scene, settings).linear.pixels, one.linear.pixels);
}

TEST_F(Trace, ResumedItHasTheBitsOfAnUninterruptedPicture) {
  const Scene scene = small_scene();
  TraceSettings settings;
  settings.layers = {TraceLayer::kVariance, TraceLayer::kBounces};
  settings.samples = 11;
  const TraceResult whole = trace(scene, settings);
  settings.checkpoint = checkpoint_;
  settings.samples = 3;
  trace(scene, settings);
  settings.samples = 11;
  const TraceResult resumed = trace(scene, settings);
  EXPECT_EQ(resumed.resumed_samples, 3);
  EXPECT_EQ(resumed.linear.pixels, whole.linear.pixels);
}

// Cancelled in the middle of a pass, pixels stand at different counts.
TEST_F(Trace, CancelledAnywhereItGoesOnToTheSameBits) {
  const Scene scene = small_scene();
  TraceSettings settings;
  settings.samples = 9;
  const TraceResult whole = trace(scene, settings);
  settings.checkpoint = checkpoint_;
  int calls = 0, cancelled = 0;
  for (int stop = 2; stop < 200; stop += 7) {
    calls = 0;
    try {
      const TraceResult result = trace(scene, settings, [&](std::string_view, double) { return ++calls < stop; });
      EXPECT_EQ(result.linear.pixels, whole.linear.pixels);
      break;
    } catch (const Error& e) {
      EXPECT_EQ(e.problem(), "cancelled");
      ++cancelled;
    }
  }
  EXPECT_GT(cancelled, 1);
}

TEST_F(Trace, NoiseAndTimeStopIt) {
  const Scene scene = small_scene();
  TraceSettings settings;
  settings.samples = 100000;
  settings.noise = 0.5f;
  const TraceResult quiet = trace(scene, settings);
  EXPECT_LT(quiet.noise, 0.5f);
  EXPECT_EQ(quiet.samples % 16, 0);
  EXPECT_LT(quiet.samples, 100000);
  settings.noise = 0;
  settings.seconds = 0.05;
  EXPECT_LT(trace(scene, settings).samples, 100000);
}

TEST_F(Trace, AnotherSceneIsRefused) {
  Scene scene = small_scene();
  TraceSettings settings;
  settings.samples = 1;
  settings.checkpoint = checkpoint_;
  trace(scene, settings);
  scene.lights[0].intensity.x *= 2;
  EXPECT_THROW(trace(scene, settings), Error);
}

TEST_F(Trace, ValuesThatAreNotFiniteAreNamed) {
  const auto message = [](const Scene& scene) -> std::string {
    try {
      trace(scene, {});
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  Scene scene = small_scene();
  auto map = std::make_shared<Image>(4, 2, std::vector<std::string>{"R", "G", "B"});
  map->at(3, 1)[1] = std::numeric_limits<float>::quiet_NaN();
  scene.environment.map = map;
  EXPECT_NE(message(scene).find("environment map: pixel (3, 1), channel G"), std::string::npos) << message(scene);
  scene = small_scene();
  scene.lights[1].intensity.z = INFINITY;
  EXPECT_NE(message(scene).find("light 1"), std::string::npos) << message(scene);
}

TEST_F(Trace, SettingsOutOfRangeAreNamed) {
  const Scene scene = small_scene();
  for (const auto& change : std::vector<void (*)(TraceSettings&)>{
           [](TraceSettings& s) { s.samples = 0; }, [](TraceSettings& s) { s.max_bounces = 0; },
           [](TraceSettings& s) { s.seconds = std::nan(""); }, [](TraceSettings& s) { s.noise = -1; }}) {
    TraceSettings settings;
    change(settings);
    EXPECT_THROW(trace(scene, settings), Error);
  }
}

}  // namespace
}  // namespace pelage
