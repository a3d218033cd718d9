// Which level of a chain of thick hairs is drawn where: cluster by cluster and segment by segment, by its width on the screen
// (Huang 2025, section 5.2; references.bib: Huang2025LevelOfDetail).
#pragma once

#include <pelage/lod.h>
#include <pelage/scene.h>

#include <cstdint>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "frame/section.h"

namespace pelage {

/// Segments of a thick hair, of which each has a level.
inline constexpr std::size_t kLodSegments = LodHierarchy::kPoints - 1;

/// Direction of a thick hair at control point k, of any length.
Vec3 hair_direction(const LodHierarchy& lod, std::size_t hair, std::size_t k);

/// Where a groom's chain stands in a scene: what choosing needs of it.
struct LodPlace {
  const LodHierarchy& lod;
  const CameraView& view;
  Affine to_camera;  ///< object → camera, a similarity
};

/// The widest thick hair of every level in every prism, at every control point, from the side that shows the most and
/// from the one that shows the least: bounds that spare most hairs a closer look. Metres, object space.
class LevelBounds {
 public:
  /// O(hairs · kPoints).
  explicit LevelBounds(const LodHierarchy& lod);

  struct Bound {
    float widest = 0;     ///< no hair is wider
    float narrowest = 0;  ///< some hair is no narrower
    Vec3 lower, upper;    ///< box of the centers
  };
  const Bound& at(std::size_t level, std::size_t prism, std::size_t k) const {
    return bounds_[(level * prisms_ + prism) * LodHierarchy::kPoints + k];
  }
  /// Hairs first … last − 1 of a level move with this prism.
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  Range hairs(std::size_t level, std::size_t prism) const { return ranges_[level * prisms_ + prism]; }
  std::size_t prisms() const { return prisms_; }
  const Bounds& box() const { return box_; }  ///< of all thick hairs, object space

 private:
  std::size_t prisms_;
  Bounds box_;
  std::vector<Range> ranges_;  // [levels · prisms]
  std::vector<Bound> bounds_;  // [levels · prisms · kPoints]
};

/// The level of every segment of every prism, [prisms · kLodSegments]; lod.levels() stands for the strands themselves.
using LodLevels = std::vector<std::uint8_t>;

/// The coarsest level whose hairs are nowhere in the segment wider than `pixels` on the screen; eq. 16 with as many steps at once as it
/// takes. From `before`, the levels of the frame before (or empty), a segment goes to a coarser level only where that is narrower
/// by a tenth, so that a width at the limit does not change levels forth and back. Segments before the near plane show strands.
///
/// The same for any number of threads. O(prisms · levels), and hairs where bounds leave it open.
LodLevels choose_levels(const LodPlace& place, const LevelBounds& bounds, float pixels,
                        std::span<const std::uint8_t> before = {});
inline constexpr float kCoarserBelow = 0.9f;  ///< of `pixels`

/// The same level everywhere; the finest where there are fewer.
LodLevels one_level(const LodHierarchy& lod, std::size_t level);

}  // namespace pelage
