// Whole frames: everything but the files.
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <cstring>
#include <memory>

#include "bench.h"
#include "grooms.h"

namespace pelage::bench {
namespace {

// The reference is the same frame made one pixel lane at a time by one thread.
std::string check_frame(Scene scene) {
  scene.settings.width = 480, scene.settings.height = 270;
  const Image fast = render(scene).linear;
  const int threads = thread_count();
  const std::string isa = active_isa();
  set_thread_count(1);
  set_isa(available_isas().back());
  const Image slow = render(scene).linear;
  set_thread_count(threads);
  set_isa(isa);
  const bool same = std::memcmp(fast.pixels.data(), slow.pixels.data(), fast.pixels.size() * sizeof(float)) == 0;
  return same ? "" : "not the bits of one thread without SIMD";
}

Workload frame_workload(const std::string& groom, View view) {
  auto scene = std::make_shared<Scene>(groom_scene(groom));
  add_default_lights(*scene);
  scene->settings.width = 1920, scene->settings.height = 1080, scene->settings.samples = 8;
  scene->settings.view = view;
  return {.check = [scene] { return check_frame(*scene); }, .run = [scene] { render(*scene); }};
}

}  // namespace

void add_frame_cases(Suite& suite) {
  for (const std::string& groom : {std::string("straight50k"), std::string("curly50k"), std::string("sintel")}) {
    suite.cases.push_back(
        {"frame.beauty." + groom, "seconds_per_frame", "s", [groom] { return frame_workload(groom, View::kBeauty); }});
    suite.cases.push_back(
        {"frame.ids." + groom, "seconds_per_frame", "s", [groom] { return frame_workload(groom, View::kStrandId); }});
  }
}

}  // namespace pelage::bench
