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

/// Draws thick hairs of one groom as an eye sees them.
class ThickHairPen {
 public:
  ThickHairPen(const StrandSet& set, const LodPlace& place, const LevelBounds& bounds)
      : set_(set), place_(place), bounds_(bounds), to_eye_(place) {}

  void operator()(std::size_t prism, const LodRun& run, Pieces& out) const {
    const LevelBounds::Range hairs = bounds_.hairs(run.level, prism);
    for (std::uint32_t h = hairs.first; h < hairs.last; ++h) add_hair(h, run, out);
  }

 private:
  void add_hair(std::uint32_t h, const LodRun& run, Pieces& out) const {
    const LodHierarchy& lod = place_.lod;
    const float fibers = static_cast<float>(lod.hairs[h].fibers) * crossing_ratio(lod.length_ratios[h]);
    ThickSections& sections = out.sections;
    for (std::size_t k = run.first; k <= run.last; ++k) {
      const std::size_t i = std::size_t{h} * kPoints + k;
      const Vec3 knot = hair_knot(lod, h, k);
      const float band = section_extent(lod.major[i], lod.minor[i], hair_direction(lod, h, k), to_eye_(knot)).width,
                  fiber = 2 * lod.radii[i];
      out.hairs.points.push_back(knot), out.hairs.widths.push_back(covered_width(band, fiber, fibers));
      sections.major.push_back(lod.major[i]), sections.minor.push_back(lod.minor[i]);
      sections.fibers.push_back(fibers), sections.diameters.push_back(fiber);
      sections.spreads.push_back(direction_variance(lod.length_ratios[h]));
    }
    sections.levels.push_back(static_cast<std::uint8_t>(run.level));
    append_attributes(lod, h, set_, out.hairs);
    end_strand(out.hairs);
  }

  const StrandSet& set_;
  const LodPlace& place_;
  const LevelBounds& bounds_;
  const ToEye to_eye_;
};

/// One prism: strands where its segments show them, `clusters` elsewhere.
void draw_prism(const StrandSet& set, const LodHierarchy& lod, const std::uint8_t* levels, std::size_t prism,
                const DrawClusters& clusters, const StrandSet* measured, Pieces& out) {
  const ThickHair& all = lod.hairs[prism];
  const auto* strands = &lod.order[all.first_strand];
  for (std::size_t first = 0, last; first < kLodSegments; first = last) {
    for (last = first + 1; last < kLodSegments && levels[last] == levels[first];) ++last;
    if (levels[first] < lod.levels()) clusters(prism, {first, last, levels[first]}, out);
    else if (first == 0 && last == kLodSegments) out.whole.insert(out.whole.end(), strands, strands + all.fibers);
    else
      for (std::uint32_t i = 0; i < all.fibers; ++i)
        append_strand(set, strands[i], share_at(first), share_at(last), 1, out.strands, measured);
  }
}

Pieces make_pieces(const StrandSet& set, const LodHierarchy& lod, const LodLevels& levels, const DrawClusters& clusters,
                   const StrandSet* measured) {
  const std::size_t prisms = levels.size() / kLodSegments;
  std::vector<Pieces> parts((prisms + kPrismsPerTask - 1) / kPrismsPerTask);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parts[i].strands.offsets = parts[i].hairs.offsets = {0};
      for (std::size_t p = i * kPrismsPerTask; p < std::min(prisms, (i + 1) * kPrismsPerTask); ++p)
        draw_prism(set, lod, &levels[p * kLodSegments], p, clusters, measured, parts[i]);
    }
  });
  Pieces all;
  all.strands.offsets = all.hairs.offsets = {0};
  for (const Pieces& part : parts) append(part, all);
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

ToEye::ToEye(const LodPlace& place) : place_(place) {
  const Affine& to_camera = place.to_camera;
  const float scale = similarity_scale(to_camera);
  for (int i = 0; i < 3; ++i) {  // columns of the inverse's rotation are the rows of this one
    Vec3& axis = i == 0 ? x_ : i == 1 ? y_ : z_;
    axis = Vec3(to_camera.m[i][0], to_camera.m[i][1], to_camera.m[i][2]) / scale;
  }
}

Vec3 ToEye::operator()(Vec3 p) const {
  const Vec3 there = place_.view.perspective ? transform_point(place_.to_camera, p) * -1.f : Vec3(0, 0, -1);
  return x_ * there.x + y_ * there.y + z_ * there.z;
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodPlace& place, const LevelBounds& bounds,
                                       const LodLevels& levels, const StrandSet* measured) {
  return draw_levels(groom, place.lod, levels, CurveBasis::kCatmullRom, ThickHairPen(*groom.strands, place, bounds), measured);
}

std::vector<GroomInstance> draw_levels(const GroomInstance& groom, const LodHierarchy& lod, const LodLevels& levels,
                                       CurveBasis basis, const DrawClusters& clusters, const StrandSet* measured) {
  const std::size_t strands = groom.strands->strand_count();
  if (std::all_of(levels.begin(), levels.end(), [&](std::uint8_t l) { return l == lod.levels(); })) return {groom};
  Pieces pieces = make_pieces(*groom.strands, lod, levels, clusters, measured);
  pieces.strands.basis = groom.strands->basis, pieces.hairs.basis = basis;
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
