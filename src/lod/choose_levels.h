// Which level of a chain of thick hairs is drawn where: hair by hair and segment by segment, by its width on the screen
// (Huang 2025, section 5.2; references.bib: Huang2025LevelOfDetail).
#pragma once

#include <pelage/lod.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/bounds.h"
#include "lod/hair_widths.h"

namespace pelage {

/// Segments of a thick hair, of which each has a level.
inline constexpr std::size_t kLodSegments = LodHierarchy::kPoints - 1;
/// A bit for each.
inline constexpr std::uint16_t kAllSegments = (1u << kLodSegments) - 1;

/// Share of a hair's length that control point k lies at.
inline float share_at(std::size_t k) { return static_cast<float>(k) / static_cast<float>(kLodSegments); }

/// Direction of a thick hair at control point k, of any length.
Vec3 hair_direction(const LodHierarchy& lod, std::size_t hair, std::size_t k);

/// Which hairs share the prism of a hair of level 0.
class PrismHairs {
 public:
  /// O(hairs · kPoints).
  explicit PrismHairs(const LodHierarchy& lod);

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
};

/// A cut through the tree of hairs at every segment, [hair_count]: bit k is set where segment k of the hair shows its children, or its
/// strands where it has none. A hair shows its own segments where its parent's bit is set and its own is not; a bit is only set where
/// the parent's is.
using LodCut = std::vector<std::uint16_t>;

/// The coarsest hairs that are nowhere in a segment wider than `pixels` on the screen; eq. 16, with as many steps at once as it
/// takes, for each hair by itself. Where `before`, the cut of the frame before (or empty), showed finer hairs, a hair comes back
/// only where it is narrower by a tenth, so that a width at the limit does not change levels forth and back. Segments before the near plane show strands.
///
/// The same for any number of threads. O(hairs that are looked at): those that are shown and those above them.
LodCut choose_levels(const LodPlace& place, const PrismHairs& prisms, float pixels, std::span<const std::uint16_t> before = {});
inline constexpr float kCoarserBelow = 0.9f;  ///< of `pixels`

/// The same by what is predicted of the picture instead of its width: the coarsest hairs of which nowhere more than `flip` is to be expected, mean FLIP over their pixels beside
/// all strands, 0.001…0.2 (predicted_flip of hair_errors()). Hairs come back where the variance is less by kCoarserBelow².
LodCut choose_levels_by_error(const LodPlace& place, const PrismHairs& prisms, float flip,
                              std::span<const std::uint16_t> before = {});

/// A cut whose levels blend: within a band of widths a hair and its children are both drawn, each with a share of the fibers. A share of control points, straight
/// between them, so that neighbors along a hair meet without a step. Shares of all levels at a place sum to 1.
struct BlendedCut {
  LodCut
      split;  ///< where a hair's children show (or its strands), with a share or alone; a bit is only set where the parent's is
  LodCut shown;  ///< where the hair itself does
  std::vector<float>
      passed;  ///< [hair_count·kPoints] the share that its children show, 0…1; of hairs whose parent is split, the others': 0

  bool empty() const { return split.empty(); }
  /// Share that hair `h` itself shows at control point k.
  float share(const LodHierarchy& lod, std::size_t h, std::size_t k) const;
  bool operator==(const BlendedCut&) const = default;
};

/// The hairs of choose_levels(), of which those that are wider than (1 − blend) of `pixels` fade out, and their children in, in proportion to their width. Depends on
/// nothing but widths, so there is no hysteresis. A hair that is one with what it would show instead, a single child or strand, is replaced at once: two of the
/// same in one place would hide each other. 0 < blend < 1.
BlendedCut choose_blended(const LodPlace& place, const PrismHairs& prisms, float pixels, float blend);
/// The same by what is predicted of the picture, from (1 − blend)² of the variance on.
BlendedCut choose_blended_by_error(const LodPlace& place, const PrismHairs& prisms, float flip, float blend);

/// FLIP that a variance of hair_errors() adds to that of sampling, root of the sum of squares: k √(X/(1 + q X)), which is √(k²/q) at most.
/// Fitted to 96 pictures (4 hairstyles, 6 distances, every level; docs/lod.md).
float predicted_flip(float variance);
/// The variance that is predicted to look so; INFINITY where FLIP cannot become as large.
float variance_for_flip(float flip);

/// The same level everywhere, the finest where there are fewer; `level` = lod.levels(): strands.
LodCut one_level(const LodHierarchy& lod, std::size_t level);

/// Segments that a hair shows.
std::uint16_t shown_segments(const LodHierarchy& lod, const LodCut& split, std::size_t hair);

}  // namespace pelage
