#include "lod/draw_levels.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/parallel.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kHairsPerTask = 256;
constexpr std::size_t kStrandsPerTask = 4096;

/// Draws thick hairs of one groom as an eye sees them.
class ThickHairPen {
 public:
  ThickHairPen(const StrandSet& set, const LodPlace& place) : set_(set), lod_(place.lod), eye_(place) {}

  void operator()(std::uint32_t h, std::size_t level, std::uint16_t segments, Pieces& out) const {
    const HairWidths bands = hair_widths(lod_, eye_, h);
    const float fibers = static_cast<float>(lod_.hairs[h].fibers) * crossing_ratio(lod_.length_ratios[h]),
                spread = direction_variance(lod_.length_ratios[h]), twist = lod_.twists.empty() ? 0 : lod_.twists[h];
    ThickSections& sections = out.sections;
    for_each_run(segments, [&](const LodRun& run) { out.parts.push_back(hair_part(out.hairs.strand_count(), run)); });
    const std::uint32_t ends = segments | std::uint32_t{segments} << 1;  // control points of what is drawn
    for (std::size_t k = 0; k < kPoints; ++k) {
      const std::size_t i = std::size_t{h} * kPoints + k;
      const float fiber = 2 * lod_.radii[i];
      out.hairs.points.push_back(hair_knot(lod_, h, k));
      out.hairs.widths.push_back(ends >> k & 1 ? covered_width(bands.metres[k], fiber, fibers) : 0);
      sections.major.push_back(lod_.major[i]), sections.minor.push_back(lod_.minor[i]);
      sections.fibers.push_back(fibers), sections.diameters.push_back(fiber), sections.spreads.push_back(spread);
      sections.twists.push_back(twist);
    }
    sections.levels.push_back(static_cast<std::uint8_t>(level));
    append_attributes(lod_, h, set_, out.hairs);
    end_strand(out.hairs);
  }

 private:
  static StrandPart hair_part(std::size_t hair, const LodRun& run) {
    return {static_cast<std::uint32_t>(hair), static_cast<std::uint32_t>(run.first),
            static_cast<std::uint32_t>(run.last - run.first)};
  }

  const StrandSet& set_;
  const LodHierarchy& lod_;
  const LodEye eye_;
};

/// What stands for the hairs that `cut` shows, level by level.
Pieces make_pieces(const LodHierarchy& lod, const LodCut& cut, const DrawCluster& draw) {
  std::vector<Pieces> parts;
  for (std::size_t level = 0; level < lod.levels(); ++level) {
    const std::size_t first = lod.level_offsets[level], count = lod.level(level).size(), before = parts.size();
    parts.resize(before + (count + kHairsPerTask - 1) / kHairsPerTask);
    parallel_for(count, kHairsPerTask, [&](std::size_t begin, std::size_t end) {
      Pieces& part = parts[before + begin / kHairsPerTask];
      part.hairs.offsets = {0};
      std::size_t shown_hairs = 0;
      for (std::size_t h = first + begin; h < first + end; ++h) shown_hairs += shown_segments(lod, cut, h) != 0;
      reserve(shown_hairs * kPoints, shown_hairs, part);
      for (std::size_t h = first + begin; h < first + end; ++h)
        if (const std::uint16_t shown = shown_segments(lod, cut, h)) draw(static_cast<std::uint32_t>(h), level, shown, part);
    });
  }
  return join(parts);
}

/// Segments of every strand that are drawn as they are: those where its finest hair is split.
std::vector<std::uint16_t> strand_segments(const LodHierarchy& lod, const LodCut& cut) {
  std::vector<std::uint16_t> segments(lod.strand_count());
  const std::size_t first = lod.level_offsets[lod.levels() - 1];
  parallel_for(lod.hair_count() - first, kHairsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = first + begin; h < first + end; ++h)
      for (std::uint32_t i = 0; i < lod.hairs[h].fibers; ++i) segments[lod.order[lod.hairs[h].first_strand + i]] = cut[h];
  });
  return segments;
}

/// The parts of strands along their segments, in the order of memory.
std::vector<StrandPart> strand_parts(const std::vector<std::uint16_t>& segments, const StrandCuts& cuts) {
  std::vector<std::vector<StrandPart>> tasks((segments.size() + kStrandsPerTask - 1) / kStrandsPerTask);
  parallel_for(segments.size(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for_each_run(segments[s], [&](const LodRun& run) {
        const StrandPart part = cuts.part(static_cast<std::uint32_t>(s), run.first, run.last);
        if (part.spans > 0) tasks[begin / kStrandsPerTask].push_back(part);
      });
  });
  std::vector<StrandPart> all;
  for (const std::vector<StrandPart>& parts : tasks) all.insert(all.end(), parts.begin(), parts.end());
  return all;
}

}  // namespace

DrawCluster thick_hair_pen(const StrandSet& strands, const LodPlace& place) { return ThickHairPen(strands, place); }

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodCut& cut, const StrandCuts& cuts, CurveBasis basis,
                                       const DrawCluster& draw) {
  const LodHierarchy& lod = *groom.lod;
  const std::vector<std::uint16_t> segments = strand_segments(lod, cut);
  if (std::all_of(segments.begin(), segments.end(), [](std::uint16_t s) { return s == kAllSegments; })) return {groom};
  std::vector<GroomInstance> drawn;
  std::vector<StrandPart> parts = strand_parts(segments, cuts);
  if (!parts.empty()) {
    drawn.push_back(groom);
    drawn.back().only = std::make_shared<const std::vector<StrandPart>>(std::move(parts));
  }
  Pieces pieces = make_pieces(lod, cut, draw);
  if (pieces.hairs.points.empty()) return drawn;
  pieces.hairs.basis = basis;
  GroomInstance& hairs = drawn.emplace_back(groom);
  hairs.name += " (thick hairs)";
  hairs.strands = std::make_shared<const StrandSet>(std::move(pieces.hairs));
  hairs.sections = std::make_shared<const ThickSections>(std::move(pieces.sections));
  hairs.only = std::make_shared<const std::vector<StrandPart>>(std::move(pieces.parts));
  return drawn;
}

}  // namespace pelage
