#include "lod/strand_cuts.h"

#include <algorithm>
#include <vector>

#include "frame/strand_part.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

/// Of the control polygon, from the root to the end of each span; [0] is 0.
void measure(const StrandSet& set, std::size_t strand, std::vector<float>& length) {
  const std::uint32_t spans = whole_strand(set, strand).spans, stride = points_per_span(set.basis);
  const Vec3* p = &set.points[set.offsets[strand]];
  length.assign(1, 0);
  for (std::uint32_t s = 0; s < spans; ++s) {
    float way = length.back();
    for (std::uint32_t i = s * stride; i < (s + 1) * stride; ++i) way += pelage::length(p[i + 1] - p[i]);
    length.push_back(way);
  }
}

}  // namespace

CutStrand StrandCuts::operator()(std::uint32_t strand) const {
  thread_local std::vector<float> length;
  measure(*strands_, strand, length);
  const auto last = static_cast<std::uint32_t>(length.size()) - 1;
  CutStrand cut{strand, {}};
  std::uint32_t s = 0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const float at = share_at(k) * length[last];
    while (s < last && length[s] + length[s + 1] < 2 * at) ++s;
    cut.spans[k] = s;
  }
  cut.spans[kPoints - 1] = last;
  return cut;
}

float CutStrand::between(const float* at, float from_root) const {
  std::size_t k = 0;
  while (k + 2 < kPoints && static_cast<float>(spans[k + 1]) <= from_root) ++k;
  const auto first = static_cast<float>(spans[k]), last = static_cast<float>(spans[k + 1]);
  const float t = last > first ? std::clamp((from_root - first) / (last - first), 0.f, 1.f) : 1;
  return at[k] + (at[k + 1] - at[k]) * t;
}

}  // namespace pelage
