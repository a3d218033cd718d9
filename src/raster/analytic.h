// Units of the analytic coverage layer of a GBuffer, and how to read it.
//
// Segments of one strand add up inside a pixel, to at most 1; different strands are independent, so transmittances
// multiply: the layer holds Σ −log(1 − a) in fixed point, which integer atomics sum in any order.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "frame/frame.h"

namespace pelage {

inline constexpr float kOpticalDepthUnit = GBuffer::kCoverageUnit;  ///< analytic_coverage() reads it
inline constexpr float kAreaUnit = 0x1p-14f;          ///< of GBuffer::tangent_cos2 and tangent_sin2

/// Screen direction of the hair in a pixel, by double angles: unit length; (1, 0) where there is none.
inline Vec2 analytic_tangent(const GBuffer& g, std::size_t pixel) {
  const float angle = 0.5f * std::atan2(static_cast<float>(g.tangent_sin2[pixel]), static_cast<float>(g.tangent_cos2[pixel]));
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace pelage
