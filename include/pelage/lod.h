// Level of detail with thick hairs: clusters of strands, each as one hair of elliptical cross-section, in a chain of levels, and
// the guides that move all of it (Huang 2025, section 5; references.bib: Huang2025LevelOfDetail). docs/lod.md says how it is made.
#pragma once

#include <pelage/progress.h>
#include <pelage/strand_set.h>
#include <pelage/vec.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace pelage {

struct GuideAnimation;  // <pelage/animation.h>

/// One thick hair: whom it stands for, and its place in the tree. Its curves stand in LodHierarchy under its index.
struct ThickHair {
  std::uint32_t first_strand = 0;  ///< of its strands in LodHierarchy::order
  std::uint32_t fibers = 0;        ///< n_total: how many strands it stands for, ≥ 1
  std::uint32_t parent = 0;        ///< hair of the next coarser level that holds its strands; kNone in level 0
  std::uint32_t first_child = 0;   ///< hairs of the next finer level that share its strands; kNone in the finest level
  std::uint32_t children = 0;      ///< 0 in the finest level, whose children are the strands themselves
  std::uint32_t prism = 0;         ///< the three guides that it moves with; level 0 has one hair for each prism, in order
};

/// The levels of a groom, coarsest first, from few thick hairs to many; the groom's own strands come after the finest.
///
/// Every level stands for every strand once: in `order`, the hairs of a level are contiguous ranges that follow one another,
/// and a hair's children divide its range. All curves are uniform cubic B-splines of kPoints control points with StrandSet's
/// clamped ends, root first, and run at equal shares of arc length: control point k belongs to the place k/(kPoints − 1) of every
/// strand of the cluster. Metres.
///
/// The cross-section at control point k of hair h, index i = h·kPoints + k, is the ellipse centers[i] + x·major[i] + y·minor[i],
/// x² + y² ≤ 1. Its corners (the paper's p_0…3) are centers ± major and centers ± minor. The axes are perpendicular to each other
/// and to the mean tangent, and neither turns over from one control point to the next. `major` is the longer one on the mean of
/// the hair; at single points it may be the shorter one.
struct LodHierarchy {
  static constexpr std::uint32_t kPoints = 16;         ///< n_c
  static constexpr std::uint32_t kMostLevels = 16;     ///< of thick hairs
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< no such hair

  // Guides and what moves with them.
  std::vector<std::uint32_t> guide_strands;          ///< [guide_count] the strand that is the guide (index in the groom)
  std::vector<Vec3> guides;                          ///< [guide_count·kPoints] control points at rest
  std::vector<std::array<std::uint32_t, 3>> prisms;  ///< [hairs of level 0] three guides, ascending; equal only where there are
                                                     ///< fewer than three guides
  // Strands.
  std::vector<std::uint32_t> order;  ///< [strand_count] a permutation: strands of the groom, cluster by cluster
  std::vector<Vec2>
      strand_weights;  ///< [strand_count] in the groom's numbering: share of the first and the second guide of the
                       ///< strand's prism; the third has the rest. Each 0…1

  // Thick hairs, level by level.
  std::vector<std::uint32_t> level_offsets;        ///< [levels + 1] into `hairs`, increasing; first is 0, last hair_count
  std::vector<ThickHair> hairs;                    ///< [hair_count]
  std::vector<Vec2> weights;                       ///< [hair_count] of the centers, as strand_weights: the mean of its strands'
  std::vector<Vec3> centers;                       ///< [hair_count·kPoints] mean of the strands' places
  std::vector<Vec3> major, minor;                  ///< [hair_count·kPoints] semi-axes r_A and r_B
  std::vector<Vec2> major_weights, minor_weights;  ///< [hair_count·kPoints] by how much the weights grow from the center to the
                                                   ///< corner at its end: sections grow where guides part
  std::vector<float> radii;                        ///< [hair_count·kPoints] mean radius of the fibers, ≥ 0
  std::vector<float> length_ratios;  ///< [hair_count] mean length of the fibers over that of the center: how much more
                                     ///< hair there is than a straight bundle of it would hold; > 0
  std::vector<float> twists;  ///< [0] or [hair_count] radians a metre by which the fibers turn about the center from root to
                              ///< tip, right-handed about it; none: 0. Finite
  std::vector<Vec3> colors;   ///< [0] or [hair_count] mean linear reflectance, where the groom has colors
  std::vector<Vec2> root_uv;  ///< [0] or [hair_count] mean texture coordinate of the roots, where the groom has them

  std::shared_ptr<const GuideAnimation> animation;  ///< of the guides, by pelage simulate; or null. Everything above is at rest

  std::size_t levels() const { return level_offsets.empty() ? 0 : level_offsets.size() - 1; }
  std::size_t hair_count() const { return hairs.size(); }
  std::size_t guide_count() const { return guide_strands.size(); }
  std::size_t strand_count() const { return order.size(); }
  bool empty() const { return hairs.empty(); }
  std::span<const ThickHair> level(std::size_t l) const {
    return {hairs.data() + level_offsets[l], level_offsets[l + 1] - level_offsets[l]};
  }
};

