#include "groom/point_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "core/check.h"

namespace pelage::groom {
namespace {
constexpr std::uint32_t kEnd = 0xffffffffu;
constexpr int kMaxRings = 12;
}  // namespace

PointGrid::PointGrid(float cell, std::size_t expected)
    : cell_(cell), first_(std::bit_ceil(std::max<std::size_t>(expected, 16)), kEnd) {
  PELAGE_CHECK(cell > 0);
  points_.reserve(expected), next_.reserve(expected);
}

PointGrid::Cell PointGrid::cell_of(Vec3 p) const {
  const auto along = [this](float x) { return static_cast<int>(std::floor(std::clamp(x / cell_, -1e9f, 1e9f))); };
  return {along(p.x), along(p.y), along(p.z)};
}

std::size_t PointGrid::bucket_of(int x, int y, int z) const {
  const std::uint32_t hash = static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                             static_cast<std::uint32_t>(z) * 83492791u;
  return (hash ^ hash >> 15) & (first_.size() - 1);
}

void PointGrid::insert(Vec3 p) {
  const Cell c = cell_of(p);
  std::uint32_t& first = first_[bucket_of(c.x, c.y, c.z)];
  next_.push_back(first);
  first = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
}

template <class Visit>
void PointGrid::visit_cell(int x, int y, int z, const Visit& visit) const {
  for (std::uint32_t i = first_[bucket_of(x, y, z)]; i != kEnd; i = next_[i]) {
    // Other cells share the bucket; counting their points twice would matter to nearest().
    const Cell c = cell_of(points_[i]);
    if (c.x == x && c.y == y && c.z == z) visit(i);
  }
}

bool PointGrid::any_within(Vec3 p, float radius) const {
  const Cell low = cell_of(p - Vec3(radius, radius, radius)), high = cell_of(p + Vec3(radius, radius, radius));
  bool found = false;
  for (int z = low.z; z <= high.z && !found; ++z)
    for (int y = low.y; y <= high.y && !found; ++y)
      for (int x = low.x; x <= high.x && !found; ++x)
        visit_cell(x, y, z, [&](std::uint32_t i) {
          const Vec3 d = points_[i] - p;
          found = found || dot(d, d) < radius * radius;
        });
  return found;
}

int PointGrid::nearest(Vec3 p, int k, std::uint32_t* index, float* distance2) const {
  PELAGE_CHECK(k >= 1 && k <= 8);
  int count = 0;
  const auto offer = [&](std::uint32_t i) {
    const Vec3 d = points_[i] - p;
    const float d2 = dot(d, d);
    const auto before = [&](int slot) { return d2 < distance2[slot] || (d2 == distance2[slot] && i < index[slot]); };
    if (count == k && !before(k - 1)) return;
    int slot = count < k ? count++ : k - 1;
    for (; slot > 0 && before(slot - 1); --slot) index[slot] = index[slot - 1], distance2[slot] = distance2[slot - 1];
    index[slot] = i, distance2[slot] = d2;
  };
  const Cell c = cell_of(p);
  for (int ring = 0; ring <= kMaxRings; ++ring) {
    // All cells up to `ring` cover every point nearer than ring·cell.
    const float covered = static_cast<float>(ring - 1) * cell_;
    if (count == k && ring > 0 && distance2[k - 1] <= covered * covered) return count;
    for (int z = -ring; z <= ring; ++z)
      for (int y = -ring; y <= ring; ++y) {
        const bool shell = std::max(std::abs(z), std::abs(y)) == ring;
        for (int x = -ring; x <= ring; x += shell || ring == 0 ? 1 : 2 * ring) visit_cell(c.x + x, c.y + y, c.z + z, offer);
      }
  }
  if (count == k) {
    const float covered = static_cast<float>(kMaxRings) * cell_;
    if (distance2[k - 1] <= covered * covered) return count;
  }
  count = 0;
  for (std::uint32_t i = 0; i < points_.size(); ++i) offer(i);
  return count;
}

}  // namespace pelage::groom
