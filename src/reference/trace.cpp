// The list of what tracing a picture does: check, build, resume, pass after pass, develop.
#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/trace.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "frame/sample_positions.h"
#include "reference/checkpoint.h"
#include "reference/film.h"
#include "reference/path_tracer.h"
#include "reference/scene_check.h"

namespace pelage {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTile = 16;
/// Noise is judged at multiples of this many samples, so that where a picture ends does not depend on the machine.
constexpr std::uint32_t kNoiseStep = 16;
/// Between two looks at the clock.
constexpr double kPassSeconds = 0.5;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void check_settings(const TraceSettings& s) {
  const auto require = [](bool sound, const char* name, auto value, const char* range) {
    if (!sound) throw Error("trace settings", name, fmt::format("{} is out of range", value), range);
  };
  require(s.samples >= 1 && s.samples <= 1 << 20, "samples", s.samples, "1…1048576");
  require(s.seconds >= 0, "seconds", s.seconds, "0…");
  require(s.noise >= 0, "noise", s.noise, "0…");
  require(s.max_bounces >= 1 && s.max_bounces <= 1000, "max_bounces", s.max_bounces, "1…1000");
  require(s.checkpoint_seconds >= 0, "checkpoint_seconds", s.checkpoint_seconds, "0…");
}

/// Dual scattering counts strands on shadow rays; of thick hairs nobody has told it how many they are.
void check_integrator(const Scene& scene, const TraceSettings& s) {
  if (s.integrator != Integrator::kDual) return;
  for (const GroomInstance& groom : scene.grooms)
    if (groom.sections)
      throw Error("trace settings", "integrator", "dual scattering of thick hairs", "trace paths, or all strands");
}

bool has(const TraceSettings& settings, TraceLayer layer) {
  return std::find(settings.layers.begin(), settings.layers.end(), layer) != settings.layers.end();
}

/// Brings every pixel to `target` samples, tile by tile.
void add_pass(const PathTracer& tracer, std::uint32_t target, const Progress& progress, Film& film) {
  const int across = (film.width + kTile - 1) / kTile, down = (film.height + kTile - 1) / kTile;
  const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  SharedProgress shared(progress, "trace", tiles);
  parallel_for(tiles, 1, [&](std::size_t tile, std::size_t) {
    const int x0 = static_cast<int>(tile) % across * kTile, y0 = static_cast<int>(tile) / across * kTile;
    for (int y = y0; y < std::min(y0 + kTile, film.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, film.width); ++x) {
        const std::size_t p = static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) + static_cast<std::size_t>(x);
        while (film.pixels[p].samples < target) add_sample(film, p, tracer.sample(x, y, film.pixels[p].samples));
      }
    shared.add(1);
  });
}

/// Where the picture stands, and what there is left to do.
class Exposure {
 public:
  Exposure(const TraceSettings& settings, std::uint64_t mark, const Progress& progress, Film& film)
      : settings_(settings), mark_(mark), progress_(progress), film_(film), kept_(Clock::now()) {}

  void run(const PathTracer& tracer) {
    std::uint32_t step = 1;
    for (std::uint32_t at = film_.least_samples(); !done(at);) {
      const std::uint32_t target = next_target(at, step);
      const auto start = Clock::now();
      try {
        add_pass(tracer, target, share_of_pass(at, target), film_);
      } catch (...) {
        film_.seconds += seconds_since(start);
        keep();
        throw;
      }
      at = target;
      const double spent = seconds_since(start);
      film_.seconds += spent;
      if (spent < kPassSeconds / 2) step *= 2;
      else if (spent > kPassSeconds * 2) step = std::max(1u, step / 2);
      if (seconds_since(kept_) >= settings_.checkpoint_seconds) keep();
    }
    keep();
  }

 private:
  bool done(std::uint32_t at) const {
    if (at >= static_cast<std::uint32_t>(settings_.samples)) return true;
    if (settings_.seconds > 0 && film_.seconds >= settings_.seconds && at > 0) return true;
    return settings_.noise > 0 && at > 0 && at % kNoiseStep == 0 && picture_noise(film_) < settings_.noise;
  }

  std::uint32_t next_target(std::uint32_t at, std::uint32_t step) const {
    std::uint32_t target = std::min(at + step, static_cast<std::uint32_t>(settings_.samples));
    if (settings_.noise > 0) target = std::min(target, (at / kNoiseStep + 1) * kNoiseStep);
    return target;
  }

  Progress share_of_pass(std::uint32_t at, std::uint32_t target) const {
    if (!progress_) return {};
    return [this, at, target, start = Clock::now()](std::string_view stage, double share) {
      const double samples = (at + share * (target - at)) / settings_.samples;
      const double time = settings_.seconds > 0 ? (film_.seconds + seconds_since(start)) / settings_.seconds : 0;
      return progress_(stage, std::min(1.0, std::max(samples, time)));
    };
  }

  void keep() {
    if (settings_.checkpoint.empty()) return;
    write_checkpoint(settings_.checkpoint, film_, mark_);
    kept_ = Clock::now();
  }

  const TraceSettings& settings_;
  const std::uint64_t mark_;
  const Progress& progress_;
  Film& film_;
  Clock::time_point kept_;
};

PathSettings path_settings(const Scene& scene, const TraceSettings& settings) {
  PathSettings path;
  path.integrator = settings.integrator;
  path.curve_shape = settings.curve_shape;
  path.split = has(settings, TraceLayer::kBounces) || has(settings, TraceLayer::kLobes);
  path.previous_camera = scene.previous_camera;
  path.max_bounces = settings.max_bounces;
  path.shadows = scene.settings.shadows;
  path.seed = settings.seed;
  if (settings.raster_positions) path.positions = pixel_sample_positions(settings.samples);
  return path;
}

FilmBackdrop backdrop(const RenderSettings& settings) {
  return settings.transparent_background ? FilmBackdrop{{0, 0, 0}, 0} : FilmBackdrop{settings.background, 1};
}

}  // namespace

TraceResult trace(const Scene& scene, const TraceSettings& settings, const Progress& progress) {
  if (has_unmade_strands(scene)) {
    Scene made = scene;
    expand_hair_meshes(made, progress);
    return trace(made, settings, progress);
  }
  check_settings(settings);
  check_scene(scene);
  check_integrator(scene, settings);
  if (progress && !progress("build", 0)) throw Error("trace", "", "cancelled", "");
  const auto start = Clock::now();
  const PathTracer tracer(scene, path_settings(scene, settings));
  const double build_seconds = seconds_since(start);

  const std::uint64_t mark = fingerprint(scene, settings);
  Film film(scene.settings.width, scene.settings.height, has(settings, TraceLayer::kBounces),
            has(settings, TraceLayer::kLobes));
  if (!settings.checkpoint.empty()) read_checkpoint(settings.checkpoint, mark, film);
  TraceResult result;
  result.resumed_samples = static_cast<int>(film.least_samples());
  const auto tracing = Clock::now();
  Exposure(settings, mark, progress, film).run(tracer);

  result.linear = develop(film, settings.layers, backdrop(scene.settings), scene.settings.exposure);
  result.samples = static_cast<int>(film.least_samples());
  result.noise = picture_noise(film);
  result.seconds = film.seconds;
  const auto samples = static_cast<std::uint64_t>(result.samples - result.resumed_samples) * film.pixels.size();
  result.stats = {{"build", build_seconds, tracer.bytes(), tracer.curve_count(), "curves"},
                  {"trace", seconds_since(tracing), film.bytes(), samples, "samples"}};
  return result;
}

}  // namespace pelage
