#include "lod/pieces.h"

#include "frame/strand_part.h"

namespace pelage {
namespace {

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(const StrandSet& from, StrandSet& to) {
  const auto base = static_cast<std::uint32_t>(to.points.size());
  for (std::size_t s = 1; s < from.offsets.size(); ++s) to.offsets.push_back(base + from.offsets[s]);
  append(from.points, to.points), append(from.widths, to.widths), append(from.colors, to.colors);
  append(from.transparency, to.transparency), append(from.root_uv, to.root_uv), append(from.strand_id, to.strand_id);
  append(from.guide_id, to.guide_id), append(from.group, to.group);
}

void append(const ThickSections& from, ThickSections& to) {
  append(from.major, to.major), append(from.minor, to.minor);
  append(from.fibers, to.fibers), append(from.diameters, to.diameters), append(from.spreads, to.spreads);
  append(from.levels, to.levels);
}

}  // namespace

Vec3 hair_knot(const LodHierarchy& lod, std::size_t hair, std::size_t k) {
  const Vec3* c = &lod.centers[hair * LodHierarchy::kPoints];
  const bool inside = k > 0 && k + 1 < LodHierarchy::kPoints;
  return inside ? (c[k - 1] + c[k] * 4.f + c[k + 1]) / 6.f : c[k];
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
  const std::uint32_t one = lod.order[lod.hairs[h].first_strand];
  to.strand_id.push_back(from.strand_id.empty() ? one : from.strand_id[one]);
}

void append_strand(const StrandSet& set, const StrandPart& part, float widen, StrandSet& pieces) {
  const std::uint32_t begin = first_point(set, part), end = begin + part.spans * points_per_span(set.basis) + 1;
  for (std::uint32_t i = begin; i < end; ++i) {
    pieces.points.push_back(set.points[i]), pieces.widths.push_back(set.width(i) * widen);
    if (set.colors.size() == set.point_count()) pieces.colors.push_back(set.colors[i]);
    if (!set.transparency.empty()) pieces.transparency.push_back(set.transparency[i]);
  }
  append_attributes(set, part.strand, pieces);
  end_strand(pieces);
}

Pieces join(const std::vector<Pieces>& parts) {
  Pieces all;
  all.hairs.offsets = {0};
  for (const Pieces& part : parts) append(part.hairs, all.hairs), append(part.sections, all.sections);
  return all;
}

}  // namespace pelage
