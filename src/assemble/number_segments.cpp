#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "assemble/assemble.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

constexpr float kMaxChordError = 0.1f;    // pixels
constexpr int kCoarseSamples = 8;         // a pixel, up to which chords may err that much
constexpr float kTolerableShare = 0.02f;  // of the spans looked at may be worse
constexpr std::size_t kSampledStrands = 512;

/// How far the curve of a span leaves its chord, pixels: |P''|/8, with P'' from the second differences of the control
/// points (6 of them for a Bezier cubic, 1 where the curve passes evenly through or near its points).
float chord_error(const AssembleJob& job, std::uint32_t i, std::uint32_t begin, std::uint32_t end) {
  const auto& p = job.strands->points;
  const auto bend = [&](std::uint32_t j) {
    if (j == begin || j + 1 >= end) return 0.f;
    const Vec3 c = transform_point(job.to_camera, p[j]);
    if (!(c.z >= job.view.near_plane)) return 0.f;
    const Vec3 d = transform_vector(job.to_camera, p[j - 1] - p[j] * 2.f + p[j + 1]);
    return std::hypot(d.x, d.y) * pixels_per_metre(job.view, c.z);
  };
  const bool bezier = job.strands->basis == CurveBasis::kBezier;
  const float worst = bezier ? std::max(bend(i + 1), bend(i + 2)) * 6 : std::max(bend(i), bend(i + 1));
  return worst / 8;
}

/// Pixels that chords may be off: the less, the more samples a picture takes to be exact (docs/derivations/raster.md).
float tolerable_error(const RenderSettings& settings) {
  const bool sampled = settings.method == Method::kMsaa || settings.method == Method::kSsaa;
  const int samples = sampled ? settings.samples : 1;
  return kMaxChordError * static_cast<float>(kCoarseSamples) / static_cast<float>(std::max(samples, kCoarseSamples));
}

/// The least number of parts a span that keeps all but a small share of the chords within `tolerable` pixels.
std::uint32_t choose_subdivisions(const AssembleJob& job, float tolerable) {
  const StrandSet& set = *job.strands;
  if (set.basis == CurveBasis::kLinear) return 1;
  const std::size_t stride = std::max<std::size_t>(1, set.strand_count() / kSampledStrands);
  const std::uint32_t span = points_per_span(set.basis);
  std::vector<float> errors;
  for (std::size_t s = 0; s < set.strand_count(); s += stride)
    for (std::uint32_t i = set.offsets[s], end = set.offsets[s + 1]; i + span < end; i += span)
      errors.push_back(chord_error(job, i, set.offsets[s], end));
  if (errors.empty()) return 1;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(static_cast<float>(errors.size() - 1) * (1 - kTolerableShare));
  std::nth_element(errors.begin(), at, errors.end());
  // Halving a chord quarters its distance from the curve.
  const float wanted = std::ceil(std::sqrt(*at / tolerable));
  return static_cast<std::uint32_t>(std::clamp(wanted, 1.f, static_cast<float>(kMaxSubdivisions)));
}

AssembleJob make_job(const GroomInstance& groom, const CameraView& view) {
  AssembleJob job;
  job.strands = groom.strands.get();
  if (groom.only) job.parts = *groom.only;
  job.view = view;
  job.to_camera = compose(view.world_to_camera, groom.transform);
  job.width_scale = groom.width_scale * similarity_scale(groom.transform);
  return job;
}

}  // namespace

SegmentNumbering number_segments(const Scene& scene, const CameraView& view) {
  SegmentNumbering numbering;
  std::uint64_t ids = 0;
  for (const GroomInstance& groom : scene.grooms) {
    const std::uint32_t subdivisions = scene.settings.subdivisions > 0
                                           ? static_cast<std::uint32_t>(scene.settings.subdivisions)
                                           : choose_subdivisions(make_job(groom, view), tolerable_error(scene.settings));
    numbering.groom_base.push_back(static_cast<std::uint32_t>(ids));
    numbering.subdivisions.push_back(subdivisions);
    ids += static_cast<std::uint64_t>(groom.strands->point_count()) * subdivisions;
    if (ids >= ScreenBlock::kNoSegment)
      throw Error("groom", groom.name, fmt::format("{} segments, more than 32-bit ids can name", ids),
                  "lower `subdivisions` or split the scene");
  }
  numbering.groom_base.push_back(static_cast<std::uint32_t>(ids));
  return numbering;
}

AssembleJob make_assemble_job(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                              std::size_t groom) {
  AssembleJob job = make_job(scene.grooms[groom], view);
  job.subdivisions = numbering.subdivisions[groom];
  job.base_id = numbering.groom_base[groom];
  return job;
}

}  // namespace pelage
