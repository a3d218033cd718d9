// The innermost loop of the reconnection filter: a pixel's neighbors, many at a time.
#pragma once

#include <pelage/vec.h>

#include <cstddef>
#include <cstdint>

namespace pelage {

/// Neighbors under the kernel for one direction of the strand; `count` is a multiple of kLanes.
struct ReconnectTaps {
  static constexpr std::size_t kLanes = 16;
  std::size_t count;
  const std::int32_t* offset;  ///< in pixels of the padded picture
  const float* along;          ///< d∥, pixels: along the strand, to the right or straight down
  const float* weight;         ///< spatial term of Lipp 2026, eq. 10
};

inline constexpr float kNoDepth = 1e30f;  ///< of pixels without a hit: no neighbor is as deep

/// Of pixels without a hit in which the opaque scene stands at `share` of the hair's depth range, 0…1: below 0.
constexpr float opaque_tap(float share) { return -1 - share; }

/// Where the pixel in the middle stands in the layers of a padded picture: depth that neighbors are compared by, 0…1; kNoDepth or
/// opaque_tap() where the center is not hit; and color.
struct ReconnectPixels {
  const float *depth, *r, *g, *b;
};

/// The strand that is gathered for: neighbors count within `tolerance` of depth + slope·d∥; color_scale: 1/σ_c², 0 without that
/// term.
struct ReconnectStrand {
  float depth, slope, tolerance, color_scale;
};

struct TapSums {
  Vec4 alike;  ///< Σ w·(r, g, b, 1) over the neighbors that count: eq. 10
  float hits;  ///< Σ of the spatial terms of neighbors whose centers are hit, whatever their depth
  float seen;  ///< that of all in which the opaque scene does not hide the strand; the same as hits where all are hit
};

/// e^−x of the color's term is 1/(1 + x + x²/2 + x³/6), too large by 0.028 at most, at x = 3. Sums are made in kLanes parts, so
/// every instruction set gives the same bits.
TapSums sum_taps(const ReconnectTaps& taps, const ReconnectPixels& middle, const ReconnectStrand& strand);

}  // namespace pelage
