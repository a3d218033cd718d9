#include "lod/choose_levels.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;
constexpr std::size_t kPrismsPerTask = 16;

constexpr float kFlipScale2 = 0.0203f, kFlipBend = 0.4f;  // k² and q of predicted_flip()

/// Segments with one of these control points at an end.
std::uint32_t segments_at(std::uint32_t points) { return points | points >> 1; }

/// Segments at whose ends a value is not at most `most`.
std::uint32_t segments_beyond(const std::array<float, kPoints>& values, float most) {
  std::uint32_t beyond = 0;  // control points
  for (std::size_t k = 0; k < kPoints; ++k) beyond |= std::uint32_t{!(values[k] <= most)} << k;
  return segments_at(beyond);
}

/// Goes through the hairs whose parents are split, coarse levels first: split[h] becomes the part of its open segments that splits(h, open) says.
template <class Splits>
void walk(const LodHierarchy& lod, const PrismHairs& prisms, LodCut& split, const Splits& splits) {
  parallel_for(prisms.prisms(), kPrismsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = 0; l < lod.levels(); ++l)
      for (std::uint32_t h = prisms.hairs(l, begin).first; h < prisms.hairs(l, end - 1).last; ++h) {
        const std::uint32_t open = l == 0 ? kAllSegments : split[lod.hairs[h].parent];
        if (open != 0) split[h] = static_cast<std::uint16_t>(open & splits(h, open));
      }
  });
}

/// The cut of the coarsest hairs whose `measure`, an array with a value a control point, is at most `most`; back where it is at most `back`.
template <class Measure>
LodCut choose(const LodHierarchy& lod, const PrismHairs& prisms, const Measure& measure, float most, float back,
              std::span<const std::uint16_t> before) {
  LodCut split(lod.hair_count());
  PELAGE_CHECK(before.empty() || before.size() == split.size());
  walk(lod, prisms, split, [&](std::uint32_t hair, std::uint32_t) {
    const std::array<float, kPoints> values = measure(hair);
    const std::uint32_t stays = before.empty() ? 0 : before[hair] & segments_beyond(values, back);
    return segments_beyond(values, most) | stays;
  });
  return split;
}

/// Whether what a hair would show instead is the same again.
bool is_one(const ThickHair& hair) { return hair.children == 1 || (hair.children == 0 && hair.fibers == 1); }

/// How far a value is from `from` to `most`, 0…1.
float share_beyond(float value, float from, float most) {
  if (value <= from) return 0;
  return value < most ? (value - from) / (most - from) : 1;
}

/// Hairs whose `measure` is between `from` and `most` blend with their children.
template <class Measure>
BlendedCut blend_levels(const LodHierarchy& lod, const PrismHairs& prisms, const Measure& measure, float from, float most) {
  BlendedCut cut{LodCut(lod.hair_count()), LodCut(lod.hair_count()), std::vector<float>(lod.hair_count() * kPoints)};
  walk(lod, prisms, cut.split, [&](std::uint32_t hair, std::uint32_t open) {
    const ThickHair& h = lod.hairs[hair];
    const std::array<float, kPoints> values = measure(hair);
    const float *above = h.parent == LodHierarchy::kNone ? nullptr : &cut.passed[std::size_t{h.parent} * kPoints],
                end = is_one(h) ? from : most;
    float* passed = &cut.passed[std::size_t{hair} * kPoints];
    std::uint32_t passes = 0, keeps = 0;  // control points
    for (std::size_t k = 0; k < kPoints; ++k) {
      const float whole = above ? above[k] : 1;
      passed[k] = whole * share_beyond(values[k], from, end);
      passes |= std::uint32_t{passed[k] > 0} << k, keeps |= std::uint32_t{passed[k] < whole} << k;
    }
    cut.shown[hair] = static_cast<std::uint16_t>(open & segments_at(keeps));
    return segments_at(passes);
  });
  return cut;
}

}  // namespace

Vec3 hair_direction(const LodHierarchy& lod, std::size_t hair, std::size_t k) {
  const Vec3* c = &lod.centers[hair * kPoints];
  return c[std::min(k + 1, kPoints - 1)] - c[k > 0 ? k - 1 : 0];
}

