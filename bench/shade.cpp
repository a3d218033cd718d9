// shade: evaluations per second of the whole stage, gathering included, under the default lights (480 × 270, 4 samples: the
// one-lane reference has to end), and of the scattering models alone: one light, no maps.
#include "shade/shade.h"

#include <pelage/runtime.h>

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "assemble/assemble.h"
#include "bench.h"
#include "core/mesh_tracer.h"
#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/fiber.h"
#include "grooms.h"
#include "light/light.h"
#include "raster/raster.h"
#include "frame/sample_positions.h"
#include "shade/evaluate.h"

namespace pelage::bench {
namespace {

constexpr int kWidth = 480, kHeight = 270, kSamples = 4;

struct Input {
  Scene scene;
  CameraView view;
  SegmentNumbering numbering;
  GBuffer gbuffer;
  LightRig rig;

  explicit Input(const std::string& groom) : scene(groom_scene(groom)) {
    scene.settings.width = kWidth, scene.settings.height = kHeight;
    add_default_lights(scene);
    view = make_camera_view(scene.camera, kWidth, kHeight);
    numbering = number_segments(scene, view);
    raster_strands(scene, view, numbering, {.center = false, .samples = kSamples}, gbuffer);
    rig = prepare_lights(scene, MeshTracer(scene.meshes));
  }
  Radiance run(Evaluator evaluator) const {
    const auto positions = sample_positions(kSamples);
    return shade_with(evaluator, scene, view, numbering, gbuffer, rig, {positions.data(), kSamples});
  }
};

/// Made once and kept while someone uses it: both sides of a ratio do.
std::shared_ptr<const Input> input(const std::string& groom) {
  static std::map<std::string, std::weak_ptr<const Input>> made;
  std::shared_ptr<const Input> in = made[groom].lock();
  if (!in) made[groom] = in = std::make_shared<const Input>(groom);
  return in;
}

std::string check(const Input& in) {
  const Radiance wide = in.run(evaluate), scalar = in.run(evaluate_scalar);
  if (wide.color.size() != scalar.color.size()) return "numbers of evaluations differ";
  for (std::size_t i = 0; i < wide.color.size(); ++i)
    if (!(wide.color[i] == scalar.color[i])) return fmt::format("evaluation {} differs", i);
  return "";
}

struct Model {
  const char* name;
  HairMaterial::Model model;
  bool dual_scattering;
};
constexpr Model kModels[] = {{"kajiya-kay", HairMaterial::Model::kKajiyaKay, false},
                             {"marschner", HairMaterial::Model::kMarschner, false},
                             {"zhu", HairMaterial::Model::kZhu, false},
                             {"sadeghi", HairMaterial::Model::kSadeghi, false},
                             {"chiang", HairMaterial::Model::kChiang, false},
                             {"pelekis", HairMaterial::Model::kPelekis, false},
                             {"dual", HairMaterial::Model::kMarschner, true},
                             {"dual_pelekis", HairMaterial::Model::kPelekis, true}};

/// Fibers of all directions under a light from above.
struct Fibers {
  static constexpr int kRepeats = 64;
  ShadeConstants constants;
  ShadeBatch batch;

