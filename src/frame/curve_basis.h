// The curve of a StrandSet's basis: which kernel formula, how many points a span takes. For code that runs once per strand or
// point; inner loops take the weights from here beforehand.
#pragma once

#include <pelage/strand_set.h>

#include <cstdint>

#include "kernel/scalar.h"

namespace pelage {

/// Control points from the start of one span to the start of the next.
inline std::uint32_t points_per_span(CurveBasis basis) { return basis == CurveBasis::kBezier ? 3 : 1; }

/// Spans of a strand of `points` control points: 0 for fewer than a span needs.
inline std::uint32_t span_count(CurveBasis basis, std::uint32_t points) {
  return points < 2 ? 0 : (points - 1) / points_per_span(basis);
}

/// Weights of the four control points of a span at t ∈ [0, 1] (kernel/curve/bases.h).
inline Vec4 basis_weights(CurveBasis basis, float t) {
  switch (basis) {
    case CurveBasis::kCatmullRom: return kernel::curve_catmull_rom_weights(t);
    case CurveBasis::kBSpline: return kernel::curve_bspline_weights(t);
    case CurveBasis::kBezier: return kernel::curve_bezier_weights(t);
    case CurveBasis::kLinear: break;
  }
  return kernel::curve_linear_weights(t);
}

/// Their derivatives with respect to t.
inline Vec4 basis_derivative(CurveBasis basis, float t) {
  switch (basis) {
    case CurveBasis::kCatmullRom: return kernel::curve_catmull_rom_derivative(t);
    case CurveBasis::kBSpline: return kernel::curve_bspline_derivative(t);
    case CurveBasis::kBezier: return kernel::curve_bezier_derivative(t);
    case CurveBasis::kLinear: break;
  }
  return kernel::curve_linear_derivative(t);
}

}  // namespace pelage
