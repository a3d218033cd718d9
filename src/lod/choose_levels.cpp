#include "lod/choose_levels.h"

#include <algorithm>
#include <cmath>

#include "core/bounds.h"
#include "core/check.h"
#include "core/parallel.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

constexpr std::size_t kPoints = LodHierarchy::kPoints;

/// Pixels that hair `hair` is wide at control point k; INFINITY before the near plane.
float pixels_wide(const LodPlace& place, std::size_t hair, std::size_t k) {
  const LodHierarchy& lod = place.lod;
  const std::size_t i = hair * kPoints + k;
  const Vec3 center = transform_point(place.to_camera, lod.centers[i]);
  if (!(center.z >= place.view.near_plane)) return INFINITY;
  const auto turned = [&](Vec3 v) { return transform_vector(place.to_camera, v); };
  const Vec3 to_eye = place.view.perspective ? center * -1.f : Vec3(0, 0, -1);
  const SectionExtent seen =
      section_extent(turned(lod.major[i]), turned(lod.minor[i]), turned(hair_direction(lod, hair, k)), to_eye);
  return seen.width * pixels_per_metre(place.view, center.z);
}

/// Nearest and farthest camera depth of a box.
struct DepthSpan {
  float nearest = INFINITY, farthest = -INFINITY;
};
DepthSpan depths(const LodPlace& place, const LevelBounds::Bound& bound) {
  DepthSpan span;
  for (const Vec3 corner : corners(Bounds{bound.lower, bound.upper})) {
    const float z = transform_point(place.to_camera, corner).z;
    span.nearest = std::min(span.nearest, z), span.farthest = std::max(span.farthest, z);
  }
  return span;
}

/// Whether all hairs of a level in a prism are at most `pixels` wide at control point k.
bool narrow(const LodPlace& place, const LevelBounds& bounds, std::size_t level, std::size_t prism, std::size_t k,
            float pixels) {
  constexpr float kSafety = 1e-4f;  // for roundings of the bounds
  const LevelBounds::Bound& bound = bounds.at(level, prism, k);
  const DepthSpan depth = depths(place, bound);
  if (!(depth.nearest >= place.view.near_plane)) return false;
  const float scale = similarity_scale(place.to_camera);
  if (scale * bound.widest * pixels_per_metre(place.view, depth.nearest) <= pixels * (1 - kSafety)) return true;
  if (scale * bound.narrowest * pixels_per_metre(place.view, depth.farthest) > pixels * (1 + kSafety)) return false;
  const LevelBounds::Range hairs = bounds.hairs(level, prism);
  for (std::uint32_t h = hairs.first; h < hairs.last; ++h)
    if (!(pixels_wide(place, h, k) <= pixels)) return false;
  return true;
}

/// The least width that an ellipse shows from any side of a hair along `along`: twice the smaller singular value of its axes, seen
/// along the hair.
float narrowest(Vec3 major, Vec3 minor, Vec3 along) {
  const float length2 = dot(along, along);
  if (!(length2 > 0)) return 0;
  const Vec3 a = major - along * (dot(major, along) / length2), b = minor - along * (dot(minor, along) / length2);
  const float aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
  return 2 * std::sqrt(std::max(0.f, 0.5f * (aa + bb) - std::hypot(0.5f * (aa - bb), ab)));
}

}  // namespace

Vec3 hair_direction(const LodHierarchy& lod, std::size_t hair, std::size_t k) {
  const Vec3* c = &lod.centers[hair * kPoints];
  return c[std::min(k + 1, kPoints - 1)] - c[k > 0 ? k - 1 : 0];
}

LevelBounds::LevelBounds(const LodHierarchy& lod) : prisms_(lod.empty() ? 0 : lod.level(0).size()) {
  ranges_.resize(lod.levels() * prisms_), bounds_.resize(ranges_.size() * kPoints);
  for (std::size_t p = 0; p < prisms_; ++p) {
    const auto own = static_cast<std::uint32_t>(p);
    ranges_[p] = {own, own + 1};
  }
  for (std::size_t l = 1; l < lod.levels(); ++l)
    for (std::size_t p = 0; p < prisms_; ++p) {
      const Range coarser = ranges_[(l - 1) * prisms_ + p];
      const ThickHair& last = lod.hairs[coarser.last - 1];
      ranges_[l * prisms_ + p] = {lod.hairs[coarser.first].first_child, last.first_child + last.children};
    }
  parallel_for(ranges_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t k = 0; k < kPoints; ++k) {
        Bounds box;
        Bound& bound = bounds_[r * kPoints + k];
        for (std::size_t h = ranges_[r].first; h < ranges_[r].last; ++h) {
          const std::size_t i = h * kPoints + k;
          box.extend(lod.centers[i]);
          bound.widest = std::max({bound.widest, 2 * length(lod.major[i]), 2 * length(lod.minor[i])});
          bound.narrowest = std::max(bound.narrowest, narrowest(lod.major[i], lod.minor[i], hair_direction(lod, h, k)));
        }
        bound.lower = box.lower, bound.upper = box.upper;
      }
  });
  for (std::size_t r = 0; r < prisms_; ++r)
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Bound& bound = bounds_[r * kPoints + k];
      const Vec3 reach{bound.widest * 0.5f, bound.widest * 0.5f, bound.widest * 0.5f};
      box_.extend(bound.lower - reach), box_.extend(bound.upper + reach);
    }
}

LodLevels choose_levels(const LodPlace& place, const LevelBounds& bounds, float pixels, std::span<const std::uint8_t> before) {
  const std::size_t levels = place.lod.levels(), prisms = bounds.prisms();
  LodLevels chosen(prisms * kLodSegments, static_cast<std::uint8_t>(levels));
  PELAGE_CHECK(before.empty() || before.size() == chosen.size());
  parallel_for(prisms, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      std::uint8_t* level_of = &chosen[p * kLodSegments];
      std::uint32_t open = (1u << kLodSegments) - 1;  // bit k: segment k has no level yet
      for (std::size_t l = 0; l < levels && open != 0; ++l) {
        std::uint32_t wide = 0;  // bit k: control point k is wider, bit 16 + k: than what a coarser level may be
        for (std::size_t k = 0; k < kPoints; ++k) {
          if (!(open >> k & 1) && !(k > 0 && open >> (k - 1) & 1)) continue;
          if (!narrow(place, bounds, l, p, k, pixels)) wide |= 0x10001u << k;
          else if (!before.empty() && !narrow(place, bounds, l, p, k, pixels * kCoarserBelow)) wide |= 0x10000u << k;
        }
        for (std::size_t k = 0; k < kLodSegments; ++k) {
          const bool coarser = !before.empty() && l < before[p * kLodSegments + k];
          const std::uint32_t too_wide = coarser ? wide >> 16 : wide & 0xffff;
          if (!(open >> k & 1) || (too_wide >> k & 3) != 0) continue;
          level_of[k] = static_cast<std::uint8_t>(l);
          open &= ~(1u << k);
        }
      }
    }
  });
  return chosen;
}

LodLevels one_level(const LodHierarchy& lod, std::size_t level) {
  return LodLevels(lod.level(0).size() * kLodSegments, static_cast<std::uint8_t>(std::min(level, lod.levels() - 1)));
}

}  // namespace pelage
