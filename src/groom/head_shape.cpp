#include "groom/head_shape.h"

#include "groom/sdf.h"

namespace pelage::groom {
namespace {

// The shapes below are placed by eye on a head of average adult proportions (height 0.24, breadth 0.155, depth 0.195).
// `q` is the point mirrored to x ≥ 0: the mannequin is symmetric.

float skull(Vec3 q) {
  float d = sd_ellipsoid(q - Vec3(0, 0.030f, -0.012f), {0.0765f, 0.088f, 0.099f});
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0, -0.028f, 0.024f), {0.060f, 0.080f, 0.063f}), 0.03f);
  d = smooth_union(d, sd_capsule(q, {0.050f, -0.045f, 0.004f}, {0.012f, -0.099f, 0.062f}, 0.016f, 0.013f), 0.03f);  // jaw
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0, -0.099f, 0.072f), {0.018f, 0.014f, 0.016f}), 0.02f);                 // chin
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0.030f, -0.052f, 0.055f), {0.026f, 0.032f, 0.026f}), 0.020f);           // cheek
  return smooth_union(d, sd_ellipsoid(q - Vec3(0.043f, -0.020f, 0.060f), {0.020f, 0.013f, 0.018f}), 0.03f);         // cheekbone
}

float eyes(float d, Vec3 q) {
  d = smooth_union(d, sd_capsule(q, {0.010f, 0.0195f, 0.0830f}, {0.050f, 0.018f, 0.060f}, 0.007f, 0.006f), 0.024f);
  d = smooth_difference(d, sd_ellipsoid(q - Vec3(0.032f, 0.003f, 0.0935f), {0.022f, 0.0115f, 0.015f}), 0.016f);
  const float upper_lid = sd_ellipsoid(q - Vec3(0.0315f, 0.0020f, 0.0695f), {0.0175f, 0.0125f, 0.0155f});
  const float lower_lid = sd_ellipsoid(q - Vec3(0.0315f, -0.0065f, 0.0675f), {0.0165f, 0.0105f, 0.0125f});
  d = smooth_union(d, lower_lid, 0.005f);
  d = smooth_union(d, upper_lid, 0.0025f);
  d = smooth_difference(d, sd_capsule(q, {0.0185f, -0.0035f, 0.0800f}, {0.0310f, -0.0070f, 0.0850f}, 0.0012f, 0.0012f), 0.004f);
  return smooth_difference(d, sd_capsule(q, {0.0310f, -0.0070f, 0.0850f}, {0.0450f, -0.0035f, 0.0780f}, 0.0012f, 0.0012f),
                           0.004f);
}

float nose(float d, Vec3 q) {
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0, -0.026f, 0.080f), {0.016f, 0.028f, 0.018f}), 0.012f);
  float n = sd_capsule(q, {0, 0.014f, 0.0855f}, {0, -0.030f, 0.1065f}, 0.0060f, 0.0080f);
  n = smooth_union(n, sd_ellipsoid(q - Vec3(0, -0.034f, 0.1070f), {0.0095f, 0.0085f, 0.0090f}), 0.008f);
  n = smooth_union(n, sd_ellipsoid(q - Vec3(0.0115f, -0.038f, 0.0965f), {0.0065f, 0.0070f, 0.0100f}), 0.007f);
  d = smooth_union(d, n, 0.010f);
  return smooth_difference(d, sd_ellipsoid(q - Vec3(0.0068f, -0.0465f, 0.1020f), {0.0030f, 0.0034f, 0.0050f}), 0.005f);
}

