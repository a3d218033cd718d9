#include "assemble/strand_block.h"

#include <algorithm>

#include "assemble/clip.h"
#include "frame/camera_view.h"
#include "kernel/scalar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "assemble/strand_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using wide::Float;
using wide::Mask;
using wide::Vec3;

constexpr std::size_t kStride = StrandGroup::kLanes;

HWY_INLINE Vec3 transformed(const Affine& m, Vec3 p, float translate) {
  const auto row = [&](int r) {
    return Float(m.m[r][0]) * p.x + Float(m.m[r][1]) * p.y + Float(m.m[r][2]) * p.z + Float(m.m[r][3] * translate);
  };
  return Vec3(row(0), row(1), row(2));
}

HWY_INLINE hn::Vec<wide::UintTag> bits(Float whole, int shift) {
  return hn::Shl(hn::BitCast(wide::UintTag(), hn::ConvertTo(wide::IntTag(), whole.v)),
                 hn::Set(wide::UintTag(), static_cast<std::uint32_t>(shift)));
}

/// Payload of all points.
void PackStrands(const StrandGroup& g, const PayloadJob& job, ScreenBlock& block) {
  const wide::UintTag u32;
  for (std::size_t l = 0; l < kStride; l += hn::Lanes(u32)) {
    const Float cells(static_cast<float>(job.cells.count));
    const auto place =
        hn::Or(bits(wide::raster_cell(wide::load(&g.u[l]), cells) + Float(static_cast<float>(job.cells.first_u)), 18),
               bits(wide::raster_cell(wide::load(&g.v[l]), cells) + Float(static_cast<float>(job.cells.first_v)), 12));
    for (std::size_t i = 0; i < g.points; ++i) {
      const std::size_t at = i * kStride + l;
      const Vec3 t = transformed(job.to_world, Vec3(wide::load(&g.tx[at]), wide::load(&g.ty[at]), wide::load(&g.tz[at])), 0);
      const wide::Vec2 oct = wide::raster_octahedral(t);
      const float w = static_cast<float>(i) / static_cast<float>(g.points - 1);
      const Float occlusion = floor(wide::load(&g.occlusion[at]) * Float(63.0f) + Float(0.5f));
      hn::StoreU(bits(wide::raster_tangent_level(oct.x), 0), u32, &block.payload_high[at]);
      const auto low = hn::Or(hn::Or(bits(wide::raster_tangent_level(oct.y), 24), place),
                              hn::Or(bits(wide::raster_cell(Float(w), Float(64.0f)), 6), bits(occlusion, 0)));
      hn::StoreU(low, u32, &block.payload_low[at]);
    }
  }
}

/// Camera space of all points. Returns whether some must be clipped.
bool PlaceStrands(const StrandGroup& g, const ProjectJob& job, float widen, ScreenBlock& block) {
  const CameraView& v = job.view;
  const Float half(0.5f * job.width_scale * widen);
  const Float reach =
      kGuardBand + std::min(std::min(v.center_x, v.width - v.center_x), std::min(v.center_y, v.height - v.center_y));
  const Mask perspective = Float(v.perspective ? 1.0f : 0.0f) > Float(0.0f);
  Mask outside = Float(0.0f) > Float(1.0f);
  for (std::size_t at = 0; at < block.count; at += hn::Lanes(wide::UintTag())) {
    const Vec3 p = transformed(job.to_camera, Vec3(wide::load(&g.x[at]), wide::load(&g.y[at]), wide::load(&g.z[at])), 1);
    store(p.x, &block.x[at]), store(p.y, &block.y[at]), store(p.z, &block.depth[at]);
    store(wide::load(&g.width[at]) * half, &block.radius[at]);
    const Float most = Float(v.focal) * max(abs(p.x), abs(p.y));
    outside = outside || p.z < Float(v.near_plane) || most > reach * select(perspective, p.z, Float(1.0f));
  }
  return wide::any(outside);
}

