// The truth of a thick hair: paths through a bundle of straight, parallel fibers.
//
// Such a bundle is the same all along its axis, so nothing depends on where along it a path is: which fiber comes next follows from
// the azimuth alone, and the inclination is carried along for the fibers' scattering. Fibers are therefore circles in a plane, and what is
// traced there is exact for the bundle in space. Fibers scatter from their axis, as in the path tracer (reference/vertex.h).
#pragma once

#include <cstdint>
#include <vector>

#include "reference/fiber_bsdf.h"

namespace pelage {

/// N circles in an ellipse, seen along the axis of half_depth.
struct ClusterShape {
  int hairs = 64;         ///< N
  float radius = 1;       ///< of a fiber; any unit of length
  float half_width = 16;  ///< semi-axis across the view, same unit
  float half_depth = 16;  ///< semi-axis along the view

  float density() const { return static_cast<float>(hairs) * radius * radius / (half_width * half_depth); }
};

/// Circles that do not overlap, all inside the ellipse, each placed at random where there is room.
class FiberCluster {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// Throws Error where the fibers do not fit (density above about 0.45).
  FiberCluster(const ClusterShape& shape, std::uint64_t seed);

  /// The first fiber that a ray meets farther than `from`, other than `left`; kNone: none. direction: unit length.
  std::uint32_t nearest(Vec2 origin, Vec2 direction, std::uint32_t left) const;
  /// How many fibers the line through `origin` meets. direction: unit length.
  int crossings(Vec2 origin, Vec2 direction) const;
  Vec2 center(std::uint32_t fiber) const { return {x_[fiber], y_[fiber]}; }

 private:
  std::vector<float> x_, y_;
  float radius2_;
};

/// What clusters scatter from one direction, f·cos θ_i averaged over the rays that meet a fiber, and how many they meet.
struct ClusterScattering {
  static constexpr int kAzimuths = 36, kInclinations = 36;  ///< cells of |φ_i − φ_o| in [0, π] and of θ_i in [−π/2, π/2]

  std::vector<Vec3> energy;  ///< [kAzimuths · kInclinations], share of light by cell, both signs of φ together; sum ≤ 1
  double coverage = 0;       ///< share of the ellipse's width where a ray meets a fiber
  double crossings = 0;      ///< mean number of fibers on a straight line, over all rays
  double passes(double a_f) const;  ///< mean of a_f^(k−1) over the rays that meet k ≥ 1 fibers

  std::vector<double> counts;  ///< share of rays that meet k fibers
  const Vec3& at(int azimuth, int inclination) const {
    return energy[static_cast<std::size_t>(azimuth * kInclinations + inclination)];
  }
};

/// Averages `clusters` random clusters, `rays` each. The same for any thread count.
ClusterScattering trace_clusters(const ClusterShape& shape, const FiberMaterial& material, float theta_o, int clusters,
                                 int rays, std::uint64_t seed);

}  // namespace pelage
