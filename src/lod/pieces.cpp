#include "lod/pieces.h"

#include <iterator>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kHairsPerTask = 256;

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

Pieces draw_clusters(const LodHierarchy& lod, const ShownSegments& shown, const DrawCluster& draw) {
  std::vector<Pieces> parts;
  for (std::size_t level = 0; level < lod.levels(); ++level) {
    const std::size_t first = lod.level_offsets[level], count = lod.level(level).size(), before = parts.size();
    parts.resize(before + (count + kHairsPerTask - 1) / kHairsPerTask);
    parallel_for(count, kHairsPerTask, [&](std::size_t begin, std::size_t end) {
      Pieces& part = parts[before + begin / kHairsPerTask];
      part.hairs.offsets = {0};
      for (std::size_t h = first + begin; h < first + end; ++h)
        if (const std::uint16_t segments = shown(h)) draw(static_cast<std::uint32_t>(h), level, segments, part);
    });
  }
  return join(parts);
}

}  // namespace

DrawHairs cluster_by_cluster(const LodHierarchy& lod, DrawCluster draw) {
  return [&lod, draw = std::move(draw)](const ShownSegments& shown) { return draw_clusters(lod, shown, draw); };
}

Vec3 hair_knot(const LodHierarchy& lod, std::size_t hair, std::size_t k) {
  const Vec3* c = &lod.centers[hair * LodHierarchy::kPoints];
  const bool inside = k > 0 && k + 1 < LodHierarchy::kPoints;
  return inside ? (c[k - 1] + c[k] * 4.f + c[k + 1]) / 6.f : c[k];
}

void for_each_finest_strand(const LodHierarchy& lod, const std::function<void(std::size_t, std::uint32_t)>& body) {
  const std::size_t first = lod.level_offsets[lod.levels() - 1];
  parallel_for(lod.hair_count() - first, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = first + begin; h < first + end; ++h)
      for (std::uint32_t i = 0; i < lod.hairs[h].fibers; ++i) body(h, lod.order[lod.hairs[h].first_strand + i]);
  });
}

void end_strand(StrandSet& set) { set.offsets.push_back(static_cast<std::uint32_t>(set.points.size())); }

void append_attributes(const StrandSet& from, std::size_t s, StrandSet& to) {
  if (from.colors.size() == from.strand_count()) to.colors.push_back(from.colors[s]);
  if (!from.root_uv.empty()) to.root_uv.push_back(from.root_uv[s]);
  to.strand_id.push_back(from.strand_id.empty() ? static_cast<std::uint32_t>(s) : from.strand_id[s]);
  if (!from.guide_id.empty()) to.guide_id.push_back(from.guide_id[s]);
  if (!from.group.empty()) to.group.push_back(from.group[s]);
}

void append_attributes(const LodHierarchy& lod, std::size_t h, const StrandSet& from, StrandSet& to) {
  if (!lod.colors.empty()) to.colors.push_back(lod.colors[h]);
  if (!lod.root_uv.empty()) to.root_uv.push_back(lod.root_uv[h]);
  to.strand_id.push_back(first_strand_id(lod, h, from));
}

std::uint32_t first_strand_id(const LodHierarchy& lod, std::size_t h, const StrandSet& from) {
  const std::uint32_t one = lod.order[lod.hairs[h].first_strand];
  return from.strand_id.empty() ? one : from.strand_id[one];
}

void append_strand(const StrandSet& set, std::uint32_t strand, float widen, StrandSet& pieces) {
  for (std::uint32_t i = set.offsets[strand]; i < set.offsets[strand + 1]; ++i) {
    pieces.points.push_back(set.points[i]), pieces.widths.push_back(set.width(i) * widen);
    if (set.colors.size() == set.point_count()) pieces.colors.push_back(set.colors[i]);
    if (!set.transparency.empty()) pieces.transparency.push_back(set.transparency[i]);
  }
  append_attributes(set, strand, pieces);
  end_strand(pieces);
}

void reserve(std::size_t points, std::size_t curves, Pieces& pieces) {
  StrandSet& hairs = pieces.hairs;
  ThickSections& sections = pieces.sections;
  for (std::vector<Vec3>* v : {&hairs.points, &sections.major, &sections.minor}) reserve(points, *v);
  for (std::vector<float>* v : {&hairs.widths, &sections.fibers, &sections.diameters, &sections.spreads, &sections.twists})
    reserve(points, *v);
  hairs.offsets.reserve(curves + 1), hairs.strand_id.reserve(curves), sections.levels.reserve(curves);
}

Pieces join(const std::vector<Pieces>& parts) {
  Pieces all;
  std::size_t points = 0, curves = 0, shares = 0;
  for (const Pieces& part : parts)
    points += part.hairs.points.size(), curves += part.sections.levels.size(), shares += part.shares.size();
  reserve(points, curves, all), all.shares.reserve(shares);
  StrandSet& hairs = all.hairs;
  ThickSections& sections = all.sections;
  hairs.offsets = {0};
  for (const Pieces& part : parts) {
    const auto base = hairs.offsets.back(), curves_before = static_cast<std::uint32_t>(hairs.strand_count());
    for (std::size_t s = 1; s < part.hairs.offsets.size(); ++s) hairs.offsets.push_back(base + part.hairs.offsets[s]);
    for (const StrandPart& p : part.parts) all.parts.push_back({curves_before + p.strand, p.first_span, p.spans});
  }
  const auto gather = [&](auto& to, const auto& of) {
    for (const Pieces& part : parts) append(of(part), to);
  };
  const auto strands = [&](auto member) {
    gather(
        hairs.*member, [&](const Pieces& p) -> auto& { return p.hairs.*member; });
  };
  const auto places = [&](auto member) {
    gather(
        sections.*member, [&](const Pieces& p) -> auto& { return p.sections.*member; });
  };
  const std::function<void()> arrays[] = {[&] { strands(&StrandSet::points); },
                                          [&] { places(&ThickSections::major); },
                                          [&] { places(&ThickSections::minor); },
                                          [&] { strands(&StrandSet::widths); },
                                          [&] { places(&ThickSections::fibers); },
                                          [&] { places(&ThickSections::diameters); },
                                          [&] { places(&ThickSections::spreads); },
                                          [&] { places(&ThickSections::twists); },
                                          [&] { places(&ThickSections::levels); },
                                          [&] { strands(&StrandSet::colors); },
                                          [&] { strands(&StrandSet::transparency); },
                                          [&] { strands(&StrandSet::root_uv); },
                                          [&] { strands(&StrandSet::strand_id); },
                                          [&] { strands(&StrandSet::guide_id); },
                                          [&] { strands(&StrandSet::group); },
                                          [&] {
                                            gather(
                                                all.shares, [](const Pieces& p) -> auto& { return p.shares; });
                                          }};
  parallel_for(std::size(arrays), 1, [&](std::size_t i, std::size_t) { arrays[i](); });
  return all;
}

}  // namespace pelage
