// Drawing polylines into the maps of a light: the hot loops of opacity_map.cpp, a segment per lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// World-space points of several polylines. Point j and point j+1 bound a segment where width[j] > 0.
struct LineBlock {
  static constexpr std::size_t kPoints = 2048;  ///< aimed at; longer polylines grow the block
  static constexpr std::size_t kPadding = 64;   ///< points of width 0 behind the last, for whole-lane loads
  std::size_t count = 0;
  Buffer<float> x, y, z;  ///< metres
  Buffer<float> width;    ///< metres, of the band that starts here; 0: none does
  Buffer<float> density;  ///< hairs that a ray through the band meets on average: 1 of a strand
};

/// A map of every 2^k × 2^k texels as one, for bands that are many texels wide. Level 0 is the map itself.
struct SplatLevel {
  float scale = 1;              ///< 2^−k
  float width = 0, height = 0;  ///< of the map, in texels of this level
  std::int32_t columns = 0, rows = 0;
  std::uint32_t* crossings = nullptr;  ///< per texel and layer (not yet summed over layers), raised by splat_crossings
};

/// The map that is drawn into; the depths are shared by all threads.
struct SplatTarget {
  /// The coarsest has texels as large as OpacityMap::kOriginBlock: each of its texels has one first depth, so layers stay what they are.
  static constexpr int kMaxLevels = 3;
  static_assert(1 << (kMaxLevels - 1) == OpacityMap::kOriginBlock);
  CameraView view;
  std::int32_t origin_columns = 0;
  std::uint32_t* first_depth = nullptr;  ///< IEEE bits of positive floats, lowered by splat_depths
  std::array<SplatLevel, kMaxLevels> levels;
  int level_count = 1;
  bool shared = true;  ///< crossings too
  std::array<float, OpacityMap::kLayers> layer_end{};
  float units = 1;  ///< of OpacityMap::kCrossingUnit per crossing, times the strands that each stands for
};

/// A band is drawn into level k + 1, where there is one, from this many of its texels on: it is smeared by half its width at most.
inline constexpr float kBandTexels = 4;

/// Lowers first_depth to the depth of every segment that a block of texels sees. Segments that reach behind the near plane
/// are left out, here and below. Thread-safe on one target; atomic minima do not depend on the order.
void splat_depths(const LineBlock& lines, const SplatTarget& target);

/// Adds the expected crossings of each segment to the texels and layers that it passes: what its pieces, no longer than
/// a texel, cover of a texel. A band wider than a texel is drawn as parallel lines, into the coarsest level in which it is
/// still kBandTexels wide. Integer sums: any order, same bits. Thread-safe where the target is `shared`.
void splat_crossings(const LineBlock& lines, const SplatTarget& target);

}  // namespace pelage
