// Light as the path tracer looks for it: lights without a size, and the environment.
#pragma once

#include <pelage/scene.h>

#include <array>
#include <cstddef>
#include <vector>

#include "frame/light_lookup.h"

namespace pelage {

/// Radiance of the environment with a density to sample its directions by.
class EnvironmentSampler {
 public:
  explicit EnvironmentSampler(const Environment& environment);

  bool black() const { return black_; }
  /// Whether it looks the same everywhere: the density is uniform.
  bool uniform() const { return rows_.empty(); }
  /// As environment_radiance(), never negative.
  Vec3 radiance(Vec3 direction) const;
  /// Density of sample() over solid angle.
  float pdf(Vec3 direction) const;
  /// u in [0, 1). Directions are drawn from the map's texels by the luminance around them, and a few from everywhere.
  Vec3 sample(Vec2 u) const;
  /// About ∫ luminance dω.
  float power() const { return power_; }
  std::size_t bytes() const;

 private:
  float map_pdf(Vec2 place) const;

  Environment environment_;
  bool black_ = true;
  float power_ = 0;
  std::vector<float> rows_;     ///< [height + 1] cumulative share of the rows; empty without a map
  std::vector<float> columns_;  ///< [height · (width + 1)] the same within each row
};

/// A light toward which a ray is shot.
struct LightRay {
  Vec3 to_light;              ///< unit length
  float distance = INFINITY;  ///< metres
  Vec3 arriving;              ///< W/m² for a light without a size; radiance over its density for the environment
  float pdf = 0;              ///< of the environment's direction per solid angle, with its choice; 0: a light without a size
  bool casts_shadow = true;
};

/// All light of a scene.
class LightSampler {
 public:
  explicit LightSampler(const Scene& scene);

  const EnvironmentSampler& environment() const { return environment_; }
  const std::vector<Light>& lights() const { return lights_; }

  /// Light number i at p.
  LightRay toward(std::size_t i, Vec3 p) const;
  /// A direction of the environment, chosen with probability `chance` instead of other things.
  LightRay toward_environment(Vec2 u, float chance) const;

  /// One of the lights, or the environment where `with_environment` (index lights().size()), by about how bright they are.
  struct Choice {
    std::size_t index = 0;
    float chance = 0;  ///< 0: there is none
  };
  Choice choose(float u, bool with_environment) const;
  /// Probability that choose(…, true) takes the environment.
  float environment_chance() const;

 private:
  std::vector<Light> lights_;  ///< those that shine, directions of unit length
  EnvironmentSampler environment_;
  std::vector<float> cumulative_;  ///< [lights + 1] of their power; the environment's is beyond the last
};

}  // namespace pelage
