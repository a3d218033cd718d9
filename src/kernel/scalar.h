// Scalar C++ target of the shared kernel source: Float is float. Includes every kernel header, once.
// The subset and its rules: HACKING.md, "One formula, three targets".
#pragma once

#include <pelage/vec.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#define PELAGE_FN inline
#define PELAGE_EXACT  // GLSL compilers need telling; here -ffp-contract=off says it for all

namespace pelage::kernel {

using Float = float;
using Mask = bool;
using pelage::Vec2;
using pelage::Vec3;
using pelage::Vec4;

inline Float select(Mask m, Float a, Float b) { return m ? a : b; }
inline Vec2 select(Mask m, Vec2 a, Vec2 b) { return m ? a : b; }
inline Vec3 select(Mask m, Vec3 a, Vec3 b) { return m ? a : b; }
// As the SIMD instructions: the second operand where either is NaN.
inline Float min(Float a, Float b) { return a < b ? a : b; }
inline Float max(Float a, Float b) { return a > b ? a : b; }
inline Float abs(Float a) { return std::fabs(a); }
inline Float sqrt(Float a) { return std::sqrt(a); }
inline Float floor(Float a) { return std::floor(a); }
inline Float ceil(Float a) { return std::ceil(a); }
/// 2^n for whole n in [−126, 127].
inline Float pow2i(Float n) { return std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23); }
/// e with 2^e ≤ x < 2^(e+1), as a Float; x a positive normal number.
inline Float exponent_of(Float x) {
  return static_cast<float>(static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(x) >> 23) - 127);
}
/// x·2^−exponent_of(x), in [1, 2).
inline Float mantissa_of(Float x) {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(x) & 0x007fffffu) | 0x3f800000u);
}

using pelage::cross;
using pelage::dot;

#include "kernel/kernels.inc"

}  // namespace pelage::kernel

#undef PELAGE_EXACT
#undef PELAGE_FN
