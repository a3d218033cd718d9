#include "lod/hair_cards.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "frame/camera_view.h"
#include "frame/curve_basis.h"
#include "frame/section.h"
#include "frame/strand_part.h"
#include "lod/draw_levels.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints, kColumns = HairCards::kColumns, kRows = HairCards::kRows;
using Texels = std::array<float, kRows * kColumns>;

/// Where a card is cut across, at a share of its length.
struct CardCut {
  Vec3 center, major;
};

/// Between two control points, `place` segments from the root.
template <class T>
T between(const T* values, float place) {
  const auto k = std::min(static_cast<std::size_t>(place), kLodSegments - 1);
  const float t = place - static_cast<float>(k);
  return values[k] * (1 - t) + values[k + 1] * t;
}

/// The center is the Catmull-Rom curve that thick hairs are drawn by.
CardCut cut_card(const LodHierarchy& lod, std::size_t hair, float place) {
  const auto k = std::min(static_cast<std::size_t>(place), kLodSegments - 1);
  const Vec4 w = basis_weights(CurveBasis::kCatmullRom, place - static_cast<float>(k));
  const Vec3 b = hair_knot(lod, hair, k), c = hair_knot(lod, hair, k + 1);
  const Vec3 a = k > 0 ? hair_knot(lod, hair, k - 1) : b * 2.f - c;
  const Vec3 d = k + 2 < kPoints ? hair_knot(lod, hair, k + 2) : c * 2.f - b;
  return {a * w.x + b * w.y + c * w.z + d * w.w, between(&lod.major[hair * kPoints], place)};
}

float row_place(std::size_t row) { return static_cast<float>(row) / HairCards::kRowsPerSegment; }

/// Places and widths of a strand at the middles of the rows, by shares of the length of its control polygon.
struct StrandRows {
  std::array<Vec3, kRows> places;
  std::array<float, kRows> widths;

  StrandRows(const StrandSet& set, std::size_t strand) {
    const std::size_t begin = set.offsets[strand], end = set.offsets[strand + 1];
    float total = 0;
    for (std::size_t i = begin + 1; i < end; ++i) total += length(set.points[i] - set.points[i - 1]);
    std::size_t i = begin + 1;
    float before = 0, step = length(set.points[i] - set.points[i - 1]);
    for (std::size_t row = 0; row < kRows; ++row) {
      const float at = total * (static_cast<float>(row) + 0.5f) / kRows;
      while (i + 1 < end && before + step < at) before += step, ++i, step = length(set.points[i] - set.points[i - 1]);
      const float t = step > 0 ? std::clamp((at - before) / step, 0.f, 1.f) : 0.f;
      places[row] = lerp(set.points[i - 1], set.points[i], t);
      widths[row] = set.width(i - 1) * (1 - t) + set.width(i) * t;
    }
  }
};

/// Takes from `clear`, the share of every texel of a row that no strand covers, what a band from a to b covers; in texels.
void cover(float a, float b, float* clear) {
  const float most = kColumns;
  for (float c = std::floor(std::clamp(a, 0.f, most - 1)); c < std::min(b, most); ++c)
    clear[static_cast<std::size_t>(c)] *= 1 - std::clamp(std::min(b, c + 1) - std::max(a, c), 0.f, 1.f);
}

/// How many texels of a card are opaque whose strands cover that share of it from its front: never none.
std::size_t opaque_texels(float coverage) {
  constexpr float kTurned = 1.57079633f;  // π/2 over the mean width of a strip in all directions around it
  const auto all = static_cast<float>(kRows * kColumns);
  return static_cast<std::size_t>(std::lround(std::clamp(coverage * kTurned * all, 1.f, all)));
}

/// Draws cards as an eye sees them.
class CardPen {
 public:
  CardPen(const HairCards& cards, const StrandSet& set, const LodPlace& place)
      : cards_(cards), set_(set), lod_(place.lod), eye_(place) {}

  void operator()(std::uint32_t h, std::size_t level, std::uint16_t segments, Pieces& out) const {
    for_each_run(segments, [&](const LodRun& run) { add_run(h, level, run, out); });
  }

 private:
  void add_run(std::uint32_t h, std::size_t level, const LodRun& run, Pieces& out) const {
    const std::size_t first = run.first * HairCards::kRowsPerSegment, last = run.last * HairCards::kRowsPerSegment;
    for (std::size_t column = 0; column < kColumns; ++column)
      for (std::size_t from = first, to; from < last; from = to) {
        const auto opaque = [&](std::size_t row) { return cards_.row(h, row) >> column & 1; };
        for (to = from + 1; to < last && opaque(to) == opaque(from);) ++to;
        if (opaque(from)) add_strip(h, column, from, to, level, out);
      }
  }

