#include "raster/coat.h"

#include <algorithm>
#include <cmath>

#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kLeastCosine = 1e-3f, kLeastAlpha = 1e-2f;
constexpr int kRings = 24, kAround = 24;

/// Half vectors are spread as GGX has them, Walter 2007, eq. 35 (references.bib: Walter2007Microfacet); the other half of the
/// circle around the plane of the eye is the same.
float integral(float cos_eye, float f0, float alpha) {
  const Vec3 normal{0, 0, 1}, to_eye{std::sqrt(1 - cos_eye * cos_eye), 0, cos_eye};
  float sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      const float u = (static_cast<float>(i) + 0.5f) / kRings, phi = (static_cast<float>(j) + 0.5f) / kAround * kPi;
      const float cosine = std::sqrt((1 - u) / (1 - u + alpha * alpha * u)), sine = std::sqrt(1 - cosine * cosine);
      const Vec3 half{sine * std::cos(phi), sine * std::sin(phi), cosine};
      const float toward = dot(to_eye, half);
      if (!(toward > 0)) continue;
      const Vec3 to_light = half * (2 * toward) - to_eye;
      const float q = cosine * cosine * (alpha * alpha - 1) + 1, density = alpha * alpha * cosine / (kPi * q * q * 4 * toward);
      sum += kernel::shade_ggx(normal, to_eye, to_light, f0, alpha) / density;
    }
  return sum / (kRings * kAround);
}

}  // namespace

CoatAlbedo::CoatAlbedo(float f0, float alpha) {
  for (std::size_t i = 0; i <= kCells; ++i)
    values_[i] = integral(std::max(static_cast<float>(i) / kCells, kLeastCosine), f0, std::max(alpha, kLeastAlpha));
}

float CoatAlbedo::seen_from(float cos_eye) const {
  const float at = std::clamp(cos_eye, 0.f, 1.f) * kCells;
  const std::size_t cell = std::min(static_cast<std::size_t>(at), kCells - 1);
  return values_[cell] + (values_[cell + 1] - values_[cell]) * (at - static_cast<float>(cell));
}

}  // namespace pelage
