// simulate: frames per second of guides that follow a head which turns, in wind. pose_strands stands with lod.
#include <fmt/format.h>
#include <pelage/grow.h>
#include <pelage/simulate.h>

#include "bench.h"
#include "groom/rod.h"
#include "groom/slow_rod.h"
#include "grooms.h"

namespace pelage::bench {
namespace {

constexpr std::uint32_t kFrames = 12;

struct Turning {
  LodHierarchy lod;
  std::shared_ptr<const HeadShape> head = make_head_shape(mannequin_head());
  SimulationSettings settings;
  HeadMotion motion;

  explicit Turning(const std::string& name) : lod(build_lod(*groom(name), {.levels = 1})) {
    settings.frames = kFrames + 1, settings.wind = {2, 0, 0};
    motion = head_motion("turn", 1, neck_of(lod));
  }

  /// A free rod is where the slow one is.
  std::string check() const {
    SimulationSettings still = settings;
    still.wind = {}, still.support = 0.5f;
    for (std::size_t g = 0; g < lod.guide_count(); g += 32) {
      const Vec3* rest = &lod.guides[g * groom::Rod::kPoints];
      groom::Rod rod(rest, still, nullptr);
      slow::Rod reference({rest, rest + groom::Rod::kPoints}, still);
      groom::RodStep step;
      step.seconds = 1e-3f;
      for (int i = 0; i < 10; ++i) rod.step(step), reference.step(step);
      for (std::size_t j = 0; j < groom::Rod::kPoints; ++j)
        if (length(rod.points()[j] - reference.point(j)) > 1e-5f) return fmt::format("point {} of guide {} differs", j, g);
    }
    return "";
  }
};

Workload workload(const std::string& name) {
  const auto in = std::make_shared<Turning>(name);
  return {.check = [in] { return in->check(); },
          .run = [in] { simulate(in->lod, in->settings, in->motion, in->head); },
          .items = kFrames};
}

}  // namespace

void add_simulate_cases(Suite& suite) {
  suite.cases.push_back({"simulate.guides256", "frames_per_second", "1/s", [] { return workload("straight50k"); }});
}

}  // namespace pelage::bench
