// Strands as world-space polylines, for the maps of the lights.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <vector>

#include "frame/strand_part.h"
#include "light/splat.h"

namespace pelage {

/// A groom as polylines of a fixed number of segments per span. Refers to the groom: keep it alive.
class StrandLines {
 public:
  /// O(control points that are drawn), for the bounds.
  explicit StrandLines(const GroomInstance& groom);

  std::size_t part_count() const { return drawn_parts(*groom_); }
  const Bounds& bounds() const { return bounds_; }    ///< of the control points that are drawn, world space
  const Bounds& reach() const { return reach_; }      ///< of the curves and their widths, world space
  float widest_band() const { return widest_band_; }  ///< metres, what a light sees at most
  float mean_span() const { return mean_span_; }      ///< metres, over at most a thousand strands

  /// One strand, or part of one, of each `stride` neighbors, picked by a random number of its own; all for stride 1, in the order that
  /// suits `view`.
  std::vector<StrandPart> pick(std::size_t stride, const CameraView& view) const;
  /// Fills `block` with picked[first], … before picked[last]: at least one, as many as LineBlock::kPoints takes.
  /// Returns where to go on. 1 ≤ segments_per_span ≤ kMaxSegments; linear grooms take one whatever is asked for.
  std::size_t fill(const std::vector<StrandPart>& picked, std::size_t first, std::size_t last, int segments_per_span,
                   LineBlock& block) const;
  static constexpr int kMaxSegments = 4;

 private:
  /// Stored width of what a control point shows a light, and how many hairs a ray through it meets.
  struct Band {
    float width, density;
  };
  Band band(std::size_t point) const { return bands_.empty() ? Band{groom_->strands->width(point), 1} : bands_[point]; }
  void append(const StrandPart& part, const std::vector<Vec4>& weights, LineBlock& block) const;

  const GroomInstance* groom_;
  Buffer<Band> bands_;  // [points] of thick hairs; else empty
  float width_scale_;
  float mean_span_ = 0, widest_band_ = 0;
  Bounds bounds_, reach_;
};

/// Refer to `grooms`: keep them alive.
std::vector<StrandLines> strand_lines(const std::vector<GroomInstance>& grooms);
std::vector<StrandLines> strand_lines(std::vector<GroomInstance>&&) = delete;
Bounds bounds(const std::vector<StrandLines>& grooms);

}  // namespace pelage
