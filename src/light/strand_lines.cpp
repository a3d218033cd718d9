#include "light/strand_lines.h"

#include <pelage/lod.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/draw_order.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

/// Of control points, in world space; of widths as they are stored.
struct Extent {
  Bounds box;
  float widest = 0;
  void extend(const Extent& e) { box.extend(e.box), widest = std::max(widest, e.widest); }
};

/// The widest that control points first … last may look: thick hairs are as wide as the eye sees them, and lights know no eye.
float widest_seen(const GroomInstance& groom, std::size_t first, std::size_t last) {
  const ThickSections* thick = groom.sections.get();
  float widest = 0, axis2 = 0;
  if (!thick)
    for (std::size_t i = first; i <= last; ++i) widest = std::max(widest, groom.strands->width(i));
  else
    for (std::size_t i = first; i <= last; ++i)
      axis2 = std::max({axis2, dot(thick->major[i], thick->major[i]), dot(thick->minor[i], thick->minor[i])});
  return thick ? 2 * std::sqrt(axis2) : widest;
}

Extent part_extent(const GroomInstance& groom, const StrandPart& part) {
  const StrandSet& set = *groom.strands;
  Extent e;
  if (part.spans == 0) return e;
  const std::size_t first = first_point(set, part), last = first + std::size_t{part.spans} * points_per_span(set.basis);
  for (std::size_t i = first; i <= last; ++i) {
    const Vec3 p = transform_point(groom.transform, set.points[i]);
    e.box.lower = {std::min(e.box.lower.x, p.x), std::min(e.box.lower.y, p.y), std::min(e.box.lower.z, p.z)};
    e.box.upper = {std::max(e.box.upper.x, p.x), std::max(e.box.upper.y, p.y), std::max(e.box.upper.z, p.z)};
  }
  e.widest = widest_seen(groom, first, last);
  return e;
}

Extent drawn_extent(const GroomInstance& groom) {
  constexpr std::size_t kGrain = 1 << 10;
  std::vector<Extent> extents((drawn_parts(groom) + kGrain - 1) / kGrain);
  parallel_for(drawn_parts(groom), kGrain, [&](std::size_t begin, std::size_t end) {
    Extent e;
    for (std::size_t s = begin; s < end; ++s) e.extend(part_extent(groom, drawn_part(groom, s)));
    extents[begin / kGrain] = e;
  });
  Extent all;
  for (const Extent& e : extents) all.extend(e);
  return all;
}

float mean_span_length(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  const std::size_t step = set.strand_count() / 1000 + 1;
  double total = 0;
  std::size_t pieces = 0;
  for (std::size_t s = 0; s < set.strand_count(); s += step)
    for (std::size_t i = set.offsets[s]; i + 1 < set.offsets[s + 1]; ++i, ++pieces)
      total += static_cast<double>(length(set.points[i + 1] - set.points[i]));
  if (pieces == 0) return 0;
  return static_cast<float>(total / static_cast<double>(pieces)) * static_cast<float>(points_per_span(set.basis)) *
         similarity_scale(groom.transform);
}

void reserve(LineBlock& block, std::size_t points) {
  for (Buffer<float>* b : {&block.x, &block.y, &block.z, &block.width, &block.density}) b->resize(points + LineBlock::kPadding);
}

/// One number of [begin, begin + stride), below `count`. Which one is random: grooms have patterns in their order.
std::size_t pick_one(std::size_t begin, std::size_t stride, std::size_t count) {
  constexpr std::uint64_t kSeed = 0x6f706163;
  const std::size_t choices = std::min(stride, count - begin);
  const float u = Rng(kSeed, static_cast<std::uint32_t>(begin)).uniform();
  return begin + std::min(static_cast<std::size_t>(u * static_cast<float>(choices)), choices - 1);
}

}  // namespace

StrandLines::StrandLines(const GroomInstance& groom)
    : groom_(&groom), width_scale_(groom.width_scale * similarity_scale(groom.transform)), mean_span_(mean_span_length(groom)) {
  if (const ThickSections* thick = groom.sections.get()) {
    bands_.resize(thick->major.size());
    parallel_for(bands_.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const float wide = std::max(mean_width(length(thick->major[i]), length(thick->minor[i])), 1e-9f);
        const float fibers = thick->fibers[i] * (groom.shares ? (*groom.shares)[i] : 1);
        bands_[i] = {wide, thick->diameters[i] * fibers / wide};
      }
    });
  }
  const Extent extent = drawn_extent(groom);
  bounds_ = extent.box;
  if (bounds_.empty()) return;
  constexpr float kOvershoot = 0.125f;  // negative weights of Catmull-Rom curves sum to that at most
  widest_band_ = width_scale_ * extent.widest;
  const float half = 0.5f * widest_band_;
  const Vec3 beyond = bounds_.extent() * kOvershoot + Vec3(half, half, half);
  reach_ = {bounds_.lower - beyond, bounds_.upper + beyond};
}

