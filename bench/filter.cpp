// Anti-aliasing of whole frames: what the filters cost, and what the pictures of every method are worth.
#include <pelage/metrics.h>
#include <pelage/render.h>
#include <pelage/runtime.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "bench.h"
#include "filter/fxaa.h"
#include "filter/smaa.h"
#include "filter/taa.h"
#include "frame/camera_view.h"
#include "grooms.h"

namespace pelage::bench {
namespace {

constexpr int kWidth = 1280, kHeight = 720;

/// A frame of one sample a pixel, and its depth from the view of that name.
struct OneSample {
  RenderResult picture;
  Image depth;
  CameraView view;
};

std::shared_ptr<const OneSample> one_sample(const std::string& groom) {
  Scene scene = groom_scene(groom);
  add_default_lights(scene);
  scene.settings.width = kWidth, scene.settings.height = kHeight, scene.settings.samples = 1;
  auto result = std::make_shared<OneSample>();
  result->picture = render(scene);
  scene.settings.view = View::kDepth;
  result->depth = render(scene).linear;
  result->view = make_camera_view(scene.camera, kWidth, kHeight);
  return result;
}

/// A filter as a function of a picture, whose reference is one thread.
Workload filter_workload(const std::shared_ptr<const OneSample>& input, std::function<Image(const OneSample&)> filter) {
  const auto check = [input, filter]() -> std::string {
    const Image many = filter(*input);
    const int threads = thread_count();
    set_thread_count(1);
    const Image one = filter(*input);
    set_thread_count(threads);
    if (many.pixels != one.pixels) return "not the bits of one thread";
    return many.pixels != input->picture.linear.pixels ? "" : "nothing was filtered";
  };
  return {.check = check, .run = [input, filter] { filter(*input); }, .items = kWidth * kHeight};
}

Image fxaa(const OneSample& in) {
  return resample(in.picture.linear, fxaa_offsets(in.picture.display), AlphaKind::kPremultiplied);
}

Image smaa(const OneSample& in) {
  return smaa_blend(in.picture.linear, smaa_shares(in.picture.display), AlphaKind::kPremultiplied);
}

TaaFrame taa_frame(const OneSample& in, Vec2 position) {
  TaaFrame frame{in.picture.linear, Buffer<float>(in.depth.pixels.size() / 4), in.view, position};
  for (std::size_t p = 0; p < frame.depth.size(); ++p)
    frame.depth[p] = in.depth.pixels[4 * p + 3] > 0 ? in.depth.pixels[4 * p] : INFINITY;
  return frame;
}

/// A frame blended into a history that was seen from half a pixel aside.
Image taa(const OneSample& in) {
  TaaHistory history;
  history.add(taa_frame(in, {0.5f, 0.5f}));
  TaaFrame next = taa_frame(in, {0.5f, 0.5f});
  next.view.center_x += 0.5f;
  history.add(std::move(next));
  return history.picture();
}

struct NamedMethod {
  const char* name;
  Method method;
  int samples;
};
constexpr NamedMethod kMethods[] = {{"one", Method::kMsaa, 1}, {"msaa8", Method::kMsaa, 8}, {"ssaa8", Method::kSsaa, 8},
                                    {"taa", Method::kTaa, 1},  {"fxaa", Method::kFxaa, 1},  {"smaa", Method::kSmaa, 1}};

Scene quality_scene(const std::string& groom, Method method, int samples) {
  Scene scene = groom_scene(groom);
  add_default_lights(scene);
  scene.settings.width = scene.settings.height = 512;
  scene.settings.method = method, scene.settings.samples = samples;
  return scene;
}

/// What a display shows of that groom by that method, rendered once in a run.
std::shared_ptr<const Picture> picture_by(const std::string& groom, const NamedMethod& m) {
  static std::map<std::string, std::shared_ptr<const Picture>> made;
  std::shared_ptr<const Picture>& picture = made[groom + "." + m.name];
  if (!picture)
    picture = std::make_shared<Picture>(Picture{render(quality_scene(groom, m.method, m.samples)).display, Encoding::kDisplay});
  return picture;
}

/// A metric of a method's picture against 64 samples that are all shaded.
Workload quality_workload(const std::string& groom, const NamedMethod& m, const std::string& metric) {
  const auto reference = picture_by(groom, {"ssaa64", Method::kSsaa, 64}), test = picture_by(groom, m);
  const auto against_reference = [reference, metric](const Picture& picture) {
    return compare_images(picture, *reference, {.metrics = {metric}}).value(metric);
  };
  const auto check = [reference, test, against_reference]() -> std::string {
    const std::optional<double> same = against_reference(*reference);
    if (same && *same != 0) return "the reference differs from itself";
    return against_reference(*test) ? "" : "no value";
  };
  return {.check = check, .measure = [test, against_reference] { return *against_reference(*test); }};
}

}  // namespace

void add_filter_cases(Suite& suite) {
  const std::pair<const char*, Image (*)(const OneSample&)> filters[] = {{"taa", taa}, {"fxaa", fxaa}, {"smaa", smaa}};
  for (const auto& [name, filter] : filters) {
    const std::string full = std::string("filter.") + name + ".curly50k";
    suite.cases.push_back(
        {full, "pixels_per_second", "1/s", [f = filter] { return filter_workload(one_sample("curly50k"), f); }});
    suite.ratios.push_back({std::string("filter.scaling.") + name, {full, 2}, {full, 1}});
  }
  for (const std::string& groom : {std::string("straight50k"), std::string("curly50k")})
    for (const NamedMethod& m : kMethods)
      for (const char* metric : {"flip", "mse", "psnr"})
        suite.cases.push_back({std::string("quality.") + m.name + "." + groom, metric,
                               metric == std::string("psnr") ? "dB" : "1", [=] { return quality_workload(groom, m, metric); }});
}

}  // namespace pelage::bench
