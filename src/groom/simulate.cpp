// Guides over time: the settings, the head, and the loop over frames and substeps.
#include <pelage/error.h>
#include <pelage/simulate.h>

#include <fmt/format.h>

#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "groom/head_grid.h"
#include "groom/head_motion.h"
#include "groom/rod.h"

namespace pelage {
namespace {

constexpr std::size_t kGuidesPerTask = 4;
constexpr float kFastest = 1000;  // wind, m/s, and gravity, m/s²

template <class T>
void require(bool sound, const char* name, T value, const char* range) {
  if (!sound) throw Error("simulation", name, fmt::format("{} is out of range", value), range);
}

void require_between(float value, float least, float most, const char* name) {
  if (!(value >= least && value <= most))
    throw Error("simulation", name, fmt::format("{} is out of range", value), fmt::format("{} … {}", least, most));
}

void check(const SimulationSettings& s) {
  require(s.frames >= 1 && s.frames <= 100000, "frames", s.frames, "1 … 100000");
  require(s.first_frame >= -1000000 && s.first_frame <= 1000000, "first_frame", s.first_frame, "-1000000 … 1000000");
  require_between(s.frame_rate, 1, 1000, "frame_rate");
  require_between(s.longest_step, 1e-5f, 0.02f, "longest_step");
  require_between(s.preroll, 0, 60, "preroll");
  require_between(length(s.gravity), 0, kFastest, "gravity");
  require_between(s.support, 0, 1, "support");
  require_between(s.bend_stiffness, 0, 1, "bend_stiffness");
  require_between(s.stretch_stiffness, 1, 1e9f, "stretch_stiffness");
  require_between(s.most_stretch, 0.001f, 1, "most_stretch");
  require_between(s.shape_frequency, 0, 100, "shape_frequency");
  require_between(s.damping, 0, 1000, "damping");
  require_between(s.drag, 0, 1000, "drag");
  require_between(length(s.wind), 0, kFastest, "wind");
  require_between(s.gusts, 0, 10, "gusts");
  require_between(s.gust_size, 0.01f, 100, "gust_size");
  require_between(s.clearance, 0, 0.1f, "clearance");
  require_between(s.friction, 0, 1, "friction");
}

/// The substeps of a span of time: equal ones, none longer than the settings allow.
std::vector<groom::RodStep> substeps(const HeadMotion& motion, double from, double to, float longest) {
  const auto count = static_cast<std::size_t>(std::max(1., std::ceil((to - from) / static_cast<double>(longest) - 1e-6)));
  std::vector<groom::RodStep> steps(count);
  Rigid head = groom::head_pose(motion, from);
  for (std::size_t i = 0; i < count; ++i) {
    steps[i].head_before = head;
    steps[i].time = from + (to - from) * static_cast<double>(i + 1) / static_cast<double>(count);
    steps[i].head = head = groom::head_pose(motion, steps[i].time);
    steps[i].seconds = static_cast<float>((to - from) / static_cast<double>(count));
  }
  return steps;
}

void advance(std::vector<groom::Rod>& rods, const std::vector<groom::RodStep>& steps) {
  parallel_for(rods.size(), kGuidesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (const groom::RodStep& step : steps) rods[r].step(step);
  });
}

void keep_frame(const std::vector<groom::Rod>& rods, const Rigid& head, GuideAnimation& animation) {
  for (const groom::Rod& rod : rods) animation.guides.insert(animation.guides.end(), rod.points().begin(), rod.points().end());
  animation.head.push_back(to_affine(head));
}

void tell(const Progress& progress, double share) {
  if (progress && !progress("simulate", share)) throw Error("simulate", "", "cancelled", "");
}

}  // namespace

GuideAnimation simulate(const LodHierarchy& lod, const SimulationSettings& settings, const HeadMotion& motion,
                        const std::shared_ptr<const HeadShape>& head, const Progress& progress) {
  check(settings);
  groom::check(motion);
  if (lod.empty()) throw Error("simulation", "guides", "the groom has none", "pelage lod build");
  std::vector<groom::Rod> rods;
  rods.reserve(lod.guide_count());
  for (std::size_t g = 0; g < lod.guide_count(); ++g)
    rods.emplace_back(&lod.guides[g * groom::Rod::kPoints], settings, head ? &head->grid : nullptr);

  const Rigid start = groom::head_pose(motion, 0);
  for (groom::Rod& rod : rods) rod.put(start);
  if (settings.preroll > 0) {
    HeadMotion still = motion;
    if (!still.keys.empty()) still.keys.resize(1), still.keys[0] = groom::key_at(motion, 0);
    advance(rods, substeps(still, -static_cast<double>(settings.preroll), 0, settings.longest_step));
  }
  GuideAnimation animation;
  animation.frame_rate = settings.frame_rate, animation.first_frame = settings.first_frame;
  animation.guides.reserve(lod.guides.size() * settings.frames), animation.head.reserve(settings.frames);
  keep_frame(rods, start, animation);
  const double rate = static_cast<double>(settings.frame_rate);
  for (std::uint32_t f = 1; f < settings.frames; ++f) {
    tell(progress, static_cast<double>(f) / settings.frames);
    advance(rods, substeps(motion, (f - 1) / rate, f / rate, settings.longest_step));
    keep_frame(rods, groom::head_pose(motion, f / rate), animation);
  }
  tell(progress, 1);
  return animation;
}

}  // namespace pelage
