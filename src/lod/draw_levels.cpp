#include "lod/draw_levels.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/parallel.h"
#include "kernel/scalar.h"
#include "lod/fading_strands.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kHairsPerTask = 256;
constexpr std::size_t kStrandsPerTask = 4096;

/// Draws thick hairs of one groom as an eye sees them.
class ThickHairPen {
 public:
  ThickHairPen(const StrandSet& set, const LodPlace& place, const BlendedCut* blend)
      : set_(set), lod_(place.lod), eye_(place), blend_(blend) {}

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
      const float share = blend_ ? blend_->share(lod_, h, k) : 1;
      if (blend_) out.shares.push_back(share);
      out.hairs.widths.push_back(ends >> k & 1 ? covered_width(bands.metres[k], fiber, share * fibers) : 0);
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
  const BlendedCut* blend_;
};

/// What stands for the hairs of which `shown(hair)` is some segments, level by level.
template <class Shown>
Pieces make_pieces(const LodHierarchy& lod, const Shown& shown, const DrawCluster& draw) {
  std::vector<Pieces> parts;
  for (std::size_t level = 0; level < lod.levels(); ++level) {
    const std::size_t first = lod.level_offsets[level], count = lod.level(level).size(), before = parts.size();
    parts.resize(before + (count + kHairsPerTask - 1) / kHairsPerTask);
    parallel_for(count, kHairsPerTask, [&](std::size_t begin, std::size_t end) {
      Pieces& part = parts[before + begin / kHairsPerTask];
      part.hairs.offsets = {0};
      std::size_t shown_hairs = 0;
      for (std::size_t h = first + begin; h < first + end; ++h) shown_hairs += shown(h) != 0;
      reserve(shown_hairs * kPoints, shown_hairs, part);
      for (std::size_t h = first + begin; h < first + end; ++h)
        if (const std::uint16_t segments = shown(h)) draw(static_cast<std::uint32_t>(h), level, segments, part);
    });
  }
  return join(parts);
}

/// Segments of every strand that are drawn as they are: those where its finest hair is split.
std::vector<std::uint16_t> strand_segments(const LodHierarchy& lod, const LodCut& cut) {
  std::vector<std::uint16_t> segments(lod.strand_count());
  for_each_finest_strand(lod, [&](std::size_t hair, std::uint32_t strand) { segments[strand] = cut[hair]; });
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

/// Whether these segments are all that there is of the strands.
bool all_whole(const std::vector<std::uint16_t>& segments) {
  return std::all_of(segments.begin(), segments.end(), [](std::uint16_t s) { return s == kAllSegments; });
}

/// Adds strands of `groom` as they are.
void add_strands(const GroomInstance& groom, std::vector<StrandPart> parts, std::vector<GroomInstance>& drawn) {
  if (parts.empty()) return;
  drawn.push_back(groom);
  drawn.back().only = std::make_shared<const std::vector<StrandPart>>(std::move(parts));
}

/// Adds what was made of `groom`, and returns where it is; null where it is nothing.
GroomInstance* add_pieces(const GroomInstance& groom, const char* what, Pieces& pieces, std::vector<GroomInstance>& drawn) {
  if (pieces.parts.empty()) return nullptr;
  GroomInstance& made = drawn.emplace_back(groom);
  made.name += what;
  made.strands = std::make_shared<const StrandSet>(std::move(pieces.hairs));
  made.only = std::make_shared<const std::vector<StrandPart>>(std::move(pieces.parts));
  if (!pieces.shares.empty()) made.shares = std::make_shared<const std::vector<float>>(std::move(pieces.shares));
  return &made;
}

/// Adds thick hairs of `groom`, or what stands for them.
void add_hairs(const GroomInstance& groom, CurveBasis basis, Pieces pieces, std::vector<GroomInstance>& drawn) {
  pieces.hairs.basis = basis;
  if (GroomInstance* hairs = add_pieces(groom, " (thick hairs)", pieces, drawn))
    hairs->sections = std::make_shared<const ThickSections>(std::move(pieces.sections));
}

}  // namespace

DrawCluster thick_hair_pen(const StrandSet& strands, const LodPlace& place, const BlendedCut* blend) {
  return ThickHairPen(strands, place, blend);
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodCut& cut, const StrandCuts& cuts, CurveBasis basis,
                                       const DrawCluster& draw) {
  const LodHierarchy& lod = *groom.lod;
  const std::vector<std::uint16_t> segments = strand_segments(lod, cut);
  if (all_whole(segments)) return {groom};
  std::vector<GroomInstance> drawn;
  add_strands(groom, strand_parts(segments, cuts), drawn);
  add_hairs(groom, basis,
            make_pieces(
                lod, [&](std::size_t h) { return shown_segments(lod, cut, h); }, draw),
            drawn);
  return drawn;
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const BlendedCut& cut, const StrandCuts& cuts,
                                       CurveBasis basis, const DrawCluster& draw) {
  const LodHierarchy& lod = *groom.lod;
  const StrandSegments segments = strand_segments(lod, cut);
  if (all_whole(segments.whole)) return {groom};
  std::vector<GroomInstance> drawn;
  add_strands(groom, strand_parts(segments.whole, cuts), drawn);
  Pieces fading = fading_strands(*groom.strands, lod, cut, segments, cuts);
  add_pieces(groom, " (fading strands)", fading, drawn);
  add_hairs(groom, basis,
            make_pieces(
                lod, [&](std::size_t h) { return cut.shown[h]; }, draw),
            drawn);
  return drawn;
}

}  // namespace pelage