  explicit Fibers(const Model& model) {
    HairMaterial material;
    material.model = model.model;
    LightRig rig;
    rig.lights.emplace_back();
    rig.lights[0].light.direction = normalize(Vec3(0.3f, -1, -0.2f));
    constants = shade_constants(material, model.dual_scattering, rig);
    const Vec3 absorption = fiber_absorption(material, material.color);
    batch.count = ShadeBatch::kSize;
    for (std::size_t i = 0; i < ShadeBatch::kSize + ShadeBatch::kPadding; ++i) {
      Rng rng(1, static_cast<std::uint32_t>(i));
      const auto direction = [&] {
        const float z = 2 * rng.uniform() - 1, around = 6.2831853f * rng.uniform(), r = std::sqrt(std::max(0.f, 1 - z * z));
        return Vec3(r * std::cos(around), r * std::sin(around), z);
      };
      const Vec3 tangent = direction(), to_eye = direction();
      batch.px[i] = batch.py[i] = batch.pz[i] = 0;
      batch.tx[i] = tangent.x, batch.ty[i] = tangent.y, batch.tz[i] = tangent.z;
      batch.ex[i] = to_eye.x, batch.ey[i] = to_eye.y, batch.ez[i] = to_eye.z;
      batch.absorb_r[i] = absorption.x, batch.absorb_g[i] = absorption.y, batch.absorb_b[i] = absorption.z;
    }
  }
  void run(Evaluator evaluator) {
    for (int i = 0; i < kRepeats; ++i) evaluator(constants, batch);
  }
  std::string check() {
    evaluate(constants, batch);
    const ShadeBatch wide = batch;
    evaluate_scalar(constants, batch);
    for (std::size_t i = 0; i < batch.count; ++i)
      if (!(wide.r[i] == batch.r[i] && wide.g[i] == batch.g[i] && wide.b[i] == batch.b[i]))
        return fmt::format("fiber {} differs", i);
    return "";
  }
};

void add_groom_cases(Suite& suite, const std::string& groom) {
  const auto add = [&](const std::string& name, Evaluator evaluator) {
    suite.cases.push_back({name, "evaluations_per_second", "1/s", [groom, evaluator] {
                             const auto in = input(groom);
                             const double evaluations = static_cast<double>(in->run(evaluate).color.size());
                             return Workload{.check = [in] { return check(*in); },
                                             .run = [in, evaluator] { in->run(evaluator); },
                                             .items = evaluations};
                           }});
  };
  const std::string wide = "shade.wide." + groom, scalar = "shade.scalar." + groom;
  add(wide, evaluate);
  add(scalar, evaluate_scalar);
  suite.ratios.push_back({"shade.speedup." + groom, {wide}, {scalar}});
  suite.ratios.push_back({"shade.speedup_avx2." + groom, {wide, 0, "AVX2"}, {scalar}});
  suite.ratios.push_back({"shade.scaling." + groom, {wide, 2}, {wide, 1}});
}

void add_model_cases(Suite& suite, const Model& model) {
  const auto add = [&](const std::string& name, Evaluator evaluator) {
    suite.cases.push_back({name, "evaluations_per_second", "1/s", [model, evaluator] {
                             const auto fibers = std::make_shared<Fibers>(model);
                             return Workload{.check = [fibers] { return fibers->check(); },
                                             .run = [fibers, evaluator] { fibers->run(evaluator); },
                                             .items = double{Fibers::kRepeats} * ShadeBatch::kSize};
                           }});
  };
  const std::string wide = fmt::format("shade.bcsdf_wide.{}", model.name),
                    scalar = fmt::format("shade.bcsdf_scalar.{}", model.name);
  add(wide, evaluate);
  add(scalar, evaluate_scalar);
  suite.ratios.push_back({fmt::format("shade.bcsdf.{}", model.name), {wide}, {scalar}});
  suite.ratios.push_back({fmt::format("shade.bcsdf_avx2.{}", model.name), {wide, 0, "AVX2"}, {scalar}});
}

}  // namespace

void add_shade_cases(Suite& suite) {
  for (const std::string groom : {"straight50k", "curly50k", "sintel"}) add_groom_cases(suite, groom);
  for (const Model& model : kModels) add_model_cases(suite, model);
  // What fitted lobes save over the model that they are fitted to.
  suite.ratios.push_back({"shade.fitted", {"shade.bcsdf_wide.pelekis"}, {"shade.bcsdf_wide.chiang"}});
  suite.ratios.push_back({"shade.fitted_scalar", {"shade.bcsdf_scalar.pelekis"}, {"shade.bcsdf_scalar.chiang"}});
  suite.ratios.push_back({"shade.fitted_dual", {"shade.bcsdf_wide.dual_pelekis"}, {"shade.bcsdf_wide.dual"}});
}

}  // namespace pelage::bench
