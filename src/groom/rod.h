// One guide as an elastic rod: extended position-based dynamics in small steps, one iteration each (Macklin 2016 and 2019;
// references.bib: Macklin2016XPBD, Macklin2019SmallSteps). docs/simulation.md has the equations.
#pragma once

#include <pelage/lod.h>
#include <pelage/simulate.h>

#include <array>

#include "core/rotation.h"
#include "groom/distance_grid.h"

namespace pelage::groom {

/// One substep: where the head was and is, seconds.
struct RodStep {
  Rigid head_before, head;
  double time = 0;  ///< at its end
  float seconds = 0;
};

/// Control points 0 and 1 go with the head, the others by inertia, forces and constraints. A guide with control points that coincide
/// goes with the head as a whole.
class Rod {
 public:
  static constexpr std::size_t kPoints = LodHierarchy::kPoints;
  static constexpr std::size_t kWindow = 4, kWindows = kPoints - kWindow + 1;  ///< points that keep their shape together
  using Points = std::array<Vec3, kPoints>;

  /// At rest on a head at rest. `rest` has kPoints points; `grid`, the head's distances, may be null. Both and `settings` must outlive it.
  Rod(const Vec3* rest, const SimulationSettings& settings, const DistanceGrid* grid);

  /// Takes it from where the head is at rest to where it is now, without motion.
  void put(const Rigid& head);
  void step(const RodStep& step);

  const Points& points() const { return x_; }

 private:
  /// What keeps a strand at rest where gravity pulls: see carry_weight().
  struct Weight {
    std::array<float, kPoints> tension{};  // of the piece from point j to the next
    std::array<Vec3, kPoints> support{};   // on point j, in the head's space
  };

  /// Points of a window from their center, which weighs each by its mass.
  struct Window {
    std::array<Vec3, kWindow> arms;
    std::array<float, kWindow> weights;
  };

  void carry_weight();
  Window window(std::size_t first, const Vec3* points) const;
  void predict(const RodStep& step);
  void pull_to_shape(const RodStep& step);
  void bend(const RodStep& step);
  void stretch(const RodStep& step);
  void collide(const RodStep& step);
  /// Whether it was inside, by more than rounding.
  bool push_out(const RodStep& step, std::size_t j, float friction);

  const SimulationSettings& settings_;
  const DistanceGrid* grid_;
  bool rigid_ = false;
  const Vec3* rest_;
  // Direction and length of piece j, from point j to point j + 1; the others of point j.
  std::array<Vec3, kPoints> rest_direction_{};
  std::array<float, kPoints> length_{}, inverse_mass_{}, pull_{}, clearance_{};
  std::array<float, kWindows> bend_{};  // ω² of each window, 1/s²
  std::array<Rotation, kWindows> turn_;
  Weight weight_;
  Points x_, v_, before_;
};

/// Air at a place: the wind, and gusts that it carries along (frozen turbulence, Taylor 1938; references.bib: Taylor1938Spectrum).
Vec3 wind_at(const SimulationSettings& settings, Vec3 p, double time);

}  // namespace pelage::groom
