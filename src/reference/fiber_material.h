// What a groom's fiber is before it is known from where it is seen: computed once, looked up by every ray.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <vector>

#include "frame/fiber.h"

namespace pelage {

/// Lobes from the table against lobes by scatter_prepare_marschner(): energies, and the share of a pair's energy that lies
/// elsewhere in azimuth. That is largest where the two lobes of a pair meet, which they do like a root.
inline constexpr float kMarschnerTableMaxAbsError = 1e-4f, kMarschnerTableMaxMisplaced = 2e-3f;

/// A pair of azimuthal lobes from kappa, cos_mu and norm.
kernel::ScatterPair completed(const kernel::ScatterPair& pair);

/// A longitudinal lobe that waits for θ_o: scatter_cone() without what does not depend on it.
class ConeShape {
 public:
  ConeShape() = default;
  ConeShape(float shift, float v)
      : cone_(kernel::scatter_cone(0, 1, shift, v)), sin_(kernel::m_sin(shift)), cos_(kernel::m_cos(shift)) {}

  kernel::ScatterCone seen_from(float sin_o, float cos_o) const {
    kernel::ScatterCone c = cone_;
    c.sin_o = sin_o * cos_ - cos_o * sin_;
    c.cos_o = kernel::abs(cos_o * cos_ + sin_o * sin_);
    return c;
  }

 private:
  kernel::ScatterCone cone_{};
  float sin_ = 0, cos_ = 1;
};

/// scatter_prepare_marschner() of one fiber at evenly spaced cos θ_o, with straight lines between: it knows θ_o by its cosine
/// alone. A straight line between energies that add up to 1 adds up to 1; the shares of light that go forward are left out.
class MarschnerTable {
 public:
  MarschnerTable() = default;
  explicit MarschnerTable(const kernel::ScatterFiber& fiber);

  bool empty() const { return rows_.empty(); }
  /// Of the pairs kappa, cos_mu and norm: that of the exact Bessel function, because each of a path's many events in white hair
  /// multiplies what is wrong with it.
  kernel::ScatterLobes lobes(float sin_o, float cos_o) const;

 private:
  static constexpr std::size_t kCells = 512;
  using Row = std::array<float, 16>;  ///< energies by channel, then concentration and cosine of both pairs, and their norms

  kernel::ScatterLobes fixed_{};  ///< what every θ_o has in common
  ConeShape r_, tt_, trt_;
  std::vector<Row> rows_;  ///< [kCells + 1] or empty
};

/// A groom's material, ready for the models of fiber_models.h.
class FiberMaterial {
 public:
  enum class Tables { kNone, kWherePossible };

  /// With kWherePossible Marschner's lobes come from a table if one color holds for the groom.
  explicit FiberMaterial(const HairMaterial& material, Tables tables = Tables::kNone);

  const HairMaterial& material() const { return material_; }
  /// `strand_color` as for make_fiber().
  kernel::ScatterFiber fiber(Vec3 strand_color) const { return one_color() ? fiber_ : make_fiber(material_, strand_color); }
  /// scatter_prepare_marschner(), or the same from the table; of the pairs kappa, cos_mu and norm.
  kernel::ScatterLobes marschner(Vec3 strand_color, float sin_o, float cos_o) const;
  /// scatter_prepare_chiang().
  kernel::ScatterNear chiang(Vec3 strand_color, float sin_o, float cos_o, float h) const;

 private:
  bool one_color() const { return material_.color_source != HairMaterial::ColorSource::kStrand; }

  HairMaterial material_;
  kernel::ScatterFiber fiber_;  ///< where there is one color
  ConeShape near_r_, near_tt_, near_trt_, near_rest_;
  MarschnerTable table_;
};

}  // namespace pelage
