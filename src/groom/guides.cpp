#include "groom/guides.h"

#include "core/parallel.h"
#include "core/rng.h"
#include "groom/noise.h"
#include "groom/scalp.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

constexpr std::uint32_t kGuideStream = 0x67756964u;

/// How a style leaves the skin and falls; lengths in metres.
struct Fall {
  float lift;         ///< share of the normal in the direction at the root
  float bend_length;  ///< over which gravity turns a strand
  float volume;       ///< distance from the skin that hair from the crown keeps once it has fallen
  float comb_length;  ///< over which the combing direction fades out
};

Fall fall_of(const GrowSettings& s) {
  switch (s.style) {
    case HairStyle::kStraight: return {0.42f, 0.055f, 0.016f, 0.06f};
    case HairStyle::kWavy: return {0.50f, 0.065f, 0.024f, 0.06f};
    case HairStyle::kCurly: return {0.60f, 0.075f, 0.034f, 0.05f};
    case HairStyle::kAfro: return {1.00f, 0.6f, 0.002f, 0.01f};
    case HairStyle::kPonytail: return {0.25f, 0.08f, 0.010f, 0.5f};
    case HairStyle::kCoat: return {0.45f, 0.08f, 0.001f, 0.05f};
  }
  return {};
}

/// Keeps fringe and side hair out of the face: an invisible bulge in front of it.
DistanceSample face_bulge(Vec3 p) {
  const Vec3 center(0, -0.045f, 0.075f), radii(0.064f, 0.112f, 0.060f);
  const Vec3 local = p - center;
  return {sd_ellipsoid(local, radii), local / (radii * radii)};
}

/// Moves `p` out to `clearance` from the skin and out of the face.
Vec3 push_out(const Ground& ground, Vec3 p, float clearance, float bulge) {
  if (!ground.collider) return p;
  const DistanceSample skin = sample_distance(*ground.collider, p);
  if (skin.distance < clearance) p = p + normalize(skin.gradient) * (clearance - skin.distance);
  if (bulge > 0) {
    const DistanceSample face = face_bulge(p);
    if (face.distance < 0) p = p - normalize(face.gradient) * (face.distance * bulge);
  }
  return p;
}

Vec3 combing(const GrowSettings& settings, const Ground& ground, Vec3 p, Vec3 normal) {
  if (ground.scalp) return parting_flow(p, normal, Parting{});
  const Vec3 back(0.2f * noise3(p * 4.f, 5u), -0.55f, -0.8f);
  (void)settings;
  return back - normal * dot(back, normal);
}

void grow_guide(const GrowSettings& settings, const Ground& ground, const Root& root, std::uint32_t id, int points,
                float step, Vec3* out) {
  Rng rng(settings.seed, id, kGuideStream);
  const Fall fall = fall_of(settings);
  const float height = ground.scalp ? saturate((root.position.y + 0.07f) / 0.18f) : 0.5f;
  const float layer = fall.volume * mix(0.15f, 1.f, height) * mix(0.6f, 1.3f, rng.uniform());
  const Vec3 comb = combing(settings, ground, root.position, root.normal);
  Vec3 direction = normalize(root.normal * fall.lift + normalize(comb) * (1 - fall.lift) +
                             noise3_vector(root.position * 40.f, 21u) * 0.08f);
  Vec3 p = root.position;
  out[0] = p;
  for (int i = 1; i < points; ++i) {
    const float s = static_cast<float>(i) * step;
    const float weight = settings.gravity * smoothstep(0.f, fall.bend_length, s);
    direction = normalize(direction + Vec3(0, -1, 0) * (weight * step / fall.bend_length) +
                          noise3_vector(p * 25.f, 31u) * (0.6f * step / fall.bend_length * 0.25f));
    Vec3 next = p + direction * step;
    next = push_out(ground, next, std::min(0.4f * s, 0.0012f + layer * smoothstep(0.f, 0.10f, s)),
                    smoothstep(0.f, 0.04f, s));
    direction = normalize(next - p);
    p = p + direction * step;
    out[i] = p;
  }
}

/// Binomial smoothing that keeps both ends.
void smooth_curve(Vec3* p, int count, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    Vec3 previous = p[0];
    for (int i = 1; i + 1 < count; ++i) {
      const Vec3 here = p[i];
      p[i] = previous * 0.25f + here * 0.5f + p[i + 1] * 0.25f;
      previous = here;
    }
  }
}

/// Frames by the double reflection method (Wang et al. 2008; references.bib: Wang2008Frames).
void rotation_minimizing_frames(const Vec3* p, int count, Vec3 normal, Vec3* side, Vec3* up) {
  const auto tangent = [&](int i) {
    return normalize(i + 1 < count ? p[i + 1] - p[i > 0 ? i - 1 : 0] : p[i] - p[i - 1]);
  };
  Vec3 t = tangent(0);
  Vec3 r = normal - t * dot(normal, t);
  if (dot(r, r) < 1e-6f) r = std::abs(t.x) < 0.9f ? cross(t, Vec3(1, 0, 0)) : cross(t, Vec3(0, 1, 0));
  r = normalize(r);
  for (int i = 0; i < count; ++i) {
    if (i > 0) {
      const Vec3 t1 = tangent(i), v1 = p[i] - p[i - 1];
      const float c1 = std::max(dot(v1, v1), 1e-20f);
      const Vec3 rl = r - v1 * (2 / c1 * dot(v1, r)), tl = t - v1 * (2 / c1 * dot(v1, t));
      const Vec3 v2 = t1 - tl;
      const float c2 = dot(v2, v2);
      r = c2 > 1e-12f ? rl - v2 * (2 / c2 * dot(v2, rl)) : rl;
      r = normalize(r - t1 * dot(r, t1));
      t = t1;
    }
    side[i] = r, up[i] = cross(t, r);
  }
}

}  // namespace

GuideSet grow_guides(const GrowSettings& settings, const Ground& ground, std::size_t count, float guide_length) {
  GuideSet guides;
  guides.points = 96;
  guides.step = guide_length / static_cast<float>(guides.points - 1);
  guides.roots = scatter_roots(*ground.mesh, count, settings.seed ^ 0x5bd1e995u, ground.scalp ? DensityField(scalp_density) : DensityField());
  guides.group.assign(count, 0);
  const std::size_t points = static_cast<std::size_t>(guides.points);
  guides.position.resize(count * points), guides.side.resize(count * points), guides.up.resize(count * points);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Vec3* p = guides.position.data() + g * points;
      grow_guide(settings, ground, guides.roots[g], static_cast<std::uint32_t>(g), guides.points, guides.step, p);
      smooth_curve(p, guides.points, 6);
      rotation_minimizing_frames(p, guides.points, guides.roots[g].normal, guides.side.data() + g * points,
                                 guides.up.data() + g * points);
    }
  });
  return guides;
}

}  // namespace pelage::groom
