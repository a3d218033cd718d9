#include "groom/guides.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/rng.h"
#include "groom/collide.h"
#include "groom/frames.h"
#include "groom/noise.h"
#include "groom/point_grid.h"
#include "groom/scalp.h"

namespace pelage::groom {
namespace {

constexpr std::uint32_t kRootStream = 0x5bd1e995u, kGuideStream = 0x67756964u, kGatherStream = 0x67617468u;
constexpr Vec3 kDown(0, -1, 0);
constexpr Vec3 kTie(0, 0.058f, -0.122f);  // where a ponytail is tied, just behind the back of the head
constexpr float kTieRadius = 0.008f;

/// How a style leaves the skin and falls.
struct Fall {
  float lift;         ///< share of the normal in the direction at the root
  float bend_length;  ///< metres over which gravity turns a strand
  float wander;       ///< strength of the large-scale noise along a guide
};

Fall fall_of(HairStyle style) {
  switch (style) {
    case HairStyle::kStraight: return {0.34f, 0.050f, 0.12f};
    case HairStyle::kWavy: return {0.38f, 0.055f, 0.22f};
    case HairStyle::kCurly: return {0.42f, 0.060f, 0.45f};
    case HairStyle::kAfro: return {0.30f, 0.060f, 0.20f};
    case HairStyle::kPonytail: return {0.20f, 0.045f, 0.10f};
    case HairStyle::kCoat: return {0.45f, 0.080f, 0.30f};
  }
  return {};
}

/// Hair that comes down on a shoulder goes in front of it or behind: the pull there along z, −1…1.
float shoulder_pull(Vec3 p, bool front) {
  const float near_shoulder = smoothstep(-0.07f, -0.14f, p.y) * smoothstep(0.03f, 0.06f, std::abs(p.x));
  return near_shoulder * (front ? smoothstep(0.06f, 0.03f, p.z) : -smoothstep(-0.105f, -0.06f, p.z));
}

/// Side hair is swept back beside the face: the pull along −z, 0…1, on hair that hangs ahead of the temples.
float sweep_back(Vec3 p) {
  return smoothstep(0.04f, 0.085f, p.z) * smoothstep(0.09f, 0.05f, p.y) * smoothstep(-0.17f, -0.11f, p.y);
}

class GuideGrower {
 public:
  GuideGrower(const GrowSettings& settings, const Ground& ground, int points, float step)
      : s_(settings), ground_(ground), fall_(fall_of(settings.style)), points_(points), step_(step) {}

  /// Writes the points of guide `id`; returns the arc length at the tie, 0 without one.
  float grow(const Root& root, std::uint32_t id, Vec3* out) const {
    Rng rng(s_.seed, id, kGuideStream);
    const bool tied = ground_.scalp && s_.style == HairStyle::kPonytail;
    return tied ? grow_tied(root, rng, out) : (grow_hanging(root, rng, out), 0.f);
  }

 private:
  Vec3 first_direction(const Root& root) const {
    return normalize(root.normal * fall_.lift + normalize(combing(s_, ground_, root)) * (1 - fall_.lift) +
                     noise3_vector(root.position * 40.f, 21u) * 0.08f);
  }

  /// Gravity takes over from the first direction; the skin, the face and the shoulders turn the strand aside.
  void grow_hanging(const Root& root, Rng& rng, Vec3* out) const {
    const float height = ground_.scalp ? saturate((root.position.y + 0.07f) / 0.18f) : 0.5f;
    const float layer = s_.volume * mix(0.15f, 1.f, height) * mix(0.6f, 1.3f, rng.uniform());
    const bool front = root.position.z + 0.03f * noise3(root.position * 15.f, 41u) > 0.025f;
    const float turn = step_ / fall_.bend_length;
    Vec3 direction = first_direction(root), p = root.position;
    out[0] = p;
    for (int i = 1; i < points_; ++i) {
      const float s = static_cast<float>(i) * step_;
      const Vec3 pull =
          kDown * (s_.gravity * smoothstep(0.f, fall_.bend_length, s)) + noise3_vector(p * 25.f, 31u) * fall_.wander;
      direction = normalize(direction + pull * turn);
      if (ground_.scalp)
        direction = normalize(direction + Vec3(0, 0, step_) * (shoulder_pull(p, front) / 0.035f - sweep_back(p) / 0.03f));
      Vec3 next = p + direction * step_;
      const float clearance = std::min(0.4f * s, 0.0012f + layer * smoothstep(0.f, 0.10f, s));
      next = ground_.collider ? push_out(*ground_.collider, next, clearance)
                              : keep_above(root.position, root.normal, ground_.size, next, clearance);
      if (ground_.scalp) next = push_out_of_face(next, smoothstep(0.f, 0.04f, s));
      direction = normalize(next - p);
      p = p + direction * step_;
      out[i] = p;
    }
  }

