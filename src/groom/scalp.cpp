#include "groom/scalp.h"

#include <iterator>

#include "groom/noise.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

struct HairlineKnot {
  float azimuth;  ///< radians from the front
  float height;   ///< metres, y of the hairline
};
// Forehead, temple with its corner, sideburn, arch over the ear, behind the ear, nape.
constexpr HairlineKnot kHairline[] = {{0.00f, 0.071f}, {0.35f, 0.070f}, {0.62f, 0.068f}, {0.85f, 0.050f}, {1.08f, 0.030f},
                                      {1.28f, 0.006f}, {1.42f, -0.004f}, {1.52f, 0.010f}, {1.70f, 0.031f}, {1.90f, 0.022f},
                                      {2.12f, -0.018f}, {2.40f, -0.052f}, {2.75f, -0.068f}, {3.15f, -0.070f}};

float hairline_height(float azimuth) {
  for (std::size_t i = 1; i < std::size(kHairline); ++i) {
    if (azimuth > kHairline[i].azimuth) continue;
    const HairlineKnot a = kHairline[i - 1], b = kHairline[i];
    return mix(a.height, b.height, smoothstep(a.azimuth, b.azimuth, azimuth));
  }
  return std::end(kHairline)[-1].height;
}

constexpr Vec3 kWhorl{-0.012f, 0.104f, -0.058f};

}  // namespace

float hairline_distance(Vec3 p) {
  const float azimuth = std::atan2(std::abs(p.x), p.z + 0.012f);
  const float ragged = 0.004f * noise3(p * 90.f, 11u) + 0.0025f * noise3(p * 300.f, 12u);
  return p.y - hairline_height(azimuth) + ragged;
}

float scalp_density(Vec3 p) {
  if (p.y < -0.09f || std::abs(p.x) > 0.086f) return 0;  // shoulders and the ears' rims
  return smoothstep(-0.001f, 0.009f, hairline_distance(p));
}

Vec3 parting_flow(Vec3 p, Vec3 normal, const Parting& parting) {
  const float side = std::tanh((p.x - parting.x) * parting.sharpness);
  const Vec3 falls(side, -0.5f, -0.42f);
  const Vec3 out = p - kWhorl;
  const Vec3 swirl = cross(normal, out) * 0.5f;
  const Vec3 radial = normalize(Vec3(out.x, 0.6f * out.y, out.z) + swirl);
  const float front = smoothstep(kWhorl.z - 0.01f, kWhorl.z + 0.045f, p.z);
  const Vec3 flow = radial * (1 - front) + falls * front;
  return flow - normal * dot(flow, normal);
}

}  // namespace pelage::groom
