// One fiber as the path tracer sees it: any model of HairMaterial, in world space.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <variant>

#include "reference/aggregate_models.h"
#include "reference/fiber_models.h"
#include "reference/thick_curves.h"

namespace pelage {

/// A sampled direction of light. Lobes: 0 R, 1 TT, 2 TRT, 3 what remains (later paths, the diffuse lobe, glints).
struct FiberSample {
  Vec3 direction;  ///< toward the light, unit length
  Vec3 value;      ///< f·cos θ_i of all lobes, per solid angle
  float pdf;       ///< density of `direction` over solid angle, all lobes together; 0: the light is absorbed
  int lobe;        ///< the lobe that the direction was drawn from
};

/// A direction of light whose `weight` · radiance has the mean ∫ L_i · evaluate dω_i.
struct ScatteredDirection {
  Vec3 direction;  ///< toward the light, unit length
  Vec3 weight;     ///< 0: the light is absorbed
};

/// Scattering of a fiber seen from one direction; what does not depend on the light is computed once, by the constructor.
///
/// L_o = ∫ L_i · evaluate dω_i over the whole sphere, and ∫ evaluate dω_i = albedo() within the bounds that
/// kernel/scatter states.
///
/// Pure and thread-safe. Everything is finite for every unit direction, along the fiber too.
class FiberBsdf {
 public:
  /// tangent: unit length, root to tip. to_eye: unit length. strand_color: as for make_fiber() (frame/fiber.h).
  /// h: where the ray meets the fiber, in radii from its axis along cross(to_eye, tangent), −1…1; the surface's normal n
  /// there has the component h along that axis. Only near-field models look at it.
  FiberBsdf(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye, float h);

  /// The fibers of a bundle: their mean over the rays that meet any of them. `others`: the bundle without the fiber that is met, as
  /// to_eye sees it. Aggregates of Marschner's lobes (of kMarschner and kChiang) or Zhu's; other models scatter as one fiber.
  FiberBsdf(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye, const kernel::ScatterBundle& others);
  /// The same of a fiber at `met` (world) in a bundle, `others` without it.
  FiberBsdf(const FiberMaterial& material, Vec3 strand_color, const ThickPlace& thick, Vec3 to_eye,
            const kernel::ScatterBundle& others, Vec3 met);

  /// f·cos θ_i, sum of the lobes. to_light: unit length, away from the fiber.
  Vec3 evaluate(Vec3 to_light) const;
  /// The same of one lobe, 0…3.
  Vec3 evaluate_lobe(Vec3 to_light, int lobe) const;
  /// Density with which sample() draws this direction, per solid angle; integrates to 1 wherever albedo() is not 0.
  float pdf(Vec3 to_light) const;
  /// u in [0, 1).
  FiberSample sample(std::array<float, 4> u) const;
  /// The direction of sample(), weighted by the chosen lobe alone where that is quicker: for paths that find light in no other
  /// way and so need not know how often they would have drawn a direction.
  ScatteredDirection scatter(std::array<float, 4> u) const;
  /// Integral of evaluate() over the sphere; of bundles within kAggregateAlbedoMaxError.
  Vec3 albedo() const;

 private:
  using Model =
      std::variant<fiber_models::Marschner, fiber_models::Zhu, fiber_models::KajiyaKay, fiber_models::Chiang,
                   fiber_models::Sadeghi, fiber_models::Pelekis, fiber_models::Aggregate<fiber_models::MarschnerFibers>,
                   fiber_models::Aggregate<fiber_models::ZhuFibers>>;
  FiberBsdf(Vec3 tangent, Vec3 to_eye, const FiberView& view);
  static FiberView view_of(const FiberMaterial& material, Vec3 strand_color, Vec3 tangent, Vec3 to_eye);
  static Model make_model(const FiberView& view);
  FiberAngles angles(Vec3 to_light) const;
  Vec3 world(const kernel::ScatterDirection& d) const;

  Vec3 tangent_, across_, side_;  // right-handed frame: along, in the plane of to_eye, and the rest
  Model model_;
};

}  // namespace pelage
