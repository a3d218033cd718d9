// shade: evaluations per second of the whole stage, gathering included, under the default lights; 1920 × 1080, 4 samples.
#include "shade/shade.h"

#include <pelage/runtime.h>

#include <fmt/format.h>

#include <cstring>

#include "assemble/assemble.h"
#include "bench.h"
#include "core/mesh_tracer.h"
#include "frame/camera_view.h"
#include "grooms.h"
#include "light/light.h"
#include "raster/raster.h"
#include "raster/sample_positions.h"
#include "shade/evaluate.h"

namespace pelage::bench {
namespace {

constexpr int kSamples = 4;

struct Input {
  Scene scene;
  CameraView view;
  SegmentNumbering numbering;
  GBuffer gbuffer;
  LightRig rig;

  explicit Input(const std::string& groom) : scene(groom_scene(groom)) {
    add_default_lights(scene);
    view = make_camera_view(scene.camera, scene.settings.width, scene.settings.height);
    numbering = number_segments(scene, view);
    raster_strands(scene, view, numbering, {.center = false, .samples = kSamples}, gbuffer);
    rig = prepare_lights(scene, MeshTracer(scene.meshes));
  }
  Radiance run(Evaluator evaluator) const {
    const auto positions = sample_positions(kSamples);
    return shade_with(evaluator, scene, view, numbering, gbuffer, rig, {positions.data(), kSamples});
  }
};

std::string check(const Input& in) {
  const Radiance wide = in.run(evaluate), scalar = in.run(evaluate_scalar);
  if (wide.color.size() != scalar.color.size()) return "numbers of evaluations differ";
  for (std::size_t i = 0; i < wide.color.size(); ++i)
    if (!(wide.color[i] == scalar.color[i])) return fmt::format("evaluation {} differs", i);
  return "";
}

}  // namespace

void add_shade_cases(Suite& suite) {
  const auto add = [&](const std::string& name, const std::string& groom, Evaluator evaluator) {
    suite.cases.push_back({"shade." + name + "." + groom, "evaluations_per_second", "1/s", [groom, evaluator] {
      auto in = std::make_shared<Input>(groom);
      const double evaluations = static_cast<double>(in->run(evaluate).color.size());
      return Workload{.check = [in] { return check(*in); }, .run = [in, evaluator] { in->run(evaluator); }, .items = evaluations};
    }});
  };
  for (const std::string groom : {"straight50k", "curly50k", "sintel"}) {
    add("wide", groom, evaluate);
    add("scalar", groom, evaluate_scalar);
    const std::string wide = "shade.wide." + groom, scalar = "shade.scalar." + groom;
    suite.ratios.push_back({"shade.speedup." + groom, {wide}, {scalar}});
    if (groom == "sintel") suite.ratios.push_back({"shade.speedup_avx2." + groom, {wide, 0, "AVX2"}, {scalar}});
    suite.ratios.push_back({"shade.scaling." + groom, {wide, 2}, {wide, 1}});
  }
}

}  // namespace pelage::bench
