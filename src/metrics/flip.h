// FLIP, the difference that a person sees when two pictures alternate on a screen (references.bib: Andersson2020Flip).
//
// Color. Both pictures are blurred as the eye blurs each channel of the opponent space YCxCz at the given number of pixels per
// degree, brought to CIELAB with chroma scaled by lightness (the Hunt effect), and told apart by the HyAB distance
// |ΔL| + √(Δa² + Δb²), raised to 0.7 and mapped to 0…1 so that most of the range is kept for what is seen at once.
// Feature. Edges and points are found by first and second derivatives of a Gaussian in the achromatic channel, as wide as
// the eye's own detectors. Where one picture has them and the other has not, the color error is raised: E = Ec^(1 − Ef).
#pragma once

#include <pelage/image.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "metrics/color_space.h"

namespace pelage::metrics {

// The eye's contrast sensitivity as sums of two Gaussians a √(π/b) exp(−π² x² / b), x in degrees (Andersson 2020, table 1).
struct Sensitivity {
  double a1, b1, a2, b2;
};
inline constexpr std::array<Sensitivity, 3> kSensitivities{{
    {1.0, 0.0047, 0.0, 1e-5},   // achromatic
    {1.0, 0.0053, 0.0, 1e-5},   // red–green
    {34.1, 0.04, 13.5, 0.025},  // blue–yellow
}};
inline constexpr double kWidestB = 0.04;

// Error compression (Andersson 2020, section 4.1.3): exponent, and the share pc of the largest error that maps to pt.
inline constexpr double kColorExponent = 0.7, kBendAt = 0.4, kBendTo = 0.95;
// Features (section 4.2): the detectors' width in degrees, and the exponent of their difference.
inline constexpr double kFeatureDegrees = 0.082, kFeatureExponent = 0.5;

/// Gaussians of three standard deviations: the blur's radius is that of the widest, for every channel.
inline int blur_radius(double pixels_per_degree) {
  const double sigma = std::sqrt(kWidestB / (2 * std::numbers::pi * std::numbers::pi));
  return static_cast<int>(std::ceil(3 * sigma * pixels_per_degree));
}
inline double feature_sigma(double pixels_per_degree) { return 0.5 * kFeatureDegrees * pixels_per_degree; }
inline int feature_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3 * feature_sigma(pixels_per_degree)));
}

template <class T>
struct HuntLab {
  T lightness, a, b;
};

/// CIELAB of X/Xn, Y/Yn, Z/Zn, its chroma times L/100.
template <class T>
[[gnu::always_inline]] inline HuntLab<T> hunt_lab(const Color<T>& xyz) {
  const T x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
  const T lightness = 116 * y - 16, hunt = T(0.01) * lightness;
  return {lightness, hunt * (500 * (x - y)), hunt * (200 * (y - z))};
}

/// HyAB, for large color differences (references.bib: Abasi2020Distance).
template <class T>
[[gnu::always_inline]] inline T hyab(const HuntLab<T>& s, const HuntLab<T>& t) {
  const T da = s.a - t.a, db = s.b - t.b;
  return std::abs(s.lightness - t.lightness) + std::sqrt(da * da + db * db);
}

/// The largest HyAB^0.7 that Rec. 709 has: between its green and its blue.
inline double largest_color_error() {
  const auto lab = [](const Color<double>& rgb) { return hunt_lab(transform(kRgbToXyz, rgb)); };
  return std::pow(hyab(lab({0, 1, 0}), lab({0, 0, 1})), kColorExponent);
}

/// Color error 0…1 of HyAB^0.7 (section 4.1.3): linear to pt at pc of the largest, linear from there to 1.
template <class T>
[[gnu::always_inline]] inline T spread_color_error(T error, T largest) {
  const T bend = T(kBendAt) * largest;
  const T above = T(kBendTo) + (error - bend) / (largest - bend) * T(1 - kBendTo);
  return error < bend ? T(kBendTo) / bend * error : above;
}

/// A picture of linear Rec. 709 0…1 in YCxCz, the three as channels.
Image flip_opponent(const Image& linear);

/// The error per pixel of two pictures in YCxCz, where it is above what `error` holds. O(pixels · pixels per degree).
void raise_to_flip(const Image& test, const Image& reference, float pixels_per_degree, Image& error);

}  // namespace pelage::metrics