PrismHairs::PrismHairs(const LodHierarchy& lod) : prisms_(lod.empty() ? 0 : lod.level(0).size()) {
  ranges_.resize(lod.levels() * prisms_);
  for (std::size_t p = 0; p < prisms_; ++p) {
    const auto own = static_cast<std::uint32_t>(p);
    ranges_[p] = {own, own + 1};
    for (std::size_t k = 0; k < kPoints; ++k) {
      const std::size_t i = p * kPoints + k;
      const float reach = std::max(length(lod.major[i]), length(lod.minor[i]));
      box_.extend(lod.centers[i] - Vec3(reach, reach, reach)), box_.extend(lod.centers[i] + Vec3(reach, reach, reach));
    }
  }
  for (std::size_t l = 1; l < lod.levels(); ++l)
    for (std::size_t p = 0; p < prisms_; ++p) {
      const Range coarser = ranges_[(l - 1) * prisms_ + p];
      const ThickHair& last = lod.hairs[coarser.last - 1];
      ranges_[l * prisms_ + p] = {lod.hairs[coarser.first].first_child, last.first_child + last.children};
    }
}

LodCut choose_levels(const LodPlace& place, const PrismHairs& prisms, float pixels, std::span<const std::uint16_t> before) {
  const LodEye eye(place);
  const auto widths = [&](std::uint32_t hair) { return hair_widths(place.lod, eye, hair).pixels; };
  return choose(place.lod, prisms, widths, pixels, pixels * kCoarserBelow, before);
}

LodCut choose_levels_by_error(const LodPlace& place, const PrismHairs& prisms, float flip,
                              std::span<const std::uint16_t> before) {
  const LodEye eye(place);
  const auto variances = [&](std::uint32_t hair) { return hair_errors(place.lod, eye, hair).variance; };
  const float most = variance_for_flip(flip);
  return choose(place.lod, prisms, variances, most, most * kCoarserBelow * kCoarserBelow, before);
}

float BlendedCut::share(const LodHierarchy& lod, std::size_t h, std::size_t k) const {
  const std::uint32_t parent = lod.hairs[h].parent;
  return (parent == LodHierarchy::kNone ? 1 : passed[std::size_t{parent} * kPoints + k]) - passed[h * kPoints + k];
}

BlendedCut choose_blended(const LodPlace& place, const PrismHairs& prisms, float pixels, float blend) {
  const LodEye eye(place);
  const auto widths = [&](std::uint32_t hair) { return hair_widths(place.lod, eye, hair).pixels; };
  return blend_levels(place.lod, prisms, widths, pixels * (1 - blend), pixels);
}

BlendedCut choose_blended_by_error(const LodPlace& place, const PrismHairs& prisms, float flip, float blend) {
  const LodEye eye(place);
  const auto variances = [&](std::uint32_t hair) { return hair_errors(place.lod, eye, hair).variance; };
  const float most = variance_for_flip(flip);
  return blend_levels(place.lod, prisms, variances, most * (1 - blend) * (1 - blend), most);
}

float predicted_flip(float variance) {
  return std::isinf(variance) ? std::sqrt(kFlipScale2 / kFlipBend)
                              : std::sqrt(kFlipScale2 * variance / (1 + kFlipBend * variance));
}

float variance_for_flip(float flip) {
  const float square = flip * flip, left = kFlipScale2 - kFlipBend * square;
  return left > 0 ? square / left : INFINITY;
}

LodCut one_level(const LodHierarchy& lod, std::size_t level) {
  LodCut split(lod.hair_count());
  std::fill_n(split.begin(), lod.level_offsets[std::min(level, lod.levels())], kAllSegments);
  return split;
}

std::uint16_t shown_segments(const LodHierarchy& lod, const LodCut& split, std::size_t hair) {
  const std::uint32_t parent = lod.hairs[hair].parent, open = parent == LodHierarchy::kNone ? kAllSegments : split[parent];
  return static_cast<std::uint16_t>(open & ~split[hair]);
}

}  // namespace pelage
