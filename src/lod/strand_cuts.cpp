#include "lod/strand_cuts.h"

#include <algorithm>

#include "core/parallel.h"
#include "frame/strand_part.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

/// Writes the cuts of a strand; `length` is scratch.
void cut_strand(const StrandSet& set, std::size_t strand, std::vector<float>& length, std::uint32_t* cuts) {
  const std::uint32_t spans = whole_strand(set, strand).spans, stride = points_per_span(set.basis);
  const Vec3* p = &set.points[set.offsets[strand]];
  length.assign(1, 0);
  for (std::uint32_t s = 0; s < spans; ++s) {
    float way = length.back();
    for (std::uint32_t i = s * stride; i < (s + 1) * stride; ++i) way += pelage::length(p[i + 1] - p[i]);
    length.push_back(way);
  }
  std::uint32_t s = 0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const float at = share_at(k) * length.back();
    while (s < spans && length[s] + length[s + 1] < 2 * at) ++s;
    cuts[k] = s;
  }
  cuts[kPoints - 1] = spans;
}

}  // namespace

StrandCuts::StrandCuts(const StrandSet& strands) : cuts_(strands.strand_count() * kPoints) {
  parallel_for(strands.strand_count(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<float> length;
    for (std::size_t s = begin; s < end; ++s) cut_strand(strands, s, length, &cuts_[s * kPoints]);
  });
}

StrandPart StrandCuts::part(std::uint32_t strand, std::size_t first, std::size_t last) const {
  const std::uint32_t* cuts = &cuts_[std::size_t{strand} * kPoints];
  return {strand, cuts[first], cuts[last] - cuts[first]};
}

float StrandCuts::between(std::uint32_t strand, const float* at, float spans) const {
  const std::uint32_t* cuts = &cuts_[std::size_t{strand} * kPoints];
  std::size_t k = 0;
  while (k + 2 < kPoints && static_cast<float>(cuts[k + 1]) <= spans) ++k;
  const auto first = static_cast<float>(cuts[k]), last = static_cast<float>(cuts[k + 1]);
  const float t = last > first ? std::clamp((spans - first) / (last - first), 0.f, 1.f) : 1;
  return at[k] + (at[k + 1] - at[k]) * t;
}

}  // namespace pelage
