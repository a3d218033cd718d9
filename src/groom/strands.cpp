#include "groom/strands.h"

#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/rng.h"
#include "groom/noise.h"
#include "groom/point_grid.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

constexpr float kTwoPi = 6.28318531f;
constexpr std::uint32_t kLockStream = 0x6c6f636bu, kStrandStream = 0x7374726eu;
constexpr int kBlend = 3;  // guides that shape a strand near its root

/// What the strands of one guide have in common.
struct Lock {
  float phase, radius, pitch, handedness, length, tightness;
};

struct Neighbors {
  std::uint32_t guide[kBlend];
  float weight[kBlend];
  int count;
};

float square(float x) { return x * x; }

class StrandFiller {
 public:
  StrandFiller(const GrowSettings& settings, const Ground& ground, const GuideSet& guides, const std::vector<Root>& roots)
      : s_(settings), ground_(ground), guides_(guides), roots_(roots) {
    locks_.reserve(guides.count());
    for (std::size_t g = 0; g < guides.count(); ++g) locks_.push_back(make_lock(static_cast<std::uint32_t>(g)));
    find_neighbors();
    sort_by_guide();
  }

  const std::vector<std::uint32_t>& order() const { return order_; }
  std::uint32_t guide_of(std::uint32_t root) const { return neighbors_[root].guide[0]; }

  /// Writes the strand of `root`: `points` places and widths.
  void fill(std::uint32_t root, std::size_t points, Vec3* position, float* width) const;

 private:
  Lock make_lock(std::uint32_t g) const {
    Rng rng(s_.seed, g, kLockStream);
    Lock lock;
    lock.phase = kTwoPi * rng.uniform();
    lock.radius = s_.curl_radius * mix(0.7f, 1.3f, rng.uniform());
    lock.pitch = s_.curl_pitch * mix(0.75f, 1.3f, rng.uniform());
    lock.handedness = rng.uniform() < 0.5f ? -1.f : 1.f;
    lock.length = rng.normal();
    lock.tightness = saturate(s_.clump_tightness * mix(0.7f, 1.2f, rng.uniform()));
    return lock;
  }
  void find_neighbors();
  void sort_by_guide();
  Vec3 on_guide(std::uint32_t g, Vec3 root, float s) const;

  const GrowSettings& s_;
  const Ground& ground_;
  const GuideSet& guides_;
  const std::vector<Root>& roots_;
  std::vector<Lock> locks_;
  std::vector<Neighbors> neighbors_;
  std::vector<std::uint32_t> order_;
};

void StrandFiller::find_neighbors() {
  Bounds box;
  for (const Root& r : guides_.roots) box.extend(r.position);
  PointGrid grid(std::max(length(box.extent()) / std::sqrt(static_cast<float>(guides_.count()) + 1), 1e-6f), guides_.count());
  for (const Root& r : guides_.roots) grid.insert(r.position);
  const int wanted = static_cast<int>(std::min<std::size_t>(kBlend, guides_.count()));
  neighbors_.resize(roots_.size());
  parallel_for(roots_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float d2[kBlend];
      Neighbors& n = neighbors_[i];
      n.count = grid.nearest(roots_[i].position, wanted, n.guide, d2);
      const std::size_t middle = static_cast<std::size_t>(guides_.points) / 4, stride = static_cast<std::size_t>(guides_.points);
      const auto heading = [&](std::uint32_t g) { return normalize(guides_.position[g * stride + middle] - guides_.roots[g].position); };
      float sum = 0;
      for (int k = 0; k < n.count; ++k) {
        // Guides beyond the parting head elsewhere and must not drag the strand across.
        const float agree = smoothstep(0.5f, 0.9f, dot(heading(n.guide[0]), heading(n.guide[k])));
        n.weight[k] = (k == 0 ? 1 : agree) / (d2[k] + 1e-8f);
        sum += n.weight[k];
      }
      for (int k = 0; k < n.count; ++k) n.weight[k] /= sum;
    }
  });
}

void StrandFiller::sort_by_guide() {
  std::vector<std::uint32_t> start(guides_.count() + 1, 0);
  for (const Neighbors& n : neighbors_) ++start[n.guide[0] + 1];
  for (std::size_t g = 0; g < guides_.count(); ++g) start[g + 1] += start[g];
  order_.resize(roots_.size());
  for (std::uint32_t i = 0; i < roots_.size(); ++i) order_[start[neighbors_[i].guide[0]]++] = i;
}

/// Where the strand rooted at `root` is after arc length `s` if it follows guide `g` at its own offset.
Vec3 StrandFiller::on_guide(std::uint32_t g, Vec3 offset, float s) const {
  const float x = std::min(s / guides_.step, static_cast<float>(guides_.points - 1) - 1e-3f);
  const std::size_t i = static_cast<std::size_t>(x), at = g * static_cast<std::size_t>(guides_.points) + i;
  const float t = x - static_cast<float>(i);
  const Vec3 p = lerp(guides_.position[at], guides_.position[at + 1], t);
  const Vec3 side = lerp(guides_.side[at], guides_.side[at + 1], t), up = lerp(guides_.up[at], guides_.up[at + 1], t);
  return p + side * offset.x + up * offset.y + cross(side, up) * offset.z;
}

