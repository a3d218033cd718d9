#include "assemble/assemble_wide.h"

#include <algorithm>

#include "frame/curve_basis.h"
#include "frame/segment_lookup.h"
#include "kernel/scalar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "assemble/assemble_wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

#ifndef PELAGE_ASSEMBLE_SCALAR_PART_
#define PELAGE_ASSEMBLE_SCALAR_PART_
namespace pelage {
namespace {

/// Control points of one strand in camera space, with a phantom point before the first and one after the last.
/// Point i of the strand stands at i + 1; whole lanes may be read behind the end.
struct Controls {
  Buffer<float> x, y, z, half_width;
  void reserve(std::size_t points) {
    const std::size_t size = points + 2 + ScreenBlock::kPadding;
    if (x.size() >= size) return;
    for (Buffer<float>* b : {&x, &y, &z, &half_width}) b->resize(size), b->fill(1.f);
  }
};

Controls& thread_controls() {
  thread_local Controls controls;
  return controls;
}

/// A turn on the spot, or segments seen end-on: the caps of `block` point by point.
void set_degenerate_caps(ScreenBlock& block) {
  Vec2 previous;
  float previous_length = 0;
  for (std::size_t i = 0; i < block.count; ++i) {
    const bool last = block.id[i] == ScreenBlock::kNoSegment;
    const Vec2 next = last ? Vec2() : Vec2(block.x[i + 1] - block.x[i], block.y[i + 1] - block.y[i]);
    const float next_length = length(next);
    Vec2 cap = kernel::raster_cap(previous, previous_length, next, next_length);
    if (!(dot(cap, cap) > 0)) {
      cap = next_length > 0 ? next : previous;
      // Exactly opposite directions: any line between the two will do, as long as both take the same.
      if (previous_length > 0 && next_length > 0) cap = Vec2(-previous.y, previous.x);
    }
    block.cap_x[i] = cap.x, block.cap_y[i] = cap.y;
    // A segment of no length leaves the direction as it was.
    if (next_length > 0) previous = next, previous_length = next_length;
    if (last) previous = Vec2(), previous_length = 0;
  }
}

}  // namespace
}  // namespace pelage
#endif  // PELAGE_ASSEMBLE_SCALAR_PART_

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using wide::Float;
using wide::Mask;

const wide::UintTag kUint{};
const wide::FloatTag kFloat{};

Mask equal(hn::Vec<wide::UintTag> a, std::uint32_t b) { return Mask{hn::RebindMask(kFloat, hn::Eq(a, hn::Set(kUint, b)))}; }

/// Camera space of points [begin, end) of the set to x, y, z, and half widths in metres. Writes whole lanes.
void transform_points(const AssembleJob& job, std::size_t begin, std::size_t end, float* x, float* y, float* z, float* w) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  const StrandSet& set = *job.strands;
  const Affine& m = job.to_camera;
  const float half = 0.5f * job.width_scale;
  const bool one_width = set.widths.size() == 1;
  HWY_ALIGN float tail[4 * hn::MaxLanes(wide::FloatTag())] = {};
  for (std::size_t i = begin; i < end; i += lanes) {
    const float* points = &set.points[i].x;
    const float* widths = one_width ? nullptr : &set.widths[i];
    if (i + lanes > set.points.size()) {
      std::copy(points, points + 3 * (end - i), tail);
      if (!one_width) std::copy(widths, widths + (end - i), tail + 3 * lanes), widths = tail + 3 * lanes;
      points = tail;
    }
    wide::Vec3 p;
    hn::LoadInterleaved3(kFloat, points, p.x.v, p.y.v, p.z.v);
    const auto row = [&](int r) {
      return Float(m.m[r][0]) * p.x + Float(m.m[r][1]) * p.y + Float(m.m[r][2]) * p.z + Float(m.m[r][3]);
    };
    const std::size_t at = i - begin;
    store(row(0), x + at), store(row(1), y + at), store(row(2), z + at);
    store((one_width ? Float(set.widths[0]) : wide::load(widths)) * Float(half), w + at);
  }
}

/// Camera space of the control points that the spans of a part blend: its own, and a neighbor or a phantom at either end.
void part_controls(const AssembleJob& job, const StrandPart& part, Controls& c) {
  const StrandSet& set = *job.strands;
  const std::uint32_t begin = first_point(set, part), end = begin + part.spans * points_per_span(set.basis) + 1;
  const bool from_root = begin == set.offsets[part.strand], to_tip = end == set.offsets[part.strand + 1];
  const std::size_t count = end - begin, before = from_root ? 0 : 1;
  c.reserve(count);
  transform_points(job, begin - before, end + (to_tip ? 0 : 1), &c.x[1 - before], &c.y[1 - before], &c.z[1 - before],
                   &c.half_width[1 - before]);
  for (Buffer<float>* b : {&c.x, &c.y, &c.z}) {
    float* p = b->data();
    if (from_root) p[0] = p[1] * 2.f - p[2];
    if (to_tip) p[count + 1] = p[count] * 2.f - p[count - 1];
  }
}