  /// Combed tight over the skin to the tie, through it, and down as a tail.
  float grow_tied(const Root& root, Rng& rng, Vec3* out) const {
    // A strand passes the tie on the side from which it comes, so that the tail is round and nothing crosses.
    const Vec3 from = root.position - kTie;
    const Vec3 around = normalize(Vec3(from.x, from.y, 0) + Vec3(1e-6f, 0, 0));
    const Vec3 gate = kTie + around * (kTieRadius * mix(0.3f, 1.f, rng.uniform()));
    const float layer = 0.0008f + 0.25f * s_.volume * rng.uniform();
    const Vec3 axis = normalize(Vec3(0, 0.35f, -1) + around * mix(0.1f, 0.45f, rng.uniform()));
    Vec3 p = root.position, direction = normalize(root.normal * fall_.lift + normalize(gate - p) * (1 - fall_.lift));
    float tie = 0;
    out[0] = p;
    for (int i = 1; i < points_; ++i) {
      const float s = static_cast<float>(i) * step_;
      if (tie == 0 && length(gate - p) < 1.5f * step_) tie = s;
      if (tie == 0) {
        direction = normalize(direction * 0.4f + normalize(gate - p));
      } else {
        const float hung = s - tie, out_of_tie = smoothstep(0.035f, 0.f, hung);
        direction = normalize(
            direction + axis * (out_of_tie * step_ / 0.006f) +
            (kDown * (s_.gravity * smoothstep(0.f, fall_.bend_length, hung)) + noise3_vector(p * 25.f, 31u) * fall_.wander) *
                (step_ / fall_.bend_length));
      }
      const Vec3 next = push_out(*ground_.collider, p + direction * step_, std::min(0.4f * s, layer));
      direction = normalize(next - p);
      p = p + direction * step_;
      out[i] = p;
    }
    return tie;
  }

  const GrowSettings& s_;
  const Ground& ground_;
  Fall fall_;
  int points_;
  float step_;
};

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

/// Draws every guide toward the guide of its big lock, the nearest of the first `locks` guides that heads its way.
void gather_into_locks(GuideSet& guides, std::size_t locks, const GrowSettings& settings) {
  const std::size_t n = static_cast<std::size_t>(guides.points);
  PointGrid grid(typical_spacing(guides.roots, locks), locks);
  for (std::size_t i = 0; i < locks; ++i) grid.insert(guides.roots[i].position);
  const auto heading = [&](std::size_t g) { return normalize(guides.position[g * n + n / 4] - guides.position[g * n]); };
  parallel_for(guides.count() - locks, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = locks + begin; g < locks + end; ++g) {
      std::uint32_t lock;
      float d2;
      grid.nearest(guides.roots[g].position, 1, &lock, &d2);
      if (dot(heading(g), heading(lock)) < 0.8f) continue;
      Rng rng(settings.seed, static_cast<std::uint32_t>(g), kGatherStream);
      const float strength = settings.clump_tightness * mix(0.2f, 0.9f, rng.uniform());
      const Vec3* center = guides.position.data() + lock * n;
      Vec3* p = guides.position.data() + g * n;
      for (std::size_t i = 1; i < n; ++i)
        p[i] = lerp(p[i], center[i], strength * smoothstep(0.1f, 1.f, static_cast<float>(i) / static_cast<float>(n - 1)));
    }
  });
}

}  // namespace

DensityField Ground::density() const { return scalp ? DensityField(scalp_density) : DensityField(); }

Vec3 combing(const GrowSettings& settings, const Ground& ground, const Root& root) {
  const auto tangential = [&root](Vec3 v) { return v - root.normal * dot(v, root.normal); };
  if (!ground.scalp)  // backward and down, with lazy eddies
    return tangential(Vec3(0, -0.6f, -0.8f) + noise3_vector(root.position * (3 / ground.size), 5u) * 0.9f);
  switch (settings.style) {
    case HairStyle::kAfro: return root.position - Vec3(0, 0.045f, -0.012f);
    case HairStyle::kPonytail: return tangential(kTie - root.position);
    case HairStyle::kCoat: return whorl_flow(root.position, root.normal);
    default: return parting_flow(root.position, root.normal, settings.parting);
  }
}

GuideSet grow_guides(const GrowSettings& settings, const Ground& ground, std::size_t count, float guide_length) {
  GuideSet guides;
  guides.points = settings.style == HairStyle::kCoat ? 24 : 96;
  guides.step = guide_length / static_cast<float>(guides.points - 1);
  guides.roots = scatter_roots(*ground.mesh, count, settings.seed ^ kRootStream, ground.density());
  const std::size_t points = static_cast<std::size_t>(guides.points);
  guides.tie.resize(count);
  guides.position.resize(count * points), guides.side.resize(count * points), guides.up.resize(count * points);

  const GuideGrower grower(settings, ground, guides.points, guides.step);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Vec3* p = guides.position.data() + g * points;
      guides.tie[g] = grower.grow(guides.roots[g], static_cast<std::uint32_t>(g), p);
      smooth_curve(p, guides.points, 6);
    }
  });
  const bool tied = ground.scalp && settings.style == HairStyle::kPonytail;
  if (!tied && settings.style != HairStyle::kAfro) gather_into_locks(guides, (count + 7) / 8, settings);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      rotation_minimizing_frames(guides.position.data() + g * points, guides.points, guides.roots[g].normal,
                                 guides.side.data() + g * points, guides.up.data() + g * points);
  });
  return guides;
}

}  // namespace pelage::groom