/// Camera space → pixels, in place, and the caps.
void ProjectStrands(const ProjectJob& job, std::size_t points, ScreenBlock& block) {
  const CameraView& view = job.view;
  const Mask perspective = Float(view.perspective ? 1.0f : 0.0f) > Float(0.0f);
  for (std::size_t at = 0; at < block.count; at += hn::Lanes(wide::UintTag())) {
    const Float scale = wide::raster_pixel_scale(perspective, Float(view.focal), wide::load(&block.depth[at]));
    store(Float(view.center_x) + scale * wide::load(&block.x[at]), &block.x[at]);
    store(Float(view.center_y) + scale * wide::load(&block.y[at]), &block.y[at]);
    store(wide::load(&block.radius[at]) * scale, &block.radius[at]);
  }
  for (std::size_t l = 0; l < kStride; l += hn::Lanes(wide::UintTag())) {
    const auto point = [&](std::size_t i) {
      return wide::Vec2(wide::load(&block.x[i * kStride + l]), wide::load(&block.y[i * kStride + l]));
    };
    wide::Vec2 here = point(0), previous(Float(0.0f), Float(0.0f));
    Float previous_length(0.0f);
    for (std::size_t i = 0; i < points; ++i) {
      const bool first = i == 0, last = i + 1 == points;
      const wide::Vec2 there = last ? here : point(i + 1), next = there - here;
      const Float next_length = sqrt(wide::dot(next, next));
      wide::Vec2 cap = first ? next : last ? previous : wide::raster_cap(previous, previous_length, next, next_length);
      // A turn on the spot, or a segment of no length: the direction of one of the two.
      const wide::Vec2 either = select(next_length > Float(0.0f), next, previous);
      cap = select(wide::dot(cap, cap) > Float(0.0f), cap, either);
      store(cap.x, &block.cap_x[i * kStride + l]), store(cap.y, &block.cap_y[i * kStride + l]);
      here = there, previous = next, previous_length = next_length;
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(PackStrands);
HWY_EXPORT(PlaceStrands);
HWY_EXPORT(ProjectStrands);

namespace {

void reserve(ScreenBlock& block) {
  // Clipping puts points in pairs.
  constexpr std::size_t kSize = 2 * kHairMeshPoints * StrandGroup::kLanes + ScreenBlock::kPadding;
  if (block.payload_low.size() >= kSize) return;
  for (Buffer<float>* b : {&block.x, &block.y, &block.depth, &block.radius, &block.cap_x, &block.cap_y})
    b->resize(kSize), b->fill(1.f);
  for (Buffer<std::uint32_t>* b : {&block.id, &block.payload_high, &block.payload_low}) b->resize(kSize), b->fill(0);
}

void number_points(const StrandGroup& group, ScreenBlock& block) {
  for (std::size_t i = 0; i < group.points; ++i)
    for (std::size_t l = 0; l < StrandGroup::kLanes; ++l) {
      const std::size_t at = i * StrandGroup::kLanes + l;
      const bool segment = l < group.strands && i + 1 < group.points;
      block.id[at] = segment ? static_cast<std::uint32_t>(at) : ScreenBlock::kNoSegment;
    }
}

/// The segments of `whole` (camera space) that lie inside near plane and guard band, or what of them does, in pairs of points.
void clip_pairs(const CameraView& view, const ScreenBlock& whole, ScreenBlock& pairs) {
  reserve(pairs);
  pairs.count = 0, pairs.stride = 1;
  const auto point = [&](std::size_t i) { return ClipPoint{whole.x[i], whole.y[i], whole.depth[i], whole.radius[i]}; };
  const auto put = [&](const ClipPoint& p, std::size_t from, bool start) {
    const std::size_t at = pairs.count++;
    pairs.x[at] = static_cast<float>(p.x), pairs.y[at] = static_cast<float>(p.y);
    pairs.depth[at] = std::max(static_cast<float>(p.z), view.near_plane), pairs.radius[at] = static_cast<float>(p.radius);
    pairs.id[at] = start ? static_cast<std::uint32_t>(at) : ScreenBlock::kNoSegment;
    pairs.payload_high[at] = whole.payload_high[from], pairs.payload_low[at] = whole.payload_low[from];
  };
  for (std::size_t i = 0; i + whole.stride < whole.count; ++i) {
    if (whole.id[i] == ScreenBlock::kNoSegment) continue;
    ClipPoint a = point(i), b = point(i + whole.stride);
    if (!clip_segment(view, a, b)) continue;
    put(a, i, true), put(b, i + whole.stride, false);
  }
}

/// Camera space → pixels, in place; each pair of points is cut straight across.
void project_pairs(const CameraView& view, ScreenBlock& pairs) {
  for (std::size_t i = 0; i < pairs.count; ++i) {
    const float scale = pixels_per_metre(view, pairs.depth[i]);
    pairs.x[i] = view.center_x + scale * pairs.x[i], pairs.y[i] = view.center_y + scale * pairs.y[i];
    pairs.radius[i] *= scale;
  }
  for (std::size_t i = 0; i < pairs.count; i += 2)
    for (std::size_t end = i; end < i + 2; ++end)
      pairs.cap_x[end] = pairs.x[i + 1] - pairs.x[i], pairs.cap_y[end] = pairs.y[i + 1] - pairs.y[i];
}

}  // namespace

ProjectJob make_project_job(const CameraView& view, const GroomInstance& groom) {
  return {view, compose(view.world_to_camera, groom.transform), groom.width_scale * similarity_scale(groom.transform)};
}

void pack_group(const StrandGroup& group, const PayloadJob& job, StrandBlock& block) {
  reserve(block.points);
  block.points.count = group.points * StrandGroup::kLanes, block.points.stride = StrandGroup::kLanes;
  number_points(group, block.points);
  HWY_DYNAMIC_DISPATCH(PackStrands)(group, job, block.points);
}

const ScreenBlock& project_group(const StrandGroup& group, const ProjectJob& job, float widen, StrandBlock& block) {
  if (!HWY_DYNAMIC_DISPATCH(PlaceStrands)(group, job, widen, block.points)) {
    HWY_DYNAMIC_DISPATCH(ProjectStrands)(job, group.points, block.points);
    return block.points;
  }
  clip_pairs(job.view, block.points, block.pairs);
  project_pairs(job.view, block.pairs);
  return block.pairs;
}

}  // namespace pelage
#endif