/// What to build. build_lod() throws an Error that names the setting and its range when one is outside it.
struct LodSettings {
  std::uint32_t levels = 6;    ///< of thick hairs, at most, 1…16. Fewer where clusters run out of strands or memory is short
  std::uint32_t guides = 256;  ///< clusters of which each gives a guide, 1…65536; at most one a strand (the paper's value).
                               ///< 0: the strands that the groom's own name as their guides (StrandSet::guide_id)
  float area_ratio = 4;   ///< by which the mean area of cross-sections falls from level to level, 1.5…64 (the paper's value)
  float covered = 0.95f;  ///< share of a cluster's fibers that its ellipse holds at every control point, 0.5…1
  float memory_share = 0.78f;  ///< of the groom's points and widths: finer levels that would take more are left out, 0.01…100
                               ///< (the paper's value). The coarsest level is always there
  std::uint32_t seed = 1;      ///< of the clusters
};

/// The hierarchy of `strands`: their guides by k-means, level 0 by the guides they share, finer levels by dividing clusters, an
/// ellipse along each (Huang 2025, section 5.1). Strands of any number of points and lengths, in any basis.
///
/// The same bits for any thread count. Throws Error where `strands` break a rule of StrandSet or there are none, and when cancelled.
LodHierarchy build_lod(const StrandSet& strands, const LodSettings& settings = {}, const Progress& progress = {});

/// Throws Error(`where`, …) naming the first broken rule of LodHierarchy. Untrusted-input safe. O(its size).
void validate(const LodHierarchy& lod, const std::string& where);

/// Throws Error(`where`, …) unless `lod` is one of `strands`: as many of them, with the guides' roots and tips among them.
void validate(const LodHierarchy& lod, const StrandSet& strands, const std::string& where);

/// Bytes that the hierarchy holds beyond the groom.
std::size_t resident_bytes(const LodHierarchy& lod);

/// One level in numbers. Means are over strands: what the thick hair is like that a strand stands in.
struct LodLevelSummary {
  std::size_t hairs = 0, segments = 0;  ///< segments: spans of control points
  std::size_t most_fibers = 0;          ///< in one hair
  double mean_fibers = 0;               ///< strands over hairs
  double mean_area = 0;                 ///< of cross-sections, square metres
  double mean_width = 0;                ///< metres, of the shadow that the cross-section casts, over all directions
  double mean_density = 0;              ///< ρ = n_total·r²/(r_A·r_B), at most 1
  std::size_t bytes = 0;                ///< of its hairs
};
std::vector<LodLevelSummary> summarize(const LodHierarchy& lod);

/// Mean width of the shadow of an ellipse with semi-axes a and b over all directions in its plane: its perimeter over π (Cauchy).
float mean_width(float a, float b);

/// The thick hairs of a level as an ordinary groom, to look at: B-splines along the centers, as wide as the mean shadow of their
/// cross-sections. `level` < levels(), or Error.
StrandSet extract_level(const LodHierarchy& lod, std::size_t level);

/// Writes `strands` and `lod` into one `.pelage` file; who asks it for strands alone does not notice. Throws Error, also where `lod`
/// does not belong to `strands`; then nothing is left at `path` that was not there.
void write_lod(const std::string& path, const StrandSet& strands, const LodHierarchy& lod, const Progress& progress = {});

/// The hierarchy of a `.pelage` file; empty() where the file has none, or is of another format. It satisfies validate(), and
/// belongs to the strands as the file holds them: neither scaled nor turned nor repaired. Throws Error naming the section.
LodHierarchy read_lod(const std::string& path, const Progress& progress = {});

/// What GroomInstance::lod of `strands` is, which were read from the same file: null where the file has no hierarchy, or the strands are not as
/// the file holds them (scaled, turned, repaired). Throws as read_lod() does.
std::shared_ptr<const LodHierarchy> read_chain(const std::string& path, const StrandSet& strands,
                                               const Progress& progress = {});

// ---------------------------------------------------------------------------------------------------------------------
// Skinning: guides move, everything else follows.

/// Thick hairs in a pose: as the fields of LodHierarchy of those names.
struct ThickHairPose {
  std::vector<Vec3> centers, major, minor;
};

/// The hairs when the guides' control points are at `guides` [guide_count·kPoints]. A rigid motion of all guides moves the hairs
/// alike, and guides at rest leave them, both to rounding. `pose` is overwritten; its memory is used again.
void pose_hairs(const LodHierarchy& lod, std::span<const Vec3> guides, ThickHairPose& pose);

/// The strands when the guides are there. `rest` is the groom that the hierarchy was built for; only points move.
StrandSet pose_strands(const LodHierarchy& lod, const StrandSet& rest, std::span<const Vec3> guides);

}  // namespace pelage
