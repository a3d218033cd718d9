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
constexpr HairlineKnot kHairline[] = {{0.00f, 0.071f},  {0.35f, 0.070f},  {0.62f, 0.068f},  {0.85f, 0.050f}, {1.08f, 0.030f},
                                      {1.28f, 0.006f},  {1.42f, -0.004f}, {1.52f, 0.010f},  {1.70f, 0.031f}, {1.90f, 0.022f},
                                      {2.12f, -0.018f}, {2.40f, -0.052f}, {2.75f, -0.068f}, {3.15f, -0.070f}};

constexpr Vec3 kWhorl{-0.010f, 0, -0.050f};  // end of the parting at the crown, from above
constexpr float kPartingFront = 0.140f;      // z of its other end, beyond the hairline, so that nothing fans out there

}  // namespace

float hairline_height(float azimuth) {
  for (std::size_t i = 1; i < std::size(kHairline); ++i) {
    if (azimuth > kHairline[i].azimuth) continue;
    const HairlineKnot a = kHairline[i - 1], b = kHairline[i];
    return mix(a.height, b.height, smoothstep(a.azimuth, b.azimuth, azimuth));
  }
  return std::end(kHairline)[-1].height;
}

float hairline_distance(Vec3 p) {
  const float azimuth = std::atan2(std::abs(p.x), p.z - kHeadAxis.z);
  const float ragged = 0.004f * noise3(p * 90.f, 11u) + 0.0025f * noise3(p * 300.f, 12u);
  return p.y - hairline_height(azimuth) + ragged;
}

float scalp_density(Vec3 p) {
  if (p.y < -0.09f || std::abs(p.x) > 0.086f) return 0;  // shoulders and the ears' rims
  return smoothstep(-0.001f, 0.009f, hairline_distance(p));
}

Vec3 parting_flow(Vec3 p, Vec3 normal, float parting_x) {
  // Seen from above: away from the nearest place of the parting, sideways along it and like a fan around its end, the
  // whorl. Downward where the skin is steep.
  const Vec3 front(parting_x, 0, kPartingFront), whorl(kWhorl.x + 0.5f * parting_x, 0, kWhorl.z);
  const Vec3 flat(p.x, 0, p.z), line = whorl - front;
  const float t = saturate(dot(flat - front, line) / dot(line, line));
  const Vec3 away = normalize(flat - (front + line * t));
  const float swirl = 0.5f * smoothstep(0.7f, 1.f, t) * smoothstep(0.07f, 0.03f, length(flat - whorl));
  const Vec3 flow = away + cross(normal, away) * swirl + Vec3(0, -0.8f, -0.8f * (1 - t));
  return flow - normal * dot(flow, normal);
}

Vec3 whorl_flow(Vec3 p, Vec3 normal) {
  const Vec3 out = normalize(Vec3(p.x - kWhorl.x, 0, p.z - kWhorl.z));
  const float swirl = mix(1.2f, 0.2f, smoothstep(0.f, 0.06f, length(Vec3(p.x - kWhorl.x, 0, p.z - kWhorl.z))));
  const Vec3 flow = out + cross(normal, out) * swirl + Vec3(0, -0.8f, 0);
  return flow - normal * dot(flow, normal);
}

}  // namespace pelage::groom
