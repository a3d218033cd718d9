// Points in hashed cubic cells: neighbours in constant time.
#pragma once

#include <pelage/vec.h>

#include <cstdint>
#include <vector>

namespace pelage::groom {

/// Grows one point at a time; queries see the points inserted so far. Concurrent queries are safe without inserts.
class PointGrid {
 public:
  /// `cell` metres, about the distance that queries ask for; `expected` points.
  PointGrid(float cell, std::size_t expected);

  void insert(Vec3 p);
  std::size_t size() const { return points_.size(); }
  Vec3 operator[](std::size_t i) const { return points_[i]; }

  /// Whether a point lies nearer than `radius` to `p`. Constant time for radius ≤ cell.
  bool any_within(Vec3 p, float radius) const;

  /// Up to `k` ≤ 8 nearest points, nearest first (ties by index), with squared distances. Returns how many there are.
  int nearest(Vec3 p, int k, std::uint32_t* index, float* distance2) const;

 private:
  struct Cell {
    int x, y, z;
  };
  Cell cell_of(Vec3 p) const;
  std::size_t bucket_of(int x, int y, int z) const;
  template <class Visit>
  void visit_cell(int x, int y, int z, const Visit& visit) const;

  float cell_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> next_;   // [point_count] next point of the same bucket
  std::vector<std::uint32_t> first_;  // [power of two] first point of a bucket
};

}  // namespace pelage::groom
