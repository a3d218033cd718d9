// The color spaces of FLIP: linear Rec. 709 → XYZ → YCxCz (where the eye's blur is applied) and CIELAB (where colors are
// told apart).
//
// The matrix is made from its definition: the primaries' chromaticities (ITU-R BT.709) as columns, scaled so that R = G = B = 1
// is the white of D65 at luminance 1. XYZ are divided by that white, so a neutral color has X = Y = Z.
#pragma once

#include <array>
#include <cmath>

#include "core/roots.h"

namespace pelage::metrics {

using Matrix3 = std::array<std::array<double, 3>, 3>;  // rows

constexpr Matrix3 inverse(const Matrix3& m) {
  Matrix3 cofactors{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      cofactors[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
    }
  const double determinant = m[0][0] * cofactors[0][0] + m[0][1] * cofactors[0][1] + m[0][2] * cofactors[0][2];
  Matrix3 out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out[i][j] = cofactors[j][i] / determinant;
  return out;
}

// Linear Rec. 709 → X/Xn, Y/Yn, Z/Zn.
constexpr Matrix3 make_rgb_to_xyz() {
  struct Chromaticity {
    double x, y;
  };
  constexpr Chromaticity kPrimaries[] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}}, kWhite{0.31271, 0.32902};  // CIE D65, 2°
  constexpr auto xyz = [](Chromaticity c) { return std::array{c.x / c.y, 1.0, (1 - c.x - c.y) / c.y}; };
  Matrix3 columns{};
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t i = 0; i < 3; ++i) columns[i][p] = xyz(kPrimaries[p])[i];
  const Matrix3 solve = inverse(columns);
  const std::array<double, 3> white = xyz(kWhite);
  Matrix3 m{};
  for (std::size_t p = 0; p < 3; ++p) {
    const double luminance = solve[p][0] * white[0] + solve[p][1] * white[1] + solve[p][2] * white[2];
    for (std::size_t i = 0; i < 3; ++i) m[i][p] = columns[i][p] * luminance / white[i];
  }
  return m;
}

inline constexpr Matrix3 kRgbToXyz = make_rgb_to_xyz();
inline constexpr Matrix3 kXyzToRgb = inverse(kRgbToXyz);

// Always inlined: loops over these functions become vector code.

/// A color as numbers of type T: float where it is fast, double where it is the slow reference.
template <class T>
using Color = std::array<T, 3>;

template <class T>
[[gnu::always_inline]] inline Color<T> transform(const Matrix3& m, const Color<T>& c) {
  Color<T> out;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = static_cast<T>(m[i][0]) * c[0] + static_cast<T>(m[i][1]) * c[1] + static_cast<T>(m[i][2]) * c[2];
  return out;
}

// YCxCz (references.bib: Zhang1997SCielab, Andersson2020Flip, section 4.1): Y' = 116 Y − 16, Cx = 500 (X − Y), Cz = 200 (Y − Z).
template <class T>
[[gnu::always_inline]] inline Color<T> xyz_to_opponent(const Color<T>& c) {
  return {116 * c[1] - 16, 500 * (c[0] - c[1]), 200 * (c[1] - c[2])};
}
template <class T>
[[gnu::always_inline]] inline T opponent_luminance(T y) {
  return (y + 16) / 116;
}
template <class T>
[[gnu::always_inline]] inline Color<T> opponent_to_xyz(const Color<T>& c) {
  const T y = opponent_luminance(c[0]);
  return {y + c[1] / 500, y, y - c[2] / 200};
}

// CIELAB (CIE 15): its curve is the cube root with a linear start.
template <class T>
[[gnu::always_inline]] inline T lab_curve(T t) {
  constexpr T delta = T(6) / 29;
  return t > delta * delta * delta ? cube_root(t) : t / (3 * delta * delta) + T(4) / 29;
}

}  // namespace pelage::metrics
