#include "reference/fiber_cluster.h"

#include <pelage/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/rng.h"

namespace pelage {
namespace {

constexpr int kTries = 200000;
constexpr int kMaxEvents = 2000;
constexpr float kSmall = 0.05f;  // throughput below which paths may end by chance
constexpr Vec3 kAxis{0, 0, 1};

/// One cluster's share of ClusterScattering.
struct Tally {
  std::vector<Vec3> weight = std::vector<Vec3>(ClusterScattering::kAzimuths * ClusterScattering::kInclinations);
  std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(1);
};

std::size_t cell_of(Vec3 direction) {
  // The eye is at +y.
  const float azimuth = std::fabs(std::atan2(direction.x, direction.y)) / std::numbers::pi_v<float>;
  const float inclination = std::asin(std::clamp(direction.z, -1.f, 1.f)) / std::numbers::pi_v<float> + 0.5f;
  const int i = std::min(static_cast<int>(azimuth * ClusterScattering::kAzimuths), ClusterScattering::kAzimuths - 1);
  const int j =
      std::min(static_cast<int>(inclination * ClusterScattering::kInclinations), ClusterScattering::kInclinations - 1);
  return static_cast<std::size_t>(i * ClusterScattering::kInclinations + j);
}

/// Follows light backward from the eye until it leaves the cluster.
void walk(const FiberCluster& cluster, const FiberMaterial& material, Vec2 origin, Vec3 direction, Rng& rng, Tally& tally) {
  Vec3 throughput(1, 1, 1);
  std::uint32_t at = FiberCluster::kNone;
  for (int event = 0; event < kMaxEvents; ++event) {
    const Vec2 across(direction.x, direction.y);
    const float length = std::hypot(across.x, across.y);
    if (length == 0) return;
    const std::uint32_t next = cluster.nearest(origin, across * (1 / length), at);
    if (next == FiberCluster::kNone) {
      Vec3& sum = tally.weight[cell_of(direction)];
      sum = sum + throughput;
      return;
    }
    at = next, origin = cluster.center(at);
    const float u0 = rng.uniform(), u1 = rng.uniform(), u2 = rng.uniform(), u3 = rng.uniform();
    // h is not looked at by the far-field models.
    const ScatteredDirection s = FiberBsdf(material, {}, kAxis, direction * -1.f, 0).scatter({u0, u1, u2, u3});
    throughput = throughput * s.weight, direction = s.direction;
    const float most = std::max({throughput.x, throughput.y, throughput.z});
    if (most < kSmall) {
      const float survive = most / kSmall;
      if (rng.uniform() >= survive) return;
      throughput = throughput / survive;
    }
  }
}

}  // namespace

FiberCluster::FiberCluster(const ClusterShape& shape, std::uint64_t seed) : radius2_(shape.radius * shape.radius) {
  const float a = shape.half_width - shape.radius, b = shape.half_depth - shape.radius;
  Rng rng(seed, 0);
  for (int tries = 0; static_cast<int>(x_.size()) < shape.hairs; ++tries) {
    if (tries == kTries) throw Error("cluster", "", "its fibers do not fit into the ellipse", "choose fewer or thinner ones");
    const float x = 2 * rng.uniform() - 1, y = 2 * rng.uniform() - 1;
    if (x * x + y * y > 1) continue;
    const auto overlaps = [&](std::size_t i) {
      const float dx = x_[i] - a * x, dy = y_[i] - b * y;
      return dx * dx + dy * dy < 4 * radius2_;
    };
    bool free = true;
    for (std::size_t i = 0; i < x_.size() && free; ++i) free = !overlaps(i);
    if (free) x_.push_back(a * x), y_.push_back(b * y);
  }
}

std::uint32_t FiberCluster::nearest(Vec2 origin, Vec2 direction, std::uint32_t left) const {
  std::uint32_t found = kNone;
  float best = INFINITY;
  for (std::uint32_t i = 0; i < x_.size(); ++i) {
    const float dx = x_[i] - origin.x, dy = y_[i] - origin.y;
    const float side = dx * direction.y - dy * direction.x, along = dx * direction.x + dy * direction.y;
    if (side * side < radius2_ && along > 0 && along < best && i != left) {
      // Circles do not overlap, so the order of the chords' middles along a ray is that of the hits.
      best = along, found = i;
    }
  }
  return found;
}

int FiberCluster::crossings(Vec2 origin, Vec2 direction) const {
  int count = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const float side = (x_[i] - origin.x) * direction.y - (y_[i] - origin.y) * direction.x;
    count += side * side < radius2_;
  }
  return count;
}

double ClusterScattering::passes(double a_f) const {
  double sum = 0;
  for (std::size_t k = 1; k < counts.size(); ++k) sum += counts[k] * std::pow(a_f, static_cast<double>(k - 1));
  return coverage > 0 ? sum / coverage : 1;
}

ClusterScattering trace_clusters(const ClusterShape& shape, const FiberMaterial& material, float theta_o, int clusters,
                                 int rays, std::uint64_t seed) {
  std::vector<Tally> tallies(static_cast<std::size_t>(clusters));
  const Vec3 direction(0, -std::cos(theta_o), -std::sin(theta_o));
  parallel_for(tallies.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const FiberCluster cluster(shape, seed + c);
      for (int ray = 0; ray < rays; ++ray) {
        Rng rng(seed + c, static_cast<std::uint32_t>(ray), 1u << 20);
        const float offset = (static_cast<float>(ray) + rng.uniform()) / static_cast<float>(rays) * 2 - 1;
        const Vec2 origin(offset * shape.half_width, 2 * shape.half_depth);
        const auto met = static_cast<std::size_t>(cluster.crossings(origin, {0, -1}));
        if (met >= tallies[c].counts.size()) tallies[c].counts.resize(met + 1);
        ++tallies[c].counts[met];
        if (met > 0) walk(cluster, material, origin, direction, rng, tallies[c]);
      }
    }
  });
  ClusterScattering result;
  result.energy.resize(ClusterScattering::kAzimuths * ClusterScattering::kInclinations);
  for (const Tally& t : tallies) {
    for (std::size_t i = 0; i < t.weight.size(); ++i) result.energy[i] = result.energy[i] + t.weight[i];
    if (t.counts.size() > result.counts.size()) result.counts.resize(t.counts.size());
    for (std::size_t k = 0; k < t.counts.size(); ++k) result.counts[k] += t.counts[k];
  }
  const double all = static_cast<double>(clusters) * rays;
  for (std::size_t k = 0; k < result.counts.size(); ++k) {
    result.counts[k] /= all;
    result.crossings += static_cast<double>(k) * result.counts[k];
  }
  result.coverage = 1 - result.counts[0];
  const auto scale = static_cast<float>(1 / std::max(result.coverage * all, 1.0));
  for (Vec3& e : result.energy) e = e * scale;
  return result;
}

}  // namespace pelage
