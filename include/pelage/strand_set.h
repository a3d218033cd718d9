// A groom as plain arrays: what every reader fills and every stage reads.
#pragma once

#include <pelage/vec.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

/// How control points become a curve. Ends are clamped so that every basis but Bézier passes n−1 spans over n points:
/// phantom points 2·P0−P1 and 2·Pn−1−Pn−2 continue the ends (USD's `pinned` wrap). Bézier strands have 3·k+1 points.
enum class CurveBasis : std::uint8_t { kLinear, kCatmullRom, kBSpline, kBezier };

/// Strands of hair. Metres, Y up, right-handed; root first.
///
/// Invariants (checked by validate(); every reader and generator establishes them):
/// all numbers are finite, every strand has at least two points, optional arrays are empty or of the stated size.
struct StrandSet {
  std::vector<Vec3> points;              ///< [point_count] control points, metres
  std::vector<std::uint32_t> offsets;    ///< [strand_count + 1] non-decreasing; first is 0, last equals point_count
  std::vector<float> widths;             ///< [point_count], or [1] for one width throughout; diameters, metres, ≥ 0
  std::vector<Vec3> colors;              ///< [0] or [strand_count] or [point_count]; linear reflectance, 0…1
  std::vector<float> transparency;       ///< [0] or [point_count]; 0 opaque … 1 invisible
  std::vector<Vec2> root_uv;             ///< [0] or [strand_count]; texture coordinate of the root on the scalp
  std::vector<std::uint32_t> strand_id;  ///< [0] (then the index) or [strand_count]; survives thinning and sorting
  std::vector<std::int32_t> guide_id;    ///< [0] or [strand_count]; strand_id of the strand's guide, −1 for none
  std::vector<std::uint16_t> group;      ///< [0] or [strand_count]; user's group (scalp, brows, …)
  CurveBasis basis = CurveBasis::kCatmullRom;
  std::string comment;  ///< free text that travels with the groom; UTF-8

  std::size_t point_count() const { return points.size(); }
  std::size_t strand_count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  float width(std::size_t point) const { return widths.size() == 1 ? widths[0] : widths[point]; }
};

/// Largest coordinate and width, metres: their squares stay finite.
inline constexpr float kMaxCoordinate = 1e15f;

/// What repair() changed or dropped, per cause. All zero: the input was sound.
struct RepairReport {
  std::size_t non_finite_points = 0;     ///< points with NaN, infinity or beyond kMaxCoordinate, removed (a Bézier
                                         ///< strand ends before the first span that holds one)
  std::size_t short_strands = 0;         ///< strands with fewer than two usable points, dropped
  std::size_t zero_length_segments = 0;  ///< repeated points, removed (a Bézier strand keeps its count)
  std::size_t degenerate_strands = 0;    ///< strands of no length at all, dropped
  std::size_t partial_spans = 0;         ///< points after the last whole span of a Bézier strand, removed
  std::size_t bad_widths = 0;            ///< negative or non-finite widths, replaced by the strand's median
  std::size_t bad_attributes = 0;        ///< other values: non-finite ones became their defaults, colors and
                                         ///< transparencies were clamped to 0…1
  std::vector<std::uint32_t> dropped;    ///< input indices of dropped strands, ascending, at most 1000 of them

  std::size_t dropped_strands() const { return short_strands + degenerate_strands; }
  bool clean() const;
  std::string summary() const;  ///< one line for people; "no repairs" when clean
};

/// Throws Error(`where`, …) naming the first broken invariant of StrandSet. O(point_count).
void validate(const StrandSet& strands, const std::string& where);

/// Makes `strands` satisfy the invariants, strand by strand; never rejects the whole groom. Tolerates any content of
/// the arrays, but offsets must be a valid partition (readers check that against the file) and optional arrays of a
/// stated size. Untrusted-input safe. Where strands are dropped from a groom without strand_id, the others get their input
/// index as strand_id. Complexity: O(point_count). Strands keep their order.
RepairReport repair(StrandSet& strands);

/// Box of all control points; empty for no strands.
Bounds bounds(const StrandSet& strands);

/// Bytes held by the arrays (capacity, not size).
std::size_t resident_bytes(const StrandSet& strands);

}  // namespace pelage
