// The sRGB transfer curve (IEC 61966-2-1), exact.
#pragma once

#include <cmath>

namespace pelage {

inline float srgb_to_linear(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }
inline float linear_to_srgb(float x) { return x <= 0.0031308f ? x * 12.92f : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f; }

}  // namespace pelage
