#include "lod/draw_levels.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/parallel.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kPrismsPerTask = 32;

/// Segments first … last − 1 of the hairs of a prism, all of one level.
struct Run {
  std::size_t first, last, level;
};

/// What some prisms are drawn as.
struct Pieces {
  std::vector<std::uint32_t> whole;  // strands
  StrandSet strands, hairs;
  ThickSections sections;  // of `hairs`
};

void end_strand(StrandSet& set) { set.offsets.push_back(static_cast<std::uint32_t>(set.points.size())); }

/// Strand s of `from` without its points, appended to `to`.
void copy_attributes(const StrandSet& from, std::size_t s, StrandSet& to) {
  if (from.colors.size() == from.strand_count()) to.colors.push_back(from.colors[s]);
  if (!from.root_uv.empty()) to.root_uv.push_back(from.root_uv[s]);
  to.strand_id.push_back(from.strand_id.empty() ? static_cast<std::uint32_t>(s) : from.strand_id[s]);
  if (!from.guide_id.empty()) to.guide_id.push_back(from.guide_id[s]);
  if (!from.group.empty()) to.group.push_back(from.group[s]);
}

/// The part of a strand at shares `from` to `to` of the length of its control polygon, and what it takes to whole spans.
void append_strand(const StrandSet& set, std::size_t strand, float from, float to, StrandSet& pieces) {
  const std::size_t begin = set.offsets[strand], end = set.offsets[strand + 1], count = end - begin;
  const std::size_t stride = set.basis == CurveBasis::kBezier ? 3 : 1;
  std::vector<float> length(count);
  for (std::size_t i = 1; i < count; ++i)
    length[i] = length[i - 1] + pelage::length(set.points[begin + i] - set.points[begin + i - 1]);
  std::size_t first = 0, last = count - 1;
  while (first + stride < last && length[first + stride] <= from * length.back()) first += stride;
  while (last >= first + 2 * stride && length[last - stride] >= to * length.back()) last -= stride;
  for (std::size_t i = begin + first; i <= begin + last; ++i) {
    pieces.points.push_back(set.points[i]), pieces.widths.push_back(set.width(i));
    if (set.colors.size() == set.point_count()) pieces.colors.push_back(set.colors[i]);
    if (!set.transparency.empty()) pieces.transparency.push_back(set.transparency[i]);
  }
  copy_attributes(set, strand, pieces);
  end_strand(pieces);
}

/// Draws prisms of one groom into Pieces.
class PieceMaker {
 public:
  PieceMaker(const GroomInstance& groom, const LodPlace& place, const LevelBounds& bounds, const LodLevels& levels)
      : set_(*groom.strands), place_(place), bounds_(bounds), levels_(levels) {
    const Affine& to_camera = place.to_camera;
    const float scale = similarity_scale(to_camera);
    for (int i = 0; i < 3; ++i) {  // columns of the inverse's rotation are the rows of this one
      Vec3& axis = i == 0 ? x_ : i == 1 ? y_ : z_;
      axis = Vec3(to_camera.m[i][0], to_camera.m[i][1], to_camera.m[i][2]) / scale;
    }
  }

  void add(std::size_t prism, Pieces& out) const {
    const std::uint8_t* level = &levels_[prism * kLodSegments];
    for (std::size_t first = 0, last; first < kLodSegments; first = last) {
      for (last = first + 1; last < kLodSegments && level[last] == level[first];) ++last;
      add(prism, {first, last, level[first]}, out);
    }
  }

 private:
  void add(std::size_t prism, const Run& run, Pieces& out) const {
    const LodHierarchy& lod = place_.lod;
    if (run.level < lod.levels()) {
      const LevelBounds::Range hairs = bounds_.hairs(run.level, prism);
      for (std::uint32_t h = hairs.first; h < hairs.last; ++h) add_hair(h, run, out);
      return;
    }
    const ThickHair& all = lod.hairs[prism];
    const auto* strands = &lod.order[all.first_strand];
    if (run.first == 0 && run.last == kLodSegments)
      return (void)out.whole.insert(out.whole.end(), strands, strands + all.fibers);
    const auto share = [](std::size_t k) { return static_cast<float>(k) / static_cast<float>(kLodSegments); };
    for (std::uint32_t i = 0; i < all.fibers; ++i)
      append_strand(set_, strands[i], share(run.first), share(run.last), out.strands);
  }