  /// Texels of a column, rows `from` to `to` − 1.
  void add_strip(std::uint32_t h, std::size_t column, std::size_t from, std::size_t to, std::size_t level, Pieces& out) const {
    int opaque = 0;
    for (std::size_t row = 0; row < kRows; ++row) opaque += std::popcount(cards_.row(h, row));
    const float fibers = static_cast<float>(lod_.hairs[h].fibers) * kRows / static_cast<float>(opaque),
                across = (2 * static_cast<float>(column) + 1) / kColumns - 1;
    for (std::size_t row = from; row <= to; ++row) {
      const float place = row_place(row);
      const CardCut cut = cut_card(lod_, h, place);
      const Vec3 point = cut.center + cut.major * across, half = cut.major / kColumns;
      const auto k = static_cast<std::size_t>(std::lround(place));
      out.hairs.points.push_back(point);
      out.hairs.widths.push_back(section_extent(half, Vec3(), hair_direction(lod_, h, k), eye_.from(point)).width);
      out.sections.major.push_back(half), out.sections.minor.push_back(between(&lod_.minor[std::size_t{h} * kPoints], place));
      out.sections.fibers.push_back(fibers);
      out.sections.diameters.push_back(2 * between(&lod_.radii[std::size_t{h} * kPoints], place));
      out.sections.spreads.push_back(0);
    }
    out.sections.levels.push_back(static_cast<std::uint8_t>(level));
    append_attributes(lod_, h, set_, out.hairs);
    end_strand(out.hairs);
    out.parts.push_back(whole_strand(out.hairs, out.hairs.strand_count() - 1));
  }

  const HairCards& cards_;
  const StrandSet& set_;
  const LodHierarchy& lod_;
  const LodEye eye_;
};

}  // namespace

HairCards::HairCards(const StrandSet& strands, const LodHierarchy& lod) {
  const std::size_t hairs = lod.level_offsets[std::min(kLevels, lod.levels())];
  rows_.resize(hairs * kRows), coverage_.resize(hairs);
  parallel_for(hairs, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) paint(strands, lod, h);
  });
}

void HairCards::paint(const StrandSet& strands, const LodHierarchy& lod, std::size_t hair) {
  Texels clear;
  clear.fill(1);
  std::array<CardCut, kRows> cuts;
  for (std::size_t row = 0; row < kRows; ++row) cuts[row] = cut_card(lod, hair, row_place(row) + 0.5f / kRowsPerSegment);
  for (std::uint32_t i = 0; i < lod.hairs[hair].fibers; ++i) {
    const StrandRows strand(strands, lod.order[lod.hairs[hair].first_strand + i]);
    for (std::size_t row = 0; row < kRows; ++row) {
      const float size = length(cuts[row].major), texel = 2 * size / kColumns;
      if (!(texel > 0)) continue;
      const float half = std::min(0.5f * strand.widths[row], size),
                  across = dot(strand.places[row] - cuts[row].center, cuts[row].major) / size + size,
                  middle = std::clamp(across, half, 2 * size - half);
      cover((middle - half) / texel, (middle + half) / texel, &clear[row * kColumns]);
    }
  }
  std::array<std::uint16_t, kRows * kColumns> order;
  std::iota(order.begin(), order.end(), std::uint16_t{0});
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return std::pair(clear[a], a) < std::pair(clear[b], b); });
  const float covered = static_cast<float>(order.size()) - std::accumulate(clear.begin(), clear.end(), 0.f);
  coverage_[hair] = covered * lod.length_ratios[hair] / static_cast<float>(order.size());
  const std::size_t opaque = opaque_texels(coverage_[hair]);
  for (std::size_t i = 0; i < opaque; ++i)
    rows_[hair * kRows + order[i] / kColumns] |= static_cast<std::uint8_t>(1u << order[i] % kColumns);
}

LodCut HairCards::choose(const LodPlace& place, const PrismHairs& prisms, float pixels, int level, const LodCut& before) {
  const LodHierarchy& lod = place.lod;
  const std::size_t most = std::min(kLevels, lod.levels());
  if (level >= 0) return one_level(lod, std::min(static_cast<std::size_t>(level), most - 1));
  LodCut cut = choose_levels(place, prisms, pixels * kColumns, before);
  for (std::size_t h = lod.level_offsets[most]; h < cut.size(); ++h) cut[h] = cut[lod.hairs[h].parent];
  return cut;
}

DrawCluster HairCards::pen(const StrandSet& strands, const LodPlace& place) const { return CardPen(*this, strands, place); }

}  // namespace pelage
