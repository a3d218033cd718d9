#include "groom/strands.h"

#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/rng.h"
#include "groom/collide.h"
#include "groom/hierarchy.h"
#include "groom/noise.h"
#include "groom/scalp.h"

namespace pelage::groom {
namespace {

constexpr float kTwoPi = 6.28318531f;
constexpr std::uint32_t kLockStream = 0x6c6f636bu, kTuftStream = 0x74756674u, kStrandStream = 0x7374726eu;
constexpr int kTuftSize = 14;
constexpr float kWoolLength = 0.55f, kWoolWidth = 0.6f;  // of the guard hairs'

/// What tells the styles' strands apart beyond the public settings.
struct StrandStyle {
  float ellipticity;   ///< of the curl's cross-section: 1 helix, 0 flat wave
  float phase_spread;  ///< radians, standard deviation of the curl's phase between the tufts of a lock
  float tuft;          ///< how far a tuft gathers whatever the lock does, 0…1
  float lock_share;    ///< share of the length's variance that a lock has in common
  float curl_start;    ///< share of the strand over which the curl grows to its radius
  float fade;          ///< metres above the hairline over which hair reaches its length; 0 none
};

StrandStyle style_of(HairStyle style) {
  switch (style) {
    case HairStyle::kStraight: return {0, 0, 0.3f, 0.5f, 0.2f, 0};
    case HairStyle::kWavy: return {0.35f, 0.4f, 0.4f, 0.5f, 0.25f, 0};
    case HairStyle::kCurly: return {1, 0.35f, 0.5f, 0.5f, 0.2f, 0};
    case HairStyle::kAfro: return {1, 0.4f, 0.85f, 0.1f, 0.1f, 0.035f};
    case HairStyle::kPonytail: return {0.4f, 0.5f, 0.3f, 0.5f, 0.3f, 0};
    case HairStyle::kCoat: return {0.5f, 1.5f, 0.4f, 0.3f, 0.1f, 0.03f};
  }
  return {};
}

/// What the strands of one guide have in common.
struct Lock {
  float phase, radius, pitch, handedness;  ///< of the curl
  float length;                            ///< standard normal
  float tightness, start;                  ///< of the gathering, and the share of the strand at which it begins
};

/// A sine sampled at equal steps without calling sin(): (cosine, sine) turned by a fixed angle each time.
struct Oscillator {
  float c, s, step_c, step_s;
  Oscillator() = default;
  Oscillator(float phase, float step)
      : c(std::cos(phase)), s(std::sin(phase)), step_c(std::cos(step)), step_s(std::sin(step)) {}
  float next() {
    const float value = s, turned = c * step_c - s * step_s;
    s = s * step_c + c * step_s, c = turned;
    return value;
  }
};

/// Smooth noise along one strand: a slow and a fast sine per axis.
class Frizz {
 public:
  Frizz(Rng& rng, float step) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      slow_[axis] = Oscillator(kTwoPi * rng.uniform(), kTwoPi * mix(9.f, 24.f, rng.uniform()) * step);
      fast_[axis] = Oscillator(kTwoPi * rng.uniform(), kTwoPi * mix(45.f, 110.f, rng.uniform()) * step);
    }
  }
  Vec3 next() {
    const auto axis = [this](std::size_t i) { return slow_[i].next() + 0.3f * fast_[i].next(); };
    const float x = axis(0), y = axis(1);
    return {x, y, axis(2)};
  }

 private:
  std::array<Oscillator, 3> slow_, fast_;
};

/// The numbers drawn for one strand.
struct Traits {
  float length, width;  ///< metres
  float tightness;      ///< of its lock, and for a stray none
  float phase, radius;  ///< of the curl
  float frizz;          ///< metres, amplitude at the tip
  float stray;          ///< metres that the tip stands off; 0 for hair that stays in its lock
  HairGroup group;
};

