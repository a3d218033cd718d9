#include "lod/draw_levels.h"

#include <algorithm>
#include <memory>

#include "core/parallel.h"
#include "frame/strand_part.h"
#include "lod/fading_strands.h"

namespace pelage {
namespace {

constexpr std::size_t kStrandsPerTask = 4096;

/// Segments of every strand that are drawn as they are: those where its finest hair is split.
std::vector<std::uint16_t> strand_segments(const LodHierarchy& lod, const LodCut& cut) {
  std::vector<std::uint16_t> segments(lod.strand_count());
  for_each_finest_strand(lod, [&](std::size_t hair, std::uint32_t strand) { segments[strand] = cut[hair]; });
  return segments;
}

/// The parts of a strand along these segments.
void append_parts(const StrandSet& set, std::uint32_t strand, std::uint16_t segments, const StrandCuts& cuts,
                  std::vector<StrandPart>& parts) {
  const auto append = [&](const StrandPart& part) {
    if (part.spans > 0) parts.push_back(part);
  };
  if (segments == kAllSegments) return append(whole_strand(set, strand));
  if (segments == 0) return;
  const CutStrand cut = cuts(strand);
  for_each_run(segments, [&](const LodRun& run) { append(cut.part(run.first, run.last)); });
}

/// Those of all strands, in the order of memory.
std::vector<StrandPart> strand_parts(const StrandSet& set, const std::vector<std::uint16_t>& segments, const StrandCuts& cuts) {
  std::vector<std::vector<StrandPart>> tasks((segments.size() + kStrandsPerTask - 1) / kStrandsPerTask);
  parallel_for(segments.size(), kStrandsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      append_parts(set, static_cast<std::uint32_t>(s), segments[s], cuts, tasks[begin / kStrandsPerTask]);
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

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodCut& cut, const StrandCuts& cuts, CurveBasis basis,
                                       const DrawHairs& draw) {
  const LodHierarchy& lod = *groom.lod;
  const std::vector<std::uint16_t> segments = strand_segments(lod, cut);
  if (all_whole(segments)) return {groom};
  std::vector<GroomInstance> drawn;
  add_strands(groom, strand_parts(*groom.strands, segments, cuts), drawn);
  add_hairs(groom, basis, draw([&](std::size_t h) { return shown_segments(lod, cut, h); }), drawn);
  return drawn;
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const BlendedCut& cut, const StrandCuts& cuts,
                                       CurveBasis basis, const DrawHairs& draw) {
  const LodHierarchy& lod = *groom.lod;
  const StrandSegments segments = strand_segments(lod, cut);
  if (all_whole(segments.whole)) return {groom};
  std::vector<GroomInstance> drawn;
  add_strands(groom, strand_parts(*groom.strands, segments.whole, cuts), drawn);
  Pieces fading = fading_strands(*groom.strands, lod, cut, segments, cuts);
  add_pieces(groom, " (fading strands)", fading, drawn);
  add_hairs(groom, basis, draw([&](std::size_t h) { return cut.shown[h]; }), drawn);
  return drawn;
}

}  // namespace pelage