void StrandLines::append(const StrandPart& part, const std::vector<Vec4>& weights, LineBlock& block) const {
  const StrandSet& set = *groom_->strands;
  const bool bezier = set.basis == CurveBasis::kBezier;
  const std::size_t begin = set.offsets[part.strand], end = set.offsets[part.strand + 1], stride = points_per_span(set.basis);
  if (part.spans == 0) return;
  const auto point = [&](std::size_t i) { return transform_point(groom_->transform, set.points[i]); };
  const auto put = [&](Vec3 p, Band from, Band to, float t) {
    const std::size_t j = block.count++;
    const float width = from.width + (to.width - from.width) * t;
    block.x[j] = p.x, block.y[j] = p.y, block.z[j] = p.z, block.width[j] = width * width_scale_;
    block.density[j] = from.density + (to.density - from.density) * t;
  };
  const std::size_t first = part.first_span, last = first + part.spans;
  Vec3 p[4];
  for (std::size_t s = first; s < last; ++s) {
    const std::size_t i = begin + s * stride;
    const Band from = band(i), to = band(i + stride);
    if (weights.size() == 1 && !bezier && set.basis != CurveBasis::kBSpline) {  // through the control points
      put(point(i), from, to, 0.5f);
      continue;
    }
    p[1] = point(bezier ? i + 1 : i), p[2] = point(bezier ? i + 2 : i + 1);
    p[0] = bezier ? point(i) : i > begin ? point(i - 1) : p[1] * 2.f - p[2];
    p[3] = bezier ? point(i + 3) : i + 2 < end ? point(i + 2) : p[2] * 2.f - p[1];
    const float n = static_cast<float>(weights.size());
    for (std::size_t k = 0; k < weights.size(); ++k)
      put(kernel::curve_combine(weights[k], p[0], p[1], p[2], p[3]), from, to, (static_cast<float>(k) + 0.5f) / n);
  }
  if (set.basis == CurveBasis::kBSpline && begin + last + 1 < end)
    put(kernel::curve_combine(basis_weights(set.basis, 1), p[0], p[1], p[2], p[3]), {}, {}, 0);
  else  // phantom points make every basis end at its last control point
    put(point(begin + last * stride), {}, {}, 0);
}

std::vector<StrandPart> StrandLines::pick(std::size_t stride, const CameraView& view) const {
  PELAGE_CHECK(stride >= 1);
  std::vector<std::uint32_t> order;
  if (stride == 1) order = draw_order(*groom_, view);
  std::vector<StrandPart> picked((part_count() + stride - 1) / stride);
  for (std::size_t i = 0; i < picked.size(); ++i) {
    const std::size_t k = stride == 1 ? i : pick_one(i * stride, stride, part_count());
    picked[i] = drawn_part(*groom_, order.empty() ? k : order[k]);
  }
  return picked;
}

std::size_t StrandLines::fill(const std::vector<StrandPart>& picked, std::size_t first, std::size_t last, int segments_per_span,
                              LineBlock& block) const {
  PELAGE_CHECK(segments_per_span >= 1 && segments_per_span <= kMaxSegments);
  const StrandSet& set = *groom_->strands;
  const int n = set.basis == CurveBasis::kLinear ? 1 : segments_per_span;
  std::vector<Vec4> weights;  // of the control points, at 0, 1/n, … (n − 1)/n
  for (int k = 0; k < n; ++k) weights.push_back(basis_weights(set.basis, static_cast<float>(k) / static_cast<float>(n)));
  std::size_t points = 0, s = first;
  for (; s < last && (s == first || points < LineBlock::kPoints); ++s)
    points += picked[s].spans * static_cast<std::size_t>(n) + 1;
  reserve(block, points);
  block.count = 0;
  for (std::size_t i = first; i < s; ++i) append(picked[i], weights, block);
  for (std::size_t j = block.count; j < block.count + LineBlock::kPadding; ++j)
    block.x[j] = block.y[j] = block.z[j] = block.width[j] = block.density[j] = 0;
  return s;
}

std::vector<StrandLines> strand_lines(const std::vector<GroomInstance>& grooms) {
  std::vector<StrandLines> lines;
  for (const GroomInstance& groom : grooms) lines.emplace_back(groom);
  return lines;
}

Bounds bounds(const std::vector<StrandLines>& grooms) {
  Bounds all;
  for (const StrandLines& g : grooms) all.extend(g.bounds());
  return all;
}

}  // namespace pelage