/// Every span of a part cut into pieces: points q = 0 … spans·pieces from `at` on.
void refine_part(const AssembleJob& job, const StrandPart& part, std::size_t at, ScreenBlock& block) {
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  const StrandSet& set = *job.strands;
  const std::size_t spans = part.spans, pieces = job.subdivisions, stride = points_per_span(set.basis);
  Controls& c = thread_controls();
  part_controls(job, part, c);
  // Blended control points of span s: s … s + 3 (with the phantoms) or, for Bézier, 3s + 1 … 3s + 4.
  const std::size_t blended = stride == 3 ? 1 : 0;
  const hn::Vec<wide::IntTag> lane = hn::Iota(wide::IntTag(), 0);
  const auto load_strided = [&](const float* p) {
    return stride == 1 ? wide::load(p) : Float(hn::GatherIndex(kFloat, p, hn::Mul(lane, hn::Set(wide::IntTag(), 3))));
  };
  HWY_ALIGN float out[4][hn::MaxLanes(wide::FloatTag())];
  float* const targets[4] = {&block.x[at], &block.y[at], &block.depth[at], &block.radius[at]};
  const auto blend_piece = [&](std::size_t s, std::size_t k, float t) {
    const Vec4 weights = basis_weights(set.basis, t);
    const wide::Vec4 w(weights.x, weights.y, weights.z, weights.w);
    const std::size_t first = s * stride + blended;
    const auto control = [&](std::size_t j) {
      return wide::Vec3(load_strided(&c.x[first + j]), load_strided(&c.y[first + j]), load_strided(&c.z[first + j]));
    };
    const wide::Vec3 p = wide::curve_combine(w, control(0), control(1), control(2), control(3));
    const Float wa = load_strided(&c.half_width[s * stride + 1]);
    const Float wb = load_strided(&c.half_width[s * stride + 1 + stride]);
    store(p.x, out[0]), store(p.y, out[1]), store(p.z, out[2]), store(wa + (wb - wa) * Float(t), out[3]);
    for (std::size_t l = 0; l < std::min(lanes, spans - s); ++l)
      for (int channel = 0; channel < 4; ++channel) targets[channel][(s + l) * pieces + k] = out[channel][l];
  };
  for (std::size_t s = 0; s < spans; s += lanes)
    for (std::size_t k = 0; k < pieces; ++k) blend_piece(s, k, static_cast<float>(k) / static_cast<float>(pieces));
  blend_piece(spans - 1, pieces, 1.f);
}

/// Writes consecutive ids from `id` on to points at … at + count − 2 and kNoSegment to the last.
void number_points(std::uint32_t id, std::size_t at, std::size_t count, ScreenBlock& block) {
  std::uint32_t* ids = &block.id[at];
  for (std::size_t i = 0; i < count; i += hn::Lanes(kUint))
    hn::StoreU(hn::Iota(kUint, id + static_cast<std::uint32_t>(i)), kUint, ids + i);
  ids[count - 1] = ScreenBlock::kNoSegment;
}

/// Appends the points of parts from number `first` of the job on, as long as they follow each other in memory. Returns the
/// number after the last.
std::size_t copy_run(const AssembleJob& job, std::size_t first, std::size_t end, ScreenBlock& block) {
  const StrandSet& set = *job.strands;
  const std::uint32_t from = first_point(set, part_at(job, first));
  std::uint32_t to = from;
  std::size_t next = first;
  for (; next < end; ++next) {
    const StrandPart part = part_at(job, next);
    if (part.spans == 0 || first_point(set, part) != to) break;
    to += part.spans + 1;
  }
  const std::size_t at = block.count;
  transform_points(job, from, to, &block.x[at], &block.y[at], &block.depth[at], &block.radius[at]);
  number_points(job.base_id + from, at, to - from, block);
  std::size_t last = at;  // point of the part
  for (std::size_t i = first; i < next; ++i) {
    last += part_at(job, i).spans;
    block.id[last++] = ScreenBlock::kNoSegment;
  }
  block.count += to - from;
  return next;
}