class StrandFiller {
 public:
  StrandFiller(const GrowSettings& settings, const Ground& ground, const GuideSet& guides, const std::vector<Root>& roots)
      : s_(settings), style_(style_of(settings.style)), ground_(ground), guides_(guides), roots_(roots),
        members_(find_memberships(settings, ground, guides, roots, kTuftSize)) {
    locks_.reserve(guides.count());
    for (std::size_t g = 0; g < guides.count(); ++g) locks_.push_back(make_lock(static_cast<std::uint32_t>(g)));
  }

  const std::vector<Membership>& members() const { return members_; }

  /// Writes the points and widths of the strand at `root`; returns its group.
  HairGroup fill(std::uint32_t root, std::size_t points, Vec3* position, float* width) const;

 private:
  struct GuidePlace {
    Vec3 position, side, up;
  };
  struct Attachment {
    Vec3 world, local;  // offset from the guide's root: in the world, and in the guide's first frame
    float reach;        // 0…1, how far it turns and gathers with the guide
  };

  Lock make_lock(std::uint32_t g) const;
  Traits draw_traits(std::uint32_t root, Rng& rng) const;
  float draw_length(const Lock& lock, Vec3 root, Rng& rng) const;
  Attachment attach(std::uint32_t g, Vec3 offset, float strand_length) const;
  GuidePlace guide_at(std::uint32_t g, float s) const;
  Vec3 carry(const GuidePlace& place, const Attachment& a, float close) const;
  Vec3 curl(const GuidePlace& place, float angle, float radius) const;
  float tie_squeeze(std::uint32_t g, float s) const;
  Vec3 outward(const Root& root, Vec3 p) const;

  const GrowSettings& s_;
  const StrandStyle style_;
  const Ground& ground_;
  const GuideSet& guides_;
  const std::vector<Root>& roots_;
  const std::vector<Membership> members_;
  std::vector<Lock> locks_;
};

Lock StrandFiller::make_lock(std::uint32_t g) const {
  Rng rng(s_.seed, g, kLockStream);
  Lock lock;
  // Waves of neighbouring locks run in step, ringlets do not.
  const float shared = kTwoPi * 1.5f * noise3(guides_.roots[g].position * 14.f, 51u);
  lock.phase = s_.style == HairStyle::kWavy ? shared + 1.2f * rng.uniform() : kTwoPi * rng.uniform();
  lock.radius = s_.curl_radius * mix(0.55f, 1.45f, rng.uniform());
  lock.pitch = s_.curl_pitch * mix(0.75f, 1.3f, rng.uniform());
  lock.handedness = rng.uniform() < 0.5f ? -1.f : 1.f;
  lock.length = rng.normal();
  lock.tightness = saturate(s_.clump_tightness * mix(0.6f, 1.25f, rng.uniform()));
  lock.start = mix(0.02f, 0.3f, rng.uniform());
  return lock;
}

float StrandFiller::draw_length(const Lock& lock, Vec3 root, Rng& rng) const {
  const float own = rng.normal();
  const float deviation = std::sqrt(style_.lock_share) * lock.length + std::sqrt(1 - style_.lock_share) * own;
  const float length = s_.length * std::max(0.05f, 1 + s_.length_variation * std::clamp(deviation, -2.5f, 2.5f));
  if (!ground_.scalp || style_.fade <= 0) return length;
  return length * mix(0.45f, 1.f, smoothstep(0.f, style_.fade, hairline_distance(root)));
}

Traits StrandFiller::draw_traits(std::uint32_t root, Rng& rng) const {
  const Lock& lock = locks_[members_[root].guide[0]];
  Traits t;
  const bool stray = rng.uniform() < s_.flyaways;
  const bool wool = s_.style == HairStyle::kCoat && rng.uniform() < s_.undercoat;
  t.group = stray ? HairGroup::kFlyaway : wool ? HairGroup::kWool : HairGroup::kScalp;
  if (!stray && guides_.tie[members_[root].guide[0]] > 0) t.group = HairGroup::kTail;
  t.length = draw_length(lock, roots_[root].position, rng) * (wool ? kWoolLength : 1);
  t.width = s_.width * std::max(0.2f, 1 + s_.width_variation * rng.normal()) * (wool ? kWoolWidth : 1);
  t.tightness = stray ? 0 : saturate(lock.tightness * mix(0.8f, 1.1f, rng.uniform()) * (wool ? 0.4f : 1));
  t.phase = lock.phase + style_.phase_spread * Rng(s_.seed, members_[root].tuft, kTuftStream).normal() + 0.25f * rng.normal();
  t.radius = lock.radius * mix(0.75f, 1.15f, rng.uniform());
  const float size = std::min(1.f, s_.length / 0.15f);
  t.frizz = size * s_.frizz * (0.0005f + 0.0035f * s_.frizz) *
            (stray  ? 2.5f
             : wool ? 2.f
                    : 1.f) *
            mix(0.5f, 1.5f, rng.uniform());
  t.stray = stray ? size * mix(0.003f, 0.022f, square(rng.uniform())) : 0;
  return t;
}

