// An independent answer to what one smooth dielectric fiber does: rays traced through a cylinder in three dimensions,
// by Snell's law on vectors and Fresnel's equations at every hit. Shares nothing with kernel/scatter; slow and obvious.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace pelage::oracle {

struct V3 {
  double x, y, z;
};
inline V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator*(V3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Unpolarized reflectance; eta is the index behind the surface over the index in front.
inline double reflectance(double cos_i, double eta) {
  const double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const double cos_t = std::sqrt(1 - sin2_t);
  const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t), p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return 0.5 * (s * s + p * p);
}
/// Refracted direction; n is unit length and against d.
inline V3 refract(V3 d, V3 n, double eta) {
  const double cos_i = -dot(d, n), cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
  return d * (1 / eta) + n * (cos_i / eta - cos_t);
}

/// Light that leaves after `order` stretches inside (0 is R, 1 is TT, 2 is TRT, …).
struct Exit {
  double energy;  ///< share of the ray's
  double phi;     ///< azimuth of the exit direction from the direction that light came from, (−π, π]
};

/// Fiber of radius 1 along x. Light from inclination theta (cos_theta > 0), offset h across the fiber in (−1, 1).
template <std::size_t kOrders>
std::array<Exit, kOrders> trace(double cos_theta, double h, double eta, double sigma_a) {
  const double sin_theta = std::sqrt(1 - cos_theta * cos_theta);
  V3 d{-sin_theta, -cos_theta, 0};  // light travels toward −y
  V3 p{0, std::sqrt(1 - h * h), h};
  const auto azimuth = [](V3 w) { return std::atan2(w.z, w.y); };
  std::array<Exit, kOrders> exits{};
  V3 n{0, p.y, p.z};
  const double f = reflectance(-dot(d, n), eta);
  exits[0] = {f, azimuth(d + n * (-2 * dot(d, n)))};
  double energy = 1 - f;
  d = refract(d, n, eta);
  for (std::size_t order = 1; order < kOrders; ++order) {
    const double length = -2 * (p.y * d.y + p.z * d.z) / (d.y * d.y + d.z * d.z);
    p = p + d * length;
    energy *= std::exp(-sigma_a * length);
    n = {0, -p.y, -p.z};  // inward, against d
    const double back = reflectance(-dot(d, n), 1 / eta);
    exits[order] = {energy * (1 - back), back < 1 ? azimuth(refract(d, n, 1 / eta)) : 0};
    energy *= back;
    d = d + n * (-2 * dot(d, n));
  }
  return exits;
}

/// Energy and mean |φ|/π of every order, h by midpoints.
template <std::size_t kOrders>
struct Fiber {
  std::array<double, kOrders> energy{}, forward{}, cos1{}, cos2{};  ///< the last three weighted by energy
};
template <std::size_t kOrders>
Fiber<kOrders> fiber(double cos_theta, double eta, double sigma_a, int offsets = 4000) {
  Fiber<kOrders> sum;
  for (int i = 0; i < offsets; ++i) {
    const double gamma = (i + 0.5) / offsets * std::numbers::pi / 2, w = std::cos(gamma) * std::numbers::pi / 2 / offsets;
    const auto exits = trace<kOrders>(cos_theta, std::sin(gamma), eta, sigma_a);
    for (std::size_t k = 0; k < kOrders; ++k) {
      sum.energy[k] += w * exits[k].energy;
      sum.forward[k] += w * exits[k].energy * std::fabs(exits[k].phi) / std::numbers::pi;
      sum.cos1[k] += w * exits[k].energy * std::cos(exits[k].phi);
      sum.cos2[k] += w * exits[k].energy * std::cos(2 * exits[k].phi);
    }
  }
  return sum;
}

}  // namespace pelage::oracle
