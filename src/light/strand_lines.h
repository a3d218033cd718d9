// Strands as world-space polylines, for the maps of the lights.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pelage {

/// Walks a groom's curves at a fixed number of segments per span. Refers to the groom: keep it alive.
class StrandLines {
 public:
  /// 1 ≤ segments_per_span ≤ 16; linear grooms take one segment whatever is asked for.
  StrandLines(const GroomInstance& groom, int segments_per_span);

  std::size_t strand_count() const { return groom_->strands->strand_count(); }
  /// Appends the points and widths (diameters, metres, world) of a strand, root first.
  void append(std::size_t strand, std::vector<Vec3>& points, std::vector<float>& widths) const;

 private:
  const GroomInstance* groom_;
  float width_scale_;
  std::vector<Vec4> weights_;  ///< blend of a span's four control points at 1/n, 2/n, … 1
};

/// Mean length of a span of `groom` in world space, metres, over at most a thousand strands; 0 for none.
float mean_span_length(const GroomInstance& groom);

/// World-space box of the control points of all grooms.
Bounds groom_bounds(const std::vector<GroomInstance>& grooms);

}  // namespace pelage