/// How something `offset` beside the root of guide `g` goes along with it.
StrandFiller::Attachment StrandFiller::attach(std::uint32_t g, Vec3 offset, float strand_length) const {
  const std::size_t at = g * static_cast<std::size_t>(guides_.points);
  const Vec3 side = guides_.side[at], up = guides_.up[at];
  const float distance = length(offset);
  // What is farther away than it is long must not swing with the guide like a door.
  const float reach = distance > 0 ? saturate(strand_length / (2 * distance)) : 1;
  return {offset, {dot(offset, side), dot(offset, up), dot(offset, cross(side, up))}, reach};
}

/// Guide `g` after arc length `s`.
StrandFiller::GuidePlace StrandFiller::guide_at(std::uint32_t g, float s) const {
  const float x = std::clamp(s / guides_.step, 0.f, static_cast<float>(guides_.points) - 1.001f);
  const std::size_t i = static_cast<std::size_t>(x), at = g * static_cast<std::size_t>(guides_.points) + i;
  const float t = x - static_cast<float>(i);
  return {lerp(guides_.position[at], guides_.position[at + 1], t), lerp(guides_.side[at], guides_.side[at + 1], t),
          lerp(guides_.up[at], guides_.up[at + 1], t)};
}

/// The offset of `a` where its guide has come to `place`, scaled by `close` as far as it reaches.
Vec3 StrandFiller::carry(const GuidePlace& place, const Attachment& a, float close) const {
  const Vec3 turned = place.side * a.local.x + place.up * a.local.y + cross(place.side, place.up) * a.local.z;
  return lerp(a.world, turned, a.reach) * mix(1.f, close, a.reach);
}

Vec3 StrandFiller::curl(const GuidePlace& place, float angle, float radius) const {
  // A flat wave swings sideways over the skin, not into it.
  return place.up * (std::cos(angle) * radius) + place.side * (std::sin(angle) * radius * style_.ellipticity);
}

/// Factor on a strand's offset from its guide: the tie of a ponytail presses all strands together.
float StrandFiller::tie_squeeze(std::uint32_t g, float s) const {
  const float tie = guides_.tie[g];
  if (tie <= 0) return 1;
  return mix(1.f, 0.25f, smoothstep(0.2f * tie, 0.95f * tie, s)) + 0.45f * smoothstep(0.005f, 0.06f, s - tie);
}

/// Where a stray hair at `p` stands off to.
Vec3 StrandFiller::outward(const Root& root, Vec3 p) const {
  return ground_.scalp ? normalize(Vec3(p.x, std::max(p.y, 0.f), p.z + 0.012f)) : root.normal;
}