  void add_hair(std::uint32_t h, const Run& run, Pieces& out) const {
    const LodHierarchy& lod = place_.lod;
    const ThickHair& hair = lod.hairs[h];
    const float fibers = static_cast<float>(hair.fibers) * crossing_ratio(lod.length_ratios[h]);
    const Vec3* c = &lod.centers[std::size_t{h} * kPoints];
    for (std::size_t k = run.first; k <= run.last; ++k) {
      const std::size_t i = std::size_t{h} * kPoints + k;
      const bool inside = k > 0 && k + 1 < kPoints;
      const Vec3 knot = inside ? (c[k - 1] + c[k] * 4.f + c[k + 1]) / 6.f : c[k];
      const float band = section_extent(lod.major[i], lod.minor[i], hair_direction(lod, h, k), to_eye(knot)).width,
                  fiber = 2 * lod.radii[i];
      out.hairs.points.push_back(knot), out.hairs.widths.push_back(covered_width(band, fiber, fibers));
      ThickSections& sections = out.sections;
      sections.major.push_back(lod.major[i]), sections.minor.push_back(lod.minor[i]);
      sections.fibers.push_back(fibers), sections.diameters.push_back(fiber);
      sections.spreads.push_back(direction_variance(lod.length_ratios[h]));
    }
    StrandSet& set = out.hairs;
    if (!lod.colors.empty()) set.colors.push_back(lod.colors[h]);
    if (!lod.root_uv.empty()) set.root_uv.push_back(lod.root_uv[h]);
    const std::uint32_t one = lod.order[hair.first_strand];
    set.strand_id.push_back(set_.strand_id.empty() ? one : set_.strand_id[one]);
    end_strand(set);
  }

  /// Direction from a place of the groom to the eye, in the groom's space.
  Vec3 to_eye(Vec3 p) const {
    const Vec3 there = place_.view.perspective ? transform_point(place_.to_camera, p) * -1.f : Vec3(0, 0, -1);
    return x_ * there.x + y_ * there.y + z_ * there.z;
  }

  const StrandSet& set_;
  const LodPlace& place_;
  const LevelBounds& bounds_;
  const LodLevels& levels_;
  Vec3 x_, y_, z_;  // axes of the camera in the groom's space
};

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
}

Pieces make_pieces(const PieceMaker& maker, std::size_t prisms) {
  std::vector<Pieces> parts((prisms + kPrismsPerTask - 1) / kPrismsPerTask);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parts[i].strands.offsets = parts[i].hairs.offsets = {0};
      for (std::size_t p = i * kPrismsPerTask; p < std::min(prisms, (i + 1) * kPrismsPerTask); ++p) maker.add(p, parts[i]);
    }
  });
  Pieces all;
  all.strands.offsets = all.hairs.offsets = {0};
  for (const Pieces& part : parts) {
    append(part.whole, all.whole), append(part.sections, all.sections);
    append(part.strands, all.strands), append(part.hairs, all.hairs);
  }
  return all;
}

}  // namespace

float crossing_ratio(float length_ratio) { return 0.5f * mean_width(std::max(length_ratio, 1.f), 1); }

float direction_variance(float length_ratio) {
  const float cosine = 1 / std::max(length_ratio, 1.f);
  return 0.5f * (1 - cosine * cosine);
}

float covered_width(float band, float fiber, float fibers) {
  if (!(fiber < band)) return band > 0 ? band : fiber;
  return band * -std::expm1(fibers * std::log1p(-fiber / band));
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodPlace& place, const LevelBounds& bounds,
                                       const LodLevels& levels) {
  const std::size_t strands = groom.strands->strand_count();
  if (std::all_of(levels.begin(), levels.end(), [&](std::uint8_t l) { return l == place.lod.levels(); })) return {groom};
  Pieces pieces = make_pieces(PieceMaker(groom, place, bounds, levels), bounds.prisms());
  pieces.strands.basis = groom.strands->basis, pieces.hairs.basis = CurveBasis::kCatmullRom;
  std::vector<GroomInstance> drawn;
  if (!pieces.whole.empty()) {
    std::sort(pieces.whole.begin(), pieces.whole.end());
    drawn.push_back(groom);
    if (pieces.whole.size() < strands)
      drawn.back().only = std::make_shared<const std::vector<std::uint32_t>>(std::move(pieces.whole));
  }
  const auto add = [&](StrandSet& set, const char* what) -> GroomInstance* {
    if (set.points.empty()) return nullptr;
    drawn.push_back(groom);
    drawn.back().name += what;
    drawn.back().strands = std::make_shared<const StrandSet>(std::move(set));
    return &drawn.back();
  };
  add(pieces.strands, " (pieces)");
  if (GroomInstance* hairs = add(pieces.hairs, " (thick hairs)"))
    hairs->sections = std::make_shared<const ThickSections>(std::move(pieces.sections));
  return drawn;
}

}  // namespace pelage
