// Scene in, truth out: an unbiased path tracer of the very scene that render() draws.
#pragma once

#include <pelage/image.h>
#include <pelage/progress.h>
#include <pelage/render.h>
#include <pelage/scene.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

/// How light is carried from the lights to the eye.
enum class Integrator {
  kPath,    ///< every bounce, up to TraceSettings::max_bounces: the truth
  kDual,    ///< dual scattering with every strand on the shadow ray counted exactly (Zinke 2008, Huang 2025 §6)
  kSingle,  ///< lights and environment by one scattering event
};

/// What a ray meets where a strand is.
enum class CurveShape {
  kFlat,   ///< bands that face each ray, as raster draws them
  kRound,  ///< tubes
};

/// Layers beside R, G, B and A; each adds the channels named here. First-hit layers (marked *) are those of the nearest of
/// a pixel's samples, 0 where nothing is hit; the others are means over all samples.
enum class TraceLayer {
  kVariance,  ///< variance.R, .G, .B: variance of the pixel's mean, from its samples; 0 below two samples
  kCoverage,  ///< coverage: share of samples that see a strand first
  kDepth,     ///< Z*: camera depth, metres
  kPosition,  ///< position.X, .Y, .Z*: metres, world
  kTangent,   ///< tangent.X, .Y, .Z*: unit length, root to tip, world; 0 on meshes
  kNormal,    ///< normal.X, .Y, .Z*: unit length, world
  kStrand,    ///< groom, strand*: numbers from 1; 0 where no strand is nearest
  kU,         ///< u*: 0 root, 1 tip
  kAlbedo,    ///< albedo.R, .G, .B: of the first hit
  kMotion,    ///< motion.X, .Y*: pixels from this place to where it was a frame before
  kBounces,  ///< bounce0.R … bounce15.B: light that left its source so many scattering events before the first hit; the last takes the rest
  kLobes,    ///< R.R … surface.B: light by what the first hit did to it: R, TT, TRT, rest, surface
};

struct TraceSettings {
  Integrator integrator = Integrator::kPath;
  CurveShape curve_shape = CurveShape::kFlat;
  int samples = 64;               ///< per pixel, 1…2²⁰; `seconds` and `noise` may end earlier
  double seconds = 0;             ///< tracing ends with the pass that reaches them; 0: no limit
  float noise = 0;                ///< tracing ends when picture_noise() falls below; 0: no limit
  int max_bounces = 70;           ///< scattering events of a path, 1…1000
  std::uint64_t seed = 0;         ///< another seed, other random numbers
  bool raster_positions = false;  ///< samples stand where those of a picture of `samples` samples a pixel stand in render()
  std::vector<TraceLayer> layers;
  std::string checkpoint;          ///< file to go on from, where it exists, and to keep the state in; empty: none
  double checkpoint_seconds = 60;  ///< between two states that are kept; also kept at the end and when cancelled
};

struct TraceResult {
  Image linear;                  ///< R, G, B, A, then the layers; scene-linear, exposure applied to colors, premultiplied
  int samples = 0;               ///< per pixel
  int resumed_samples = 0;       ///< of these, found in the checkpoint
  float noise = 0;               ///< picture_noise() at the end
  double seconds = 0;            ///< of tracing, those in the checkpoint included
  std::vector<StageStat> stats;  ///< build, trace
};

/// Traces `scene` (size, exposure, background, shadows and hair of its settings; samples of `settings`).
///
/// The result is a pure function of scene, settings and the number of samples reached: the same bits for any number of
/// threads, resumed or not. A cancelled call throws Error, after the state went to the checkpoint. Throws Error on settings
/// out of range, on scenes with values that are not finite, and on a checkpoint of something else or a damaged one.
TraceResult trace(const Scene& scene, const TraceSettings& settings, const Progress& progress = {});

}  // namespace pelage
