// Roots of positive numbers by arithmetic alone: loops over them become vector code, and their bits do not depend on the
// machine's math library.
//
// The exponent's bits divided by n, plus what the bias lacks, are a first guess with a few percent of error; a step of
// Halley's method for yⁿ = x multiplies the relative error e by (n² − 1) e² / 12. Two steps reach single precision.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace pelage {

inline constexpr float kRootMaxRelativeError = 4e-7f;     // for 1e-30 ≤ x ≤ 1e30
inline constexpr float kPowerMaxRelativeError = 1.5e-6f;  // where the power is as far from the ends of float

namespace detail {

// float(bits) loses the last seven of them, which a guess does not need.
inline float first_guess(float x, float share, float bias) {
  return std::bit_cast<float>(static_cast<std::int32_t>(static_cast<float>(std::bit_cast<std::int32_t>(x)) * share + bias));
}

}  // namespace detail

inline float cube_root(float x) {
  float y = detail::first_guess(x, 1 / 3.f, 7.099e8f);
  for (int step = 0; step < 2; ++step) {
    const float cube = y * y * y;
    y *= (cube + 2 * x) / (2 * cube + x);
  }
  return x > 0 ? y : 0;
}

inline float fifth_root(float x) {
  float y = detail::first_guess(x, 1 / 5.f, 8.519e8f);
  for (int step = 0; step < 2; ++step) {
    const float fifth = y * y * (y * y) * y;
    y *= (2 * fifth + 3 * x) / (3 * fifth + 2 * x);
  }
  return x > 0 ? y : 0;
}

inline double cube_root(double x) { return std::cbrt(x); }

/// x^0.7
inline float power_7_10(float x) {
  const float y = fifth_root(x);
  return y * y * y * std::sqrt(y);
}
/// x^2.4
inline float power_12_5(float x) {
  const float y = fifth_root(x);
  return x * x * (y * y);
}

}  // namespace pelage
