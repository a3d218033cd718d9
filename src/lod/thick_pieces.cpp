#include "lod/thick_pieces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kHairsPerTask = 256;

/// How many curves and parts of them.
struct Counts {
  std::size_t hairs = 0, parts = 0;
};

std::size_t run_count(std::uint32_t segments) { return static_cast<std::size_t>(std::popcount(segments & ~(segments << 1))); }

/// What the tasks before each draw, and all together last.
std::vector<Counts> places(std::size_t hairs, const ShownSegments& shown) {
  std::vector<Counts> tasks((hairs + kHairsPerTask - 1) / kHairsPerTask + 1);
  parallel_for(hairs, kHairsPerTask, [&](std::size_t begin, std::size_t end) {
    Counts& count = tasks[begin / kHairsPerTask + 1];
    for (std::size_t h = begin; h < end; ++h)
      if (const std::uint16_t segments = shown(h)) ++count.hairs, count.parts += run_count(segments);
  });
  for (std::size_t t = 1; t < tasks.size(); ++t) tasks[t].hairs += tasks[t - 1].hairs, tasks[t].parts += tasks[t - 1].parts;
  return tasks;
}

std::size_t level_of(const LodHierarchy& lod, std::size_t hair) {
  const auto next = std::upper_bound(lod.level_offsets.begin(), lod.level_offsets.end(), hair);
  return static_cast<std::size_t>(next - lod.level_offsets.begin()) - 1;
}

template <class T>
void make_room(std::vector<T>& values, std::size_t count) {
  reserve(count, values), values.resize(count);
}

/// Writes thick hairs of one groom where they belong.
class Writer {
 public:
  Writer(const StrandSet& set, const LodPlace& place, const BlendedCut* blend, Counts all)
      : set_(set), lod_(place.lod), eye_(place), blend_(blend) {
    resize(all);
  }

  /// Hairs begin … end − 1; `at` is where their first curve and part go.
  void operator()(std::size_t begin, std::size_t end, Counts at, const ShownSegments& shown) {
    for (std::size_t h = begin; h < end; ++h) {
      const std::uint16_t segments = shown(h);
      if (segments == 0) continue;
      for_each_run(segments, [&](const LodRun& run) { all_.parts[at.parts++] = hair_part(at.hairs, run); });
      write(h, segments, at.hairs++);
    }
  }
  Pieces take() { return std::move(all_); }

 private:
  /// The first writes of memory take longest: array by array, in parallel.
  void resize(Counts all) {
    const std::size_t points = all.hairs * kPoints;
    StrandSet& hairs = all_.hairs;
    ThickSections& sections = all_.sections;
    const std::function<void()> arrays[] = {
        [&] { make_room(hairs.points, points); },
        [&] { make_room(sections.major, points); },
        [&] { make_room(sections.minor, points); },
        [&] { make_room(hairs.widths, points); },
        [&] { make_room(sections.fibers, points); },
        [&] { make_room(sections.diameters, points); },
        [&] { make_room(sections.spreads, points); },
        [&] { make_room(sections.twists, lod_.twists.empty() ? 0 : points); },
        [&] { make_room(all_.shares, blend_ ? points : 0); },
        [&] { make_room(all_.parts, all.parts); },
        [&] { make_room(hairs.offsets, all.hairs + 1); },
        [&] { make_room(hairs.strand_id, all.hairs); },
        [&] { make_room(sections.levels, all.hairs); },
        [&] { make_room(hairs.colors, lod_.colors.empty() ? 0 : all.hairs); },
        [&] { make_room(hairs.root_uv, lod_.root_uv.empty() ? 0 : all.hairs); },
    };
    parallel_for(std::size(arrays), 1, [&](std::size_t i, std::size_t) { arrays[i](); });
  }

  void write(std::size_t h, std::uint16_t segments, std::size_t to) {
    const HairWidths bands = hair_widths(lod_, eye_, static_cast<std::uint32_t>(h));
    const float fibers = static_cast<float>(lod_.hairs[h].fibers) * crossing_ratio(lod_.length_ratios[h]),
                spread = direction_variance(lod_.length_ratios[h]);
    const std::uint32_t ends = segments | std::uint32_t{segments} << 1;  // control points of what is drawn
    for (std::size_t k = 0; k < kPoints; ++k) {
      const std::size_t i = h * kPoints + k, j = to * kPoints + k;
      const float fiber = 2 * lod_.radii[i], share = blend_ ? blend_->share(lod_, h, k) : 1;
      all_.hairs.points[j] = hair_knot(lod_, h, k);
      all_.hairs.widths[j] = ends >> k & 1 ? covered_width(bands.metres[k], fiber, share * fibers) : 0;
      all_.sections.major[j] = lod_.major[i], all_.sections.minor[j] = lod_.minor[i];
      all_.sections.fibers[j] = fibers, all_.sections.diameters[j] = fiber, all_.sections.spreads[j] = spread;
      if (!lod_.twists.empty()) all_.sections.twists[j] = lod_.twists[h];
      if (blend_) all_.shares[j] = share;
    }
    write_attributes(h, to);
  }

  void write_attributes(std::size_t h, std::size_t to) {
    all_.sections.levels[to] = static_cast<std::uint8_t>(level_of(lod_, h));
    all_.hairs.offsets[to + 1] = static_cast<std::uint32_t>((to + 1) * kPoints);
    all_.hairs.strand_id[to] = first_strand_id(lod_, h, set_);
    if (!lod_.colors.empty()) all_.hairs.colors[to] = lod_.colors[h];
    if (!lod_.root_uv.empty()) all_.hairs.root_uv[to] = lod_.root_uv[h];
  }

  static StrandPart hair_part(std::size_t hair, const LodRun& run) {
    return {static_cast<std::uint32_t>(hair), static_cast<std::uint32_t>(run.first),
            static_cast<std::uint32_t>(run.last - run.first)};
  }

  const StrandSet& set_;
  const LodHierarchy& lod_;
  const LodEye eye_;
  const BlendedCut* blend_;
  Pieces all_;
};

}  // namespace

Pieces thick_pieces(const StrandSet& strands, const LodPlace& place, const ShownSegments& shown, const BlendedCut* blend) {
  const std::size_t hairs = place.lod.hair_count();
  const std::vector<Counts> tasks = places(hairs, shown);
  Writer writer(strands, place, blend, tasks.back());
  parallel_for(hairs, kHairsPerTask,
               [&](std::size_t begin, std::size_t end) { writer(begin, end, tasks[begin / kHairsPerTask], shown); });
  return writer.take();
}

DrawHairs thick_hair_pen(const StrandSet& strands, const LodPlace& place, const BlendedCut* blend) {
  return [&strands, place, blend](const ShownSegments& shown) { return thick_pieces(strands, place, shown, blend); };
}

}  // namespace pelage
