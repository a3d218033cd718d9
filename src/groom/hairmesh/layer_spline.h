// The spline of a hair mesh's columns seen as weights of the layers, and the layers that come nearest to given points.
#pragma once

#include <pelage/vec.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage {

/// Hermite spline through `layers` vertices with tangents by central differences, as expand() runs it; w 0…1, and straight on
/// beyond 1.
class LayerSpline {
 public:
  /// layers ≥ 2; samples ≥ layers: the points that project() takes.
  LayerSpline(std::uint32_t layers, std::size_t samples);

  std::uint32_t layers() const { return layers_; }
  std::size_t samples() const { return samples_; }

  Vec3 at(const Vec3* vertices, float w) const { return blend(vertices, w, false); }
  Vec3 derivative(const Vec3* vertices, float w) const { return blend(vertices, w, true); }

  /// `vertices` [layers] of the spline with the least sum of squared distances to `points` [samples], which are uniform in w.
  /// The root counts kRootWeight times, so that hair stands where it grew.
  void project(const Vec3* points, Vec3* vertices) const;
  static constexpr double kRootWeight = 20;

 private:
  struct Weights {
    std::size_t first;            ///< layer of weight[0]
    std::array<double, 4> value;  ///< of layers that do not exist 0
    std::size_t count;
  };
  Weights weights(double w, bool derivative) const;
  Vec3 blend(const Vec3* vertices, float w, bool derivative) const;

  std::uint32_t layers_;
  std::size_t samples_;
  std::vector<double> solution_;  ///< [layers][samples] (HᵀWH)⁻¹HᵀW
};

}  // namespace pelage
