#include "assemble/assemble.h"

#include <algorithm>

#include "assemble/clip.h"
#include "core/check.h"
#include "frame/camera_view.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

Vec4 basis_weights(CurveBasis basis, float t) {
  switch (basis) {
    case CurveBasis::kCatmullRom: return kernel::curve_catmull_rom_weights(t);
    case CurveBasis::kBSpline: return kernel::curve_bspline_weights(t);
    case CurveBasis::kBezier: return kernel::curve_bezier_weights(t);
    case CurveBasis::kLinear: break;
  }
  return kernel::curve_linear_weights(t);
}

void reserve(ScreenBlock& block, std::size_t points) {
  const std::size_t size = points + ScreenBlock::kPadding;
  if (block.x.size() >= size) return;
  for (Buffer<float>* b : {&block.x, &block.y, &block.depth, &block.radius, &block.cap_x, &block.cap_y}) {
    b->resize(size);
    b->fill(1.f);
  }
  block.id.resize(size);
  block.id.fill(ScreenBlock::kNoSegment);
}

/// Appends the refined points of one strand in camera space: x, y, depth and, in `radius`, half the width in metres.
void refine(const AssembleJob& job, std::size_t strand, ScreenBlock& block) {
  const StrandSet& set = *job.strands;
  const std::uint32_t begin = set.offsets[strand], end = set.offsets[strand + 1];
  const std::uint32_t spans = span_count(set.basis, end - begin), parts = job.subdivisions;
  const std::uint32_t stride = set.basis == CurveBasis::kBezier ? 3 : 1;
  if (spans == 0) return;
  const auto camera = [&](std::uint32_t i) { return transform_point(job.to_camera, set.points[i]); };
  const float half = 0.5f * job.width_scale;
  for (std::uint32_t s = 0; s < spans; ++s) {
    const std::uint32_t i = begin + s * stride;
    Vec3 p[4];
    if (stride == 3) {
      for (std::uint32_t j = 0; j < 4; ++j) p[j] = camera(i + j);
    } else {
      p[1] = camera(i), p[2] = camera(i + 1);
      p[0] = i > begin ? camera(i - 1) : p[1] * 2.f - p[2];
      p[3] = i + 2 < end ? camera(i + 2) : p[2] * 2.f - p[1];
    }
    const float wa = set.width(i) * half, wb = set.width(i + stride) * half;
    const std::uint32_t last = s + 1 == spans ? parts + 1 : parts;
    for (std::uint32_t k = 0; k < last; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(parts);
      const Vec3 c = kernel::curve_combine(basis_weights(set.basis, t), p[0], p[1], p[2], p[3]);
      const std::size_t at = block.count++;
      block.x[at] = c.x, block.y[at] = c.y, block.depth[at] = c.z;
      block.radius[at] = wa + (wb - wa) * t;
      block.id[at] = k < parts ? job.base_id + (begin + s) * parts + k : ScreenBlock::kNoSegment;
    }
  }
}

void project(const AssembleJob& job, ScreenBlock& block) {
  const CameraView& view = job.view;
  for (std::size_t i = 0; i < block.count; ++i) {
    const float scale = pixels_per_metre(view, block.depth[i]);
    block.x[i] = view.center_x + scale * block.x[i];
    block.y[i] = view.center_y + scale * block.y[i];
    block.radius[i] *= scale;
  }
}

/// Directions halfway between the two segments of each point: d_prev |d_next| + d_next |d_prev|, which needs no division.
void set_caps(ScreenBlock& block) {
  std::size_t i = 0;
  while (i < block.count) {
    Vec2 previous;
    float previous_length = 0;
    for (bool last = false; !last; ++i) {
      last = block.id[i] == ScreenBlock::kNoSegment;
      const Vec2 next = last ? Vec2() : Vec2(block.x[i + 1] - block.x[i], block.y[i + 1] - block.y[i]);
      const float next_length = length(next);
      Vec2 cap = previous * next_length + next * previous_length;
      if (!(dot(cap, cap) > 0)) {
        // An end of the strand, a segment seen end-on, or a turn on the spot (any cap between the two will do, but one).
        cap = next_length > 0 ? next : previous;
        if (previous_length > 0 && next_length > 0) cap = Vec2(-previous.y, previous.x);
      }
      block.cap_x[i] = cap.x, block.cap_y[i] = cap.y;
      // A segment of no length leaves the direction as it was.
      if (next_length > 0) previous = next, previous_length = next_length;
    }
  }
}

}  // namespace

std::size_t assemble_strands(const AssembleJob& job, std::size_t first, std::size_t last, ScreenBlock& block) {
  const StrandSet& set = *job.strands;
  PELAGE_CHECK(first < last && last <= set.strand_count());
  const auto points = [&](std::size_t s) {
    return std::size_t{span_count(set.basis, set.offsets[s + 1] - set.offsets[s])} * job.subdivisions + 1;
  };
  std::size_t end = first, total = 0;
  do total += points(end++);
  while (end < last && total + points(end) <= kBlockPoints);
  reserve(block, std::max(total, kBlockPoints));
  block.count = 0;
  for (std::size_t s = first; s < end; ++s) refine(job, s, block);
  if (needs_clipping(job, block)) clip(job, block);
  project(job, block);
  set_caps(block);
  return end;
}

}  // namespace pelage
