// Analytic coverage: the exact area of every band inside every pixel, and the mean direction of what lies there.
//
// Successive segments of a strand add up inside a pixel, to at most 1. Where a strand comes back to a pixel that it had
// left, the overlap is counted on 8 × 8 points, or taken as the product of the areas where it is too thin for that.
// Different strands are taken as independent, so transmittances multiply: Σ −log(1 − a) in fixed point, which integer atomics sum in any order. frame.h reads it:
// analytic_coverage().
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pelage/scene.h>

#include "frame/frame.h"

namespace pelage {

inline constexpr float kMaxStrandDepth = 12.f;  ///< −log(1 − a) of a strand that fills the pixel
inline constexpr float kMaskRadius = 0.25f;     ///< pixels, from which a band is wide enough for 8 × 8 points
inline constexpr float kAreaUnit = 0x1p-14f;    ///< of GBuffer::tangent_cos2 and tangent_sin2

/// Screen direction of the hair in a pixel (x right, y down), unit length, sign arbitrary; (1, 0) where there is none.
inline Vec2 analytic_tangent(const GBuffer& g, std::size_t pixel) {
  const float angle = 0.5f * std::atan2(static_cast<float>(g.tangent_sin2[pixel]), static_cast<float>(g.tangent_cos2[pixel]));
  return {std::cos(angle), std::sin(angle)};
}

/// Areas of one strand by pixel, while its segments come in: a hash table that keeps its memory.
class StrandAreas {
 public:
  struct Entry {
    std::uint32_t pixel = kFree;
    std::uint32_t segment = 0;    // the last one that came in
    float area = 0, covered = 0;  // of this visit of the strand; of the visits before it together
    std::uint64_t mask = 0, covered_mask = 0;
    float cos2 = 0, sin2 = 0;
    void end_visit();
  };
  StrandAreas();
  /// Adds `area` of segment number `segment` (ascending along the strand) with the double angle (cos2, sin2). `mask` says
  /// where it lies, on 8 × 8 points, or is 0 for a strand too thin for them.
  void add(std::uint32_t pixel, std::uint32_t segment, float area, std::uint64_t mask, float cos2, float sin2);
  /// Calls emit(entry) for every pixel touched, in the order of first touch, and forgets them.
  template <class Emit>
  void drain(const Emit& emit) {
    for (const std::uint32_t slot : used_) {
      entries_[slot].end_visit();
      emit(entries_[slot]);
      entries_[slot] = Entry();
    }
    used_.clear();
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;
  std::size_t find(std::uint32_t pixel) const;
  void grow();
  std::vector<Entry> entries_;  // a power of two
  std::vector<std::uint32_t> used_;
};

/// The cells that hair small in the image is summed in: a view of its own onto the part of the image around it.
struct AnalyticCells {
  int per_pixel = 1;      ///< k; with 1 the pixels themselves will do
  int left = 0, top = 0;  ///< pixel of the image where the cells begin
  CameraView view;        ///< its pixels are the cells
};

/// Cells for all grooms of `scene`: enough for kCellsAcross over the height of the smallest, as long as they are no more
/// than kMostCells.
inline constexpr int kCellsAcross = 320, kMostCellsPerPixel = 32;
inline constexpr std::size_t kMostCells = std::size_t{1} << 22;
AnalyticCells choose_cells(const Scene& scene, const CameraView& view);

/// An empty analytic layer of cells, and of opaque depths one per cell where `image` has some: its pixel's samples in turn.
GBuffer make_cells(const AnalyticCells& cells, const GBuffer& image);

/// Means of the cells to the pixels of `image` (its analytic layer, cleared).
void average_cells(const AnalyticCells& cells, const GBuffer& from, GBuffer& image);

/// Adds the strands of `block` to out.coverage, tangent_cos2 and tangent_sin2, behind out.opaque_depth only as far as
/// its samples let them be seen. `areas` is scratch of the calling thread.
void raster_analytic(const ScreenBlock& block, StrandAreas& areas, GBuffer& out);

}  // namespace pelage