float mouth(float d, Vec3 q) {
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0, -0.068f, 0.0675f), {0.032f, 0.026f, 0.022f}), 0.016f);
  const float upper = sd_capsule(q, {0.0015f, -0.0648f, 0.0932f}, {0.0230f, -0.0705f, 0.0835f}, 0.0048f, 0.0022f);
  const float lower = sd_capsule(q, {0.0000f, -0.0755f, 0.0920f}, {0.0210f, -0.0720f, 0.0832f}, 0.0056f, 0.0022f);
  d = smooth_union(d, lower, 0.006f);
  d = smooth_union(d, upper, 0.003f);
  d = smooth_difference(d, sd_capsule(q, {0, -0.0500f, 0.0985f}, {0, -0.0570f, 0.0995f}, 0.0022f, 0.0022f), 0.006f);
  return smooth_difference(d, sd_ellipsoid(q - Vec3(0, -0.0870f, 0.0975f), {0.018f, 0.0045f, 0.006f}), 0.012f);
}

float ear(float d, Vec3 q) {
  // In the ear's frame: x away from the head, y up and slightly back, z forward.
  const Vec3 o = q - Vec3(0.0790f, -0.012f, -0.012f);
  const float c = 0.966f, s = 0.259f, cy = 0.906f, sy = 0.423f;
  const Vec3 tilted(o.x, c * o.y - s * o.z, s * o.y + c * o.z);
  const Vec3 p(cy * tilted.x + sy * tilted.z, tilted.y, -sy * tilted.x + cy * tilted.z);
  float e = sd_ellipsoid(p, {0.0085f, 0.031f, 0.0180f});
  e = smooth_union(e, sd_ellipsoid(p - Vec3(0, -0.024f, 0.004f), {0.006f, 0.010f, 0.009f}), 0.008f);
  e = smooth_difference(e, sd_ellipsoid(p - Vec3(0.0085f, 0.003f, 0.002f), {0.0070f, 0.0200f, 0.0100f}), 0.005f);
  return smooth_union(d, e, 0.012f);
}

float bust(Vec3 q) {
  float d = sd_capsule(q, {0, -0.060f, -0.022f}, {0, -0.185f, -0.030f}, 0.052f, 0.056f);
  d = smooth_union(d, sd_capsule(q, {0.038f, -0.060f, -0.012f}, {0.012f, -0.175f, 0.020f}, 0.013f, 0.012f), 0.02f);
  d = smooth_union(d, sd_capsule(q, {0.01f, -0.178f, -0.042f}, {0.145f, -0.222f, -0.035f}, 0.032f, 0.042f), 0.05f);
  d = smooth_union(d, sd_ellipsoid(q - Vec3(0, -0.270f, -0.025f), {0.165f, 0.085f, 0.085f}), 0.05f);
  d = smooth_union(d, sd_capsule(q, {0.018f, -0.200f, 0.036f}, {0.13f, -0.196f, 0.000f}, 0.007f, 0.006f), 0.018f);
  return smooth_intersection(d, sd_ellipsoid(q - Vec3(0, -0.140f, -0.03f), {0.200f, 0.145f, 0.115f}), 0.03f);
}

}  // namespace

float head_distance(Vec3 p) {
  const Vec3 q(std::abs(p.x), p.y, p.z);
  float d = skull(q);
  d = eyes(d, q);
  d = nose(d, q);
  d = mouth(d, q);
  d = smooth_union(d, bust(q), 0.022f);
  return ear(d, q);
}

Vec3 head_normal(Vec3 p) {
  // Tetrahedral differences: four evaluations instead of six, same order.
  constexpr float h = 4e-4f;
  constexpr Vec3 k[4] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
  Vec3 sum;
  for (const Vec3 direction : k) sum = sum + direction * head_distance(p + direction * h);
  return normalize(sum);
}

Vec2 head_uv(Vec3 p) {
  const Vec3 d = normalize(p - Vec3(0, 0.01f, -0.012f));
  const float polar = std::acos(std::clamp(d.y, -1.f, 1.f)) * (1 / 3.14159265f);
  const float ring = std::sqrt(d.x * d.x + d.z * d.z);
  if (ring <= 0) return {0.5f, 0.5f};
  return {0.5f + 0.5f * polar * d.x / ring, 0.5f - 0.5f * polar * d.z / ring};
}

}  // namespace pelage::groom
