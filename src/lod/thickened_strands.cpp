#include "lod/thickened_strands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rng.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::uint32_t kOrderSeed = 0x5a1e;

/// Sections of the points of a strand that were appended last: those of the prism's hair of level 0, whose index is `prism`, `shrink` times as wide.
void append_sections(const LodHierarchy& lod, std::size_t prism, const LodRun& run, float fibers, float shrink,
                     const Pieces& from, ThickSections& to) {
  const std::size_t first = to.fibers.size(), count = from.hairs.points.size() - first;
  for (std::size_t i = 0; i < count; ++i) {
    const auto part = static_cast<float>(i) / static_cast<float>(count - 1);
    const auto k = run.first + static_cast<std::size_t>(std::lround(part * static_cast<float>(run.last - run.first)));
    to.major.push_back(lod.major[prism * kPoints + k] * shrink), to.minor.push_back(lod.minor[prism * kPoints + k] * shrink);
    to.fibers.push_back(fibers), to.diameters.push_back(from.hairs.widths[first + i] / fibers), to.spreads.push_back(0);
  }
}

}  // namespace

ThickenedStrands::ThickenedStrands(const LodHierarchy& lod) : shuffled_(lod.order) {
  const auto key = [](std::uint32_t strand) { return std::pair(pcg4d(strand, kOrderSeed, 0, 0).x, strand); };
  for (const ThickHair& prism : lod.level(0)) {
    const auto begin = shuffled_.begin() + prism.first_strand;
    std::sort(begin, begin + prism.fibers, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  }
}

DrawClusters ThickenedStrands::pen(const StrandSet& set, const LodHierarchy& lod, const LevelBounds& bounds) const {
  return [this, &set, &lod, &bounds](std::size_t prism, const LodRun& run, Pieces& out) {
    const LevelBounds::Range hairs = bounds.hairs(run.level, prism);
    const std::uint32_t kept = hairs.last - hairs.first, all = lod.hairs[prism].fibers;
    const float fibers = static_cast<float>(all) / static_cast<float>(kept);
    for (std::uint32_t i = 0; i < kept; ++i) {
      append_strand(set, strands(lod, prism)[i], share_at(run.first), share_at(run.last), fibers, out.hairs);
      append_sections(lod, prism, run, fibers, 1 / std::sqrt(static_cast<float>(kept)), out, out.sections);
      out.sections.levels.push_back(static_cast<std::uint8_t>(run.level));
    }
  };
}

}  // namespace pelage