HairGroup StrandFiller::fill(std::uint32_t index, std::size_t points, Vec3* position, float* width) const {
  Rng rng(s_.seed, index, kStrandStream);
  const Root& root = roots_[index];
  const Membership& m = members_[index];
  const std::uint32_t own = m.guide[0];
  const Lock& lock = locks_[own];
  const Traits t = draw_traits(index, rng);
  const float step = t.length / static_cast<float>(points - 1);
  Frizz frizz(rng, step);

  Attachment attached[kBlend];
  for (int k = 0; k < kBlend; ++k)
    attached[k] = attach(m.guide[k], root.position - guides_.roots[m.guide[k]].position, t.length);
  const Attachment to_tuft = attach(own, t.stray > 0 ? Vec3() : roots_[m.tuft].position - root.position, t.length);
  const float loyalty = saturate(2 * t.tightness);  // how much of the own lock alone shapes the tip
  const float slope = kTwoPi * t.radius / lock.pitch * std::sqrt(0.5f * (1 + square(style_.ellipticity)));

  position[0] = root.position, width[0] = t.width;
  frizz.next();
  float axis = 0;  // arc length along the lock
  for (std::size_t j = 1; j < points; ++j) {
    const float u = static_cast<float>(j) / static_cast<float>(points - 1), s = u * t.length;
    const float grown = smoothstep(0.f, style_.curl_start, u) * mix(1.f, 0.8f, u);
    axis += step / std::sqrt(1 + square(slope * grown));

    const float gather = smoothstep(lock.start, 0.7f, u),
                fine = std::max(style_.tuft, 0.8f * t.tightness) * smoothstep(0.f, 0.5f, u);
    const float close = (1 - t.tightness * gather) * tie_squeeze(own, axis), apart = 1 - loyalty * gather;
    const GuidePlace own_place = guide_at(own, axis);
    Vec3 p = own_place.position + carry(own_place, attached[0], close), blend;
    for (int k = 1; k < kBlend && apart > 0; ++k) {
      const GuidePlace place = guide_at(m.guide[k], axis);
      blend = blend + (place.position + carry(place, attached[k], close) - p) * (m.weight[k] * apart);
    }
    p = p + blend + carry(own_place, to_tuft, close) * fine * to_tuft.reach;
    if (t.radius > 0) {
      const float wobble = 0.9f * std::sin(axis * 23.f + lock.phase);
      p = p + curl(own_place, t.phase + lock.handedness * (kTwoPi * axis / lock.pitch + wobble), t.radius * grown);
    }
    p = p + frizz.next() * (t.frizz * u * (0.3f + 0.7f * u));
    if (t.stray > 0) p = p + outward(root, p) * (t.stray * square(u));
    const float clearance = std::min(0.3f * s, 0.0008f);
    p = ground_.collider ? push_out(*ground_.collider, p, clearance)
                         : keep_above(root.position, root.normal, ground_.size, p, clearance);
    position[j] = p;
    width[j] = t.width * (1 - s_.taper * square(u));
  }
  return t.group;
}

}  // namespace

StrandSet fill_strands(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                       const std::vector<Root>& roots, const Progress& progress) {
  const StrandFiller filler(settings, ground, guides, roots);
  const std::vector<std::uint32_t> order = order_by_guide(filler.members(), guides.count());
  const std::size_t count = roots.size(), points = static_cast<std::size_t>(settings.points);
  StrandSet out;
  out.basis = CurveBasis::kCatmullRom;
  out.points.resize(count * points), out.widths.resize(count * points), out.offsets.resize(count + 1);
  out.root_uv.resize(count), out.strand_id.resize(count), out.guide_id.resize(count), out.group.resize(count);
  constexpr std::size_t kChunk = 8192;  // strands between two calls of `progress`
  for (std::size_t chunk = 0; chunk < count; chunk += kChunk) {
    if (progress && !progress("grow", static_cast<double>(chunk) / static_cast<double>(count)))
      throw Error("grow", "", "cancelled", "");
    parallel_for(std::min(kChunk, count - chunk), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = chunk + begin; i < chunk + end; ++i) {
        const std::uint32_t root = order[i];
        out.offsets[i + 1] = static_cast<std::uint32_t>((i + 1) * points);
        out.strand_id[i] = root;
        out.root_uv[i] = roots[root].uv;
        out.guide_id[i] = static_cast<std::int32_t>(filler.members()[root].guide[0]);
        out.group[i] = static_cast<std::uint16_t>(
            filler.fill(root, points, out.points.data() + i * points, out.widths.data() + i * points));
      }
    });
  }
  if (progress) progress("grow", 1);
  return out;
}

}  // namespace pelage::groom
