#include "frame/draw_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "frame/camera_view.h"

namespace pelage {
namespace {

// Fewer strips let more of the hidden fragments be told early, more let more threads have some of their own.
constexpr std::uint32_t kStrips = 16, kDepths = 64;
constexpr std::size_t kGrain = 1024;
/// Strands looked at to learn the habit of a groom.
constexpr std::size_t kSampled = 256;
/// Strands this far apart in the file are looked at to tell whether neighbors there are neighbors on the screen.
constexpr std::size_t kNeighbors = 16;
/// Pixels that a strand must cover for each of its control points: to read points out of order costs more than the order saves below.
constexpr float kWorthwhile = 4;

/// Where points of a strand are seen: x, y in pixels, inside the image, and metres of depth.
class Places {
 public:
  Places(const GroomInstance& groom, const CameraView& view)
      : set_(*groom.strands), view_(view), to_camera_(compose(view.world_to_camera, groom.transform)),
        width_scale_(groom.width_scale * similarity_scale(groom.transform)) {}

  std::uint32_t points(std::size_t strand) const { return set_.offsets[strand + 1] - set_.offsets[strand]; }
  Vec3 root(std::size_t strand) const { return of(strand, 0); }
  Vec3 middle(std::size_t strand) const { return of(strand, points(strand) / 2); }
  Vec3 tip(std::size_t strand) const { return of(strand, points(strand) - 1); }
  /// Pixels across, where the strand is `z` away.
  float width(std::size_t strand, float z) const {
    return set_.width(set_.offsets[strand]) * width_scale_ * pixels_per_metre(view_, z);
  }

 private:
  Vec3 of(std::size_t strand, std::uint32_t point) const {
    if (points(strand) == 0) return {};
    const Vec3 c = transform_point(to_camera_, set_.points[set_.offsets[strand] + point]);
    const float z = std::fmax(c.z, view_.near_plane);
    const Vec2 seen = project(view_, {c.x, c.y, z});
    const auto inside = [](float v, int size) { return std::fmin(std::fmax(v, 0.f), static_cast<float>(size)); };
    return {inside(seen.x, view_.width), inside(seen.y, view_.height), z};
  }

  const StrandSet& set_;
  const CameraView& view_;
  Affine to_camera_;
  float width_scale_;
};

/// What a sample of the strands says about all of them.
struct Habit {
  bool upright;      ///< strands reach across a smaller part of the groom's width than of its height
  bool scattered;    ///< strands that are neighbors in the file are none on the screen
  bool substantial;  ///< strands cover many pixels for each control point
};

Habit study(const Places& places, std::size_t count) {
  Bounds middles;
  Vec3 reach, apart;
  float sampled = 0, points = 0, covered = 0;
  const auto size = [](Vec3 v) { return Vec3(std::fabs(v.x), std::fabs(v.y), 0); };
  for (std::size_t s = 0; s < count; s += count / kSampled + 1, ++sampled) {
    if (places.points(s) == 0) continue;
    const Vec3 middle = places.middle(s), way = size(places.tip(s) - places.root(s));
    middles.extend(middle);
    reach += way;
    apart += size(places.middle(std::min(s + kNeighbors, count - 1)) - middle);
    points += static_cast<float>(places.points(s)), covered += length(way) * places.width(s, middle.z);
  }
  const Vec3 extent = middles.extent();
  const bool upright = reach.x * extent.y <= reach.y * extent.x;
  const bool scattered = 8 * (upright ? apart.x : apart.y) > sampled * (upright ? extent.x : extent.y);
  return {upright, scattered, covered > kWorthwhile * points};
}

/// Which of `count` equal parts of [lower, upper] holds v.
std::uint32_t part_of(float v, float lower, float upper, std::uint32_t count) {
  const float scaled = upper > lower ? (v - lower) / (upper - lower) * static_cast<float>(count) : 0.f;
  return std::min(static_cast<std::uint32_t>(scaled), count - 1);
}

/// Strands by cell, those of a cell as they stand in the file.
std::vector<std::uint32_t> sort_by_cell(const std::vector<std::uint16_t>& cells) {
  std::array<std::uint32_t, kStrips * kDepths + 1> next{};
  for (const std::uint16_t c : cells) ++next[c + 1u];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::uint32_t> order(cells.size());
  for (std::size_t s = 0; s < cells.size(); ++s) order[next[cells[s]]++] = static_cast<std::uint32_t>(s);
  return order;
}

}  // namespace

std::vector<std::uint32_t> draw_order(const GroomInstance& groom, const CameraView& view) {
  if (groom.only) return {};  // in the order of memory: far away strands cover few pixels
  const std::size_t count = groom.strands->strand_count();
  const Places places(groom, view);
  const Habit habit = study(places, count);
  if (!habit.scattered || !habit.substantial) return {};

  std::vector<Vec3> seen(count);
  std::vector<Bounds> parts((count + kGrain - 1) / kGrain);
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) parts[begin / kGrain].extend(seen[s] = places.middle(s));
  });
  Bounds all;
  for (const Bounds& part : parts) all.extend(part);

  std::vector<std::uint16_t> cells(count);
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec3 p = seen[s];
      const std::uint32_t strip =
          habit.upright ? part_of(p.x, all.lower.x, all.upper.x, kStrips) : part_of(p.y, all.lower.y, all.upper.y, kStrips);
      cells[s] = static_cast<std::uint16_t>(strip * kDepths + part_of(p.z, all.lower.z, all.upper.z, kDepths));
    }
  });
  return sort_by_cell(cells);
}

}  // namespace pelage