void StrandFiller::fill(std::uint32_t root_index, std::size_t points, Vec3* position, float* width) const {
  Rng rng(s_.seed, root_index, kStrandStream);
  const Root& root = roots_[root_index];
  const Neighbors& n = neighbors_[root_index];
  const std::uint32_t own = n.guide[0];
  const Lock& lock = locks_[own];
  const bool flyaway = rng.uniform() < s_.flyaways;

  const float spread = s_.length_variation;
  const float total = s_.length * std::clamp(1 + spread * (0.7f * lock.length + 0.714f * rng.normal()),
                                             std::max(0.1f, 1 - 2.5f * spread), 1 + 2.5f * spread);
  const float root_width = s_.width * std::max(0.3f, 1 + s_.width_variation * rng.normal());
  const float tight = flyaway ? 0.f : lock.tightness * mix(0.8f, 1.1f, rng.uniform());

  Vec3 offset[kBlend];
  for (int k = 0; k < n.count; ++k) {
    const std::size_t at = n.guide[k] * static_cast<std::size_t>(guides_.points);
    const Vec3 d = root.position - guides_.position[at];
    offset[k] = {dot(d, guides_.side[at]), dot(d, guides_.up[at]), dot(d, cross(guides_.side[at], guides_.up[at]))};
  }
  const bool curly = lock.radius > 0;
  const float turn = curly ? kTwoPi * lock.radius / lock.pitch : 0;
  const float stretch = 1 / std::sqrt(1 + turn * turn);  // axis length per strand length
  const float phase = lock.phase + (s_.style == HairStyle::kAfro ? 2.5f : 0.5f) * rng.normal();
  const float radius = lock.radius * mix(0.85f, 1.15f, rng.uniform());
  const float amplitude = (0.0006f + 0.004f * s_.frizz) * s_.frizz * (flyaway ? 3.f : 1.f) * std::min(1.f, s_.length / 0.1f);
  float wave[6], frequency[6];
  for (int k = 0; k < 6; ++k) wave[k] = kTwoPi * rng.uniform(), frequency[k] = kTwoPi * (k < 3 ? mix(14.f, 30.f, rng.uniform()) : mix(40.f, 110.f, rng.uniform()));

  for (std::size_t j = 0; j < points; ++j) {
    const float u = static_cast<float>(j) / static_cast<float>(points - 1);
    const float axis = u * total * stretch;
    const float gather = smoothstep(0.f, 0.8f, u);
    Vec3 p;
    for (int k = 0; k < n.count; ++k) {
      const float w = k == 0 ? mix(n.weight[0], 1, gather) : n.weight[k] * (1 - gather);
      if (w > 0) p = p + on_guide(n.guide[k], offset[k] * (1 - tight * gather), axis) * w;
    }
    if (curly) {
      const float grown = smoothstep(0.f, 0.25f, u), angle = phase + lock.handedness * kTwoPi * axis / lock.pitch;
      const std::size_t at = own * static_cast<std::size_t>(guides_.points) +
                             std::min(static_cast<std::size_t>(axis / guides_.step), static_cast<std::size_t>(guides_.points - 1));
      p = p + (guides_.side[at] * std::cos(angle) + guides_.up[at] * std::sin(angle)) * (radius * grown);
    }
    const float rough = amplitude * square(smoothstep(0.f, 1.f, u * 1.2f)) + amplitude * 0.3f * u;
    const float s = u * total;
    p = p + Vec3(std::sin(frequency[0] * s + wave[0]) + 0.4f * std::sin(frequency[3] * s + wave[3]),
                 std::sin(frequency[1] * s + wave[1]) + 0.4f * std::sin(frequency[4] * s + wave[4]),
                 std::sin(frequency[2] * s + wave[2]) + 0.4f * std::sin(frequency[5] * s + wave[5])) * rough;
    if (ground_.collider && j > 0) {
      const DistanceSample skin = sample_distance(*ground_.collider, p);
      const float clearance = std::min(0.3f * s, 0.0008f);
      if (skin.distance < clearance) p = p + normalize(skin.gradient) * (clearance - skin.distance);
    }
    position[j] = j == 0 ? root.position : p;
    width[j] = root_width * (1 - s_.taper * u * u);
  }
}

}  // namespace

StrandSet fill_strands(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                       const std::vector<Root>& roots, const Progress& progress) {
  const StrandFiller filler(settings, ground, guides, roots);
  const std::size_t count = roots.size(), points = static_cast<std::size_t>(settings.points);
  StrandSet out;
  out.basis = CurveBasis::kCatmullRom;
  out.points.resize(count * points), out.widths.resize(count * points), out.offsets.resize(count + 1);
  out.root_uv.resize(count), out.strand_id.resize(count), out.guide_id.resize(count), out.group.resize(count);
  const std::vector<std::uint32_t>& order = filler.order();
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
        out.guide_id[i] = static_cast<std::int32_t>(filler.guide_of(root));
        out.group[i] = static_cast<std::uint16_t>(guides.group[filler.guide_of(root)]);
        filler.fill(root, points, out.points.data() + i * points, out.widths.data() + i * points);
      }
    });
  }
  if (progress) progress("grow", 1);
  return out;
}

}  // namespace pelage::groom