void CameraPoints(const AssembleJob& job, std::size_t first, std::size_t end, ScreenBlock& block) {
  const StrandSet& set = *job.strands;
  const std::uint32_t pieces = job.subdivisions;
  const bool through_points = set.basis == CurveBasis::kLinear || set.basis == CurveBasis::kCatmullRom;
  block.count = 0;
  const auto empty = [&](std::size_t i) { return part_at(job, i).spans == 0; };
  if (pieces == 1 && through_points) {
    for (std::size_t i = first; i < end;) i = empty(i) ? i + 1 : copy_run(job, i, end, block);
    return;
  }
  for (std::size_t i = first; i < end; ++i) {
    if (empty(i)) continue;
    const StrandPart part = part_at(job, i);
    const std::size_t points = std::size_t{part.spans} * pieces + 1;
    refine_part(job, part, block.count, block);
    number_points(job.base_id + (set.offsets[part.strand] + part.first_span) * pieces, block.count, points, block);
    block.count += points;
  }
}

bool NeedsClipping(const AssembleJob& job, const ScreenBlock& block) {
  const CameraView& v = job.view;
  const Float reach =
      kGuardBand + std::min(std::min(v.center_x, v.width - v.center_x), std::min(v.center_y, v.height - v.center_y));
  const std::size_t lanes = static_cast<std::size_t>(wide::lanes());
  const Mask perspective = equal(hn::Set(kUint, v.perspective), 1);
  const std::size_t whole = block.count / lanes * lanes;
  const auto outside = [&](std::size_t i) {
    const Float z = wide::load(&block.depth[i]);
    const Float most = Float(v.focal) * max(abs(wide::load(&block.x[i])), abs(wide::load(&block.y[i])));
    return z < Float(v.near_plane) || most > reach * select(perspective, z, Float(1.0f));
  };
  for (std::size_t i = 0; i < whole; i += lanes)
    if (wide::any(outside(i))) return true;
  if (whole == block.count) return false;
  const Mask used{hn::FirstN(kFloat, block.count - whole)};
  return wide::any(outside(whole) && used);
}

void set_caps(ScreenBlock& block) {
  block.cap_x[0] = block.x[1] - block.x[0];
  block.cap_y[0] = block.y[1] - block.y[0];
  bool degenerate = !(block.cap_x[0] * block.cap_x[0] + block.cap_y[0] * block.cap_y[0] > 0);
  for (std::size_t i = 1; i < block.count; i += static_cast<std::size_t>(wide::lanes())) {
    const Float x = wide::load(&block.x[i]), y = wide::load(&block.y[i]);
    const wide::Vec2 previous(x - wide::load(&block.x[i - 1]), y - wide::load(&block.y[i - 1]));
    const wide::Vec2 next(wide::load(&block.x[i + 1]) - x, wide::load(&block.y[i + 1]) - y);
    wide::Vec2 cap = wide::raster_cap(previous, sqrt(wide::dot(previous, previous)), next, sqrt(wide::dot(next, next)));
    const Mask starts = equal(hn::LoadU(kUint, &block.id[i - 1]), ScreenBlock::kNoSegment);
    const Mask ends = equal(hn::LoadU(kUint, &block.id[i]), ScreenBlock::kNoSegment);
    cap = select(starts, next, select(ends, previous, cap));
    store(cap.x, &block.cap_x[i]), store(cap.y, &block.cap_y[i]);
    const Mask used{hn::FirstN(kFloat, block.count - i)};
    degenerate = degenerate || wide::any(!(wide::dot(cap, cap) > Float(0.0f)) && used);
  }
  if (degenerate) set_degenerate_caps(block);
}

void ProjectPoints(const AssembleJob& job, ScreenBlock& block) {
  if (block.count == 0) return;
  const CameraView& view = job.view;
  const Mask perspective = equal(hn::Set(kUint, view.perspective), 1);
  for (std::size_t i = 0; i < block.count; i += static_cast<std::size_t>(wide::lanes())) {
    const Float scale = wide::raster_pixel_scale(perspective, Float(view.focal), wide::load(&block.depth[i]));
    store(Float(view.center_x) + scale * wide::load(&block.x[i]), &block.x[i]);
    store(Float(view.center_y) + scale * wide::load(&block.y[i]), &block.y[i]);
    store(wide::load(&block.radius[i]) * scale, &block.radius[i]);
  }
  set_caps(block);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(CameraPoints);
HWY_EXPORT(NeedsClipping);
HWY_EXPORT(ProjectPoints);

void camera_points(const AssembleJob& job, std::size_t first, std::size_t end, ScreenBlock& block) {
  HWY_DYNAMIC_DISPATCH(CameraPoints)(job, first, end, block);
}
bool needs_clipping(const AssembleJob& job, const ScreenBlock& block) {
  return HWY_DYNAMIC_DISPATCH(NeedsClipping)(job, block);
}
void project_points(const AssembleJob& job, ScreenBlock& block) { HWY_DYNAMIC_DISPATCH(ProjectPoints)(job, block); }

}  // namespace pelage
#endif
