#include "light/strand_lines.h"

#include <algorithm>

#include "core/check.h"
#include "core/parallel.h"
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

float scale_of(const Affine& a) { return length(transform_vector(a, {1, 0, 0})); }

}  // namespace

StrandLines::StrandLines(const GroomInstance& groom, int segments_per_span)
    : groom_(&groom), width_scale_(groom.width_scale * scale_of(groom.transform)) {
  PELAGE_CHECK(segments_per_span >= 1 && segments_per_span <= 16);
  const CurveBasis basis = groom.strands->basis;
  const int n = basis == CurveBasis::kLinear ? 1 : segments_per_span;
  for (int k = 1; k <= n; ++k) weights_.push_back(basis_weights(basis, static_cast<float>(k) / static_cast<float>(n)));
}

void StrandLines::append(std::size_t strand, std::vector<Vec3>& points, std::vector<float>& widths) const {
  const StrandSet& set = *groom_->strands;
  const bool bezier = set.basis == CurveBasis::kBezier;
  const std::size_t begin = set.offsets[strand], end = set.offsets[strand + 1];
  if (end - begin < 2) return;
  const auto point = [&](std::size_t i) { return transform_point(groom_->transform, set.points[i]); };
  const std::size_t stride = bezier ? 3 : 1, spans = (end - begin - 1) / stride;
  Vec3 p[4];
  for (std::size_t s = 0; s < spans; ++s) {
    const std::size_t i = begin + s * stride;
    p[1] = point(bezier ? i + 1 : i), p[2] = point(bezier ? i + 2 : i + 1);
    p[0] = bezier ? point(i) : i > begin ? point(i - 1) : p[1] * 2.f - p[2];
    p[3] = bezier ? point(i + 3) : i + 2 < end ? point(i + 2) : p[2] * 2.f - p[1];
    const float from = set.width(i) * width_scale_, to = set.width(i + stride) * width_scale_;
    if (s == 0) {
      const Vec4 w = basis_weights(set.basis, 0);
      points.push_back(kernel::curve_combine(w, p[0], p[1], p[2], p[3])), widths.push_back(from);
    }
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      points.push_back(kernel::curve_combine(weights_[k], p[0], p[1], p[2], p[3]));
      widths.push_back(from + (to - from) * static_cast<float>(k + 1) / static_cast<float>(weights_.size()));
    }
  }
}

float mean_span_length(const GroomInstance& groom) {
  const StrandSet& set = *groom.strands;
  const std::size_t step = set.strand_count() / 1000 + 1;
  double total = 0;
  std::size_t spans = 0;
  for (std::size_t s = 0; s < set.strand_count(); s += step)
    for (std::size_t i = set.offsets[s]; i + 1 < set.offsets[s + 1]; ++i, ++spans)
      total += static_cast<double>(length(set.points[i + 1] - set.points[i]));
  if (spans == 0) return 0;
  const int stride = set.basis == CurveBasis::kBezier ? 3 : 1;
  return static_cast<float>(total / static_cast<double>(spans)) * static_cast<float>(stride) * scale_of(groom.transform);
}

Bounds groom_bounds(const std::vector<GroomInstance>& grooms) {
  constexpr std::size_t kGrain = 1 << 16;
  Bounds all;
  for (const GroomInstance& groom : grooms) {
    const std::vector<Vec3>& points = groom.strands->points;
    std::vector<Bounds> part((points.size() + kGrain - 1) / kGrain);
    parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) part[begin / kGrain].extend(transform_point(groom.transform, points[i]));
    });
    for (const Bounds& b : part) all.extend(b);
  }
  return all;
}

}  // namespace pelage
