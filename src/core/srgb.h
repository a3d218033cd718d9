// The sRGB transfer curve (IEC 61966-2-1).
#pragma once

#include <cmath>

#include "core/roots.h"

namespace pelage {

inline float srgb_to_linear(float x) {
  const float power = power_12_5((x + 0.055f) / 1.055f);
  return x <= 0.04045f ? x / 12.92f : power;
}
inline float linear_to_srgb(float x) { return x <= 0.0031308f ? x * 12.92f : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f; }

}  // namespace pelage
