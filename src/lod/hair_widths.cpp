#include "lod/hair_widths.h"

#include "frame/camera_view.h"
#include "kernel/scalar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lod/hair_widths.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "kernel/wide-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace {

using wide::Float;
using wide::Mask;

constexpr std::size_t kPoints = LodHierarchy::kPoints;

wide::Vec3 load_vectors(const Vec3* v) {
  wide::Vec3 r;
  wide::hn::LoadInterleaved3(wide::kFloatTag, &v->x, r.x.v, r.y.v, r.z.v);
  return r;
}

/// The centers of a hair, its ends twice: k + 1 is control point k.
struct Centers {
  alignas(64) float x[kPoints + 2], y[kPoints + 2], z[kPoints + 2];

  explicit Centers(const Vec3* c) {
    for (std::size_t k = 0; k < kPoints; k += static_cast<std::size_t>(wide::lanes())) {
      const wide::Vec3 v = load_vectors(c + k);
      store(v.x, x + k + 1), store(v.y, y + k + 1), store(v.z, z + k + 1);
    }
    for (float* v : {x, y, z}) v[0] = v[1], v[kPoints + 1] = v[kPoints];
  }
  wide::Vec3 at(std::size_t i) const { return {wide::load(x + i), wide::load(y + i), wide::load(z + i)}; }
};

/// section_extent().width
Float shadow(wide::Vec3 major, wide::Vec3 minor, wide::Vec3 along, wide::Vec3 to_eye) {
  const wide::Vec3 side = cross(along, to_eye);
  const Float sine2 = dot(side, side), limit2 = Float(1e-12f) * dot(along, along) * dot(to_eye, to_eye);
  const Float a = dot(major, side), b = dot(minor, side);
  const Mask seen_from_its_end = !(sine2 > limit2);
  return select(seen_from_its_end, Float(2.f) * sqrt(dot(major, major)), Float(2.f) * sqrt((a * a + b * b) / sine2));
}

/// Of a hair of which a line across meets `crossed` fibers that lean with the variance `lean`. D/W = 1 − e^{−n d/W}, as covered_width() has it for many fibers.
void Errors(const LodHierarchy& lod, std::uint32_t hair, float crossed, float lean, const HairWidths& widths, HairErrors& out) {
  const std::size_t first = std::size_t{hair} * kPoints;
  for (std::size_t k = 0; k < kPoints; k += static_cast<std::size_t>(wide::lanes())) {
    const Float metres = max(wide::load(&widths.metres[k]), Float(1e-9f)), pixels = wide::load(&widths.pixels[k]);
    const Float diameter = Float(2.f) * wide::load(&lod.radii[first + k]);
    const Float covered = Float(1.f) - wide::m_exp(-(diameter * Float(crossed) / metres));
    const Float grain = (covered + Float(kLeanGrain * lean)) * pixels;
    const Float seen = Float(1 / kFinestSeen) - Float(1.f) / max(pixels, Float(1e-9f));
    store(grain * max(seen, Float(0.f)), &out.variance[k]);
  }
}

void Widths(const LodHierarchy& lod, const LodEye& eye, std::uint32_t hair, HairWidths& out) {
  const std::size_t first = std::size_t{hair} * kPoints;
  const Centers centers(&lod.centers[first]);
  for (std::size_t k = 0; k < kPoints; k += static_cast<std::size_t>(wide::lanes())) {
    const wide::Vec3 center = centers.at(k + 1),
                     to_eye = eye.perspective ? wide::Vec3(eye.place) - center : wide::Vec3(eye.place);
    const Float width = shadow(load_vectors(&lod.major[first + k]), load_vectors(&lod.minor[first + k]),
                               centers.at(k + 2) - centers.at(k), to_eye);
    const Float depth = dot(wide::Vec3(eye.forward), center) + Float(eye.depth);
    const Float pixels = width * (eye.perspective ? Float(eye.pixels) / depth : Float(eye.pixels));
    store(width, &out.metres[k]);
    store(select(depth >= Float(eye.near_plane), pixels, Float(INFINITY)), &out.pixels[k]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelage {

HWY_EXPORT(Widths);
HWY_EXPORT(Errors);

LodEye::LodEye(const LodPlace& at)
    : perspective(at.view.perspective), near_plane(at.view.near_plane), pixels(at.view.focal * similarity_scale(at.to_camera)) {
  const Affine to_groom = inverse_of_similarity(at.to_camera);
  place = perspective ? transform_point(to_groom, Vec3()) : transform_vector(to_groom, {0, 0, -1});
  const auto& z = at.to_camera.m[2];
  forward = {z[0], z[1], z[2]}, depth = z[3];
}

HairWidths hair_widths(const LodHierarchy& lod, const LodEye& eye, std::uint32_t hair) {
  HairWidths widths;
  HWY_DYNAMIC_DISPATCH(Widths)(lod, eye, hair, widths);
  return widths;
}

float crossing_ratio(float length_ratio) { return 0.5f * mean_width(std::max(length_ratio, 1.f), 1); }

float direction_variance(float length_ratio) {
  const float cosine = 1 / std::max(length_ratio, 1.f);
  return 0.5f * (1 - cosine * cosine);
}

float covered_width(float band, float fiber, float fibers) {
  if (!(fiber < band)) return (band > 0 ? band : fiber) * std::min(fibers, 1.f);
  if (fibers == 1) return fiber;
  return band * (1 - kernel::m_exp(fibers * kernel::m_log(1 - fiber / band)));
}

HairErrors hair_errors(const LodHierarchy& lod, const LodEye& eye, std::uint32_t hair) {
  const float ratio = lod.length_ratios[hair], fibers = static_cast<float>(lod.hairs[hair].fibers);
  HairErrors errors;
  HWY_DYNAMIC_DISPATCH(Errors)
  (lod, hair, fibers * crossing_ratio(ratio), direction_variance(ratio), hair_widths(lod, eye, hair), errors);
  return errors;
}

}  // namespace pelage
#endif
