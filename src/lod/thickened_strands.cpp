#include "lod/thickened_strands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rng.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::uint32_t kOrderSeed = 0x5a1e;

/// Sections of the points of a strand that were appended last: those of a hair.
void append_sections(const LodHierarchy& lod, std::size_t hair, const StrandSet& strands, ThickSections& to) {
  const auto fibers = static_cast<float>(lod.hairs[hair].fibers);
  const std::size_t first = to.fibers.size(), count = strands.points.size() - first;
  for (std::size_t i = 0; i < count; ++i) {
    const auto part = static_cast<float>(i) / static_cast<float>(count - 1);
    const auto k = static_cast<std::size_t>(std::lround(part * static_cast<float>(kPoints - 1)));
    to.major.push_back(lod.major[hair * kPoints + k]), to.minor.push_back(lod.minor[hair * kPoints + k]);
    to.fibers.push_back(fibers), to.diameters.push_back(strands.widths[first + i] / fibers), to.spreads.push_back(0);
  }
}

}  // namespace

ThickenedStrands::ThickenedStrands(const LodHierarchy& lod) {
  const auto key = [](std::uint32_t strand) { return std::pair(pcg4d(strand, kOrderSeed, 0, 0).x, strand); };
  for (const ThickHair& hair : lod.hairs) {
    const auto begin = lod.order.begin() + hair.first_strand;
    strands_.push_back(
        *std::min_element(begin, begin + hair.fibers, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); }));
  }
}

DrawCluster ThickenedStrands::pen(const StrandSet& set, const LodHierarchy& lod, const StrandCuts& cuts) const {
  return [this, &set, &lod, &cuts](std::uint32_t hair, std::size_t level, std::uint16_t segments, Pieces& out) {
    const CutStrand cut = cuts(strand(hair));
    for_each_run(segments, [&](const LodRun& run) {
      StrandPart part = cut.part(run.first, run.last);
      part.strand = static_cast<std::uint32_t>(out.hairs.strand_count());
      if (part.spans > 0) out.parts.push_back(part);
    });
    append_strand(set, strand(hair), static_cast<float>(lod.hairs[hair].fibers), out.hairs);
    append_sections(lod, hair, out.hairs, out.sections);
    out.sections.levels.push_back(static_cast<std::uint8_t>(level));
  };
}

}  // namespace pelage
