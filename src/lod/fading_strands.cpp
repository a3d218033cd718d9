#include "lod/fading_strands.h"

#include "core/parallel.h"
#include "frame/curve_basis.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kStrandsPerTask = 1024;

/// Segments at whose ends a hair leaves everything to its strands.
std::uint16_t passed_whole(const BlendedCut& cut, std::size_t hair) {
  std::uint32_t whole = 0;  // control points
  for (std::size_t k = 0; k < kPoints; ++k) whole |= std::uint32_t{cut.passed[hair * kPoints + k] == 1} << k;
  return static_cast<std::uint16_t>(cut.split[hair] & whole & whole >> 1);
}

/// Appends a strand with the parts that fade, `passed` of it at its hair's control points.
void append_fading(const StrandSet& set, std::uint32_t strand, std::uint16_t fading, const float* passed,
                   const StrandCuts& cuts, Pieces& out) {
  const CutStrand cut = cuts(strand);
  for_each_run(fading, [&](const LodRun& run) {
    StrandPart part = cut.part(run.first, run.last);
    part.strand = static_cast<std::uint32_t>(out.hairs.strand_count());
    if (part.spans > 0) out.parts.push_back(part);
  });
  const std::size_t first = out.hairs.points.size();
  const auto stride = static_cast<float>(points_per_span(set.basis));
  append_strand(set, strand, 1, out.hairs);
  for (std::size_t i = first; i < out.hairs.points.size(); ++i) {
    out.shares.push_back(cut.between(passed, static_cast<float>(i - first) / stride));
    out.hairs.widths[i] *= out.shares.back();
  }
}

}  // namespace

StrandSegments strand_segments(const LodHierarchy& lod, const BlendedCut& cut) {
  StrandSegments segments{std::vector<std::uint16_t>(lod.strand_count()), std::vector<std::uint16_t>(lod.strand_count())};
  for_each_finest_strand(lod, [&](std::size_t hair, std::uint32_t strand) {
    segments.drawn[strand] = cut.split[hair], segments.whole[strand] = passed_whole(cut, hair);
  });
  return segments;
}

Pieces fading_strands(const StrandSet& set, const LodHierarchy& lod, const BlendedCut& cut, const StrandSegments& segments,
                      const StrandCuts& cuts) {
  std::vector<std::uint32_t> hairs(lod.strand_count());
  for_each_finest_strand(lod,
                         [&](std::size_t hair, std::uint32_t strand) { hairs[strand] = static_cast<std::uint32_t>(hair); });
  std::vector<Pieces> tasks((hairs.size() + kStrandsPerTask - 1) / kStrandsPerTask);
  parallel_for(hairs.size(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
    Pieces& out = tasks[begin / kStrandsPerTask];
    out.hairs.offsets = {0};
    std::size_t points = 0;
    for (std::size_t s = begin; s < end; ++s)
      if (segments.drawn[s] != segments.whole[s]) points += set.offsets[s + 1] - set.offsets[s];
    out.hairs.points.reserve(points), out.hairs.widths.reserve(points), out.shares.reserve(points);
    for (std::size_t s = begin; s < end; ++s)
      if (const auto fading = static_cast<std::uint16_t>(segments.drawn[s] & ~segments.whole[s]))
        append_fading(set, static_cast<std::uint32_t>(s), fading, &cut.passed[hairs[s] * kPoints], cuts, out);
  });
  Pieces all = join(tasks);
  all.hairs.basis = set.basis;
  return all;
}

}  // namespace pelage
