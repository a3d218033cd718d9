// The path tracer: one sample of one pixel of a scene, as a pure function.
#pragma once

#include <pelage/scene.h>
#include <pelage/trace.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace pelage {

/// How light is found. All three have the same mean; lights without a size are always looked for from the surface.
enum class Technique {
  kMis,   ///< both, weighted by the power heuristic
  kNee,   ///< by rays toward the lights
  kBsdf,  ///< by the rays that scatter
};

struct PathSettings {
  Integrator integrator = Integrator::kPath;
  Technique technique = Technique::kMis;
  CurveShape curve_shape = CurveShape::kFlat;  ///< kDual counts bands, whatever stands here
  int max_bounces = 70;                        ///< scattering events of a path, ≥ 1
  int first_roulette = 1;  ///< scattering events after which paths that carry little may end by chance, ≥ 0; the mean stays
  bool shadows = true;     ///< false: nothing keeps a light's or the environment's own light off
  std::uint64_t seed = 0;  ///< another seed, other random numbers
  std::vector<Vec2> positions;            ///< in the pixel, from its top left corner, 0…1: sample i stands at
                                          ///< positions[i % size]; empty: anywhere in the pixel
  std::optional<Camera> previous_camera;  ///< of the frame before, for PathSample::motion; none: it stood still
  bool split = false;                     ///< fill PathSample::split
};

/// Radiance taken apart; both sums are PathSample::radiance.
struct PathSplit {
  static constexpr std::size_t kBounces = 16, kLobes = 5;
  std::array<Vec3, kBounces> bounces{};  ///< by the scattering events between source and first hit; the last takes the rest
  std::array<Vec3, kLobes> lobes{};      ///< by what the first hit did to it: R, TT, TRT, rest, surface
};

/// What a ray through a pixel brought back, and the place that it met first.
struct PathSample {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  Vec3 radiance;           ///< scene-linear, W/(m²·sr); 0 where alpha is 0
  float alpha = 0;         ///< 1 where a strand, a mesh or a visible environment is hit, else 0
  bool hair = false;       ///< a strand is hit first
  float depth = INFINITY;  ///< camera z, metres; +inf where nothing is hit
  Vec3 position;           ///< metres, world; on the strand's axis; 0 where nothing is hit, like all that follows
  Vec3 tangent;            ///< unit length, root to tip, world; 0 on meshes
  Vec3 normal;             ///< unit length, world, facing the eye; on strands across the tangent
  std::uint32_t groom = kNone, strand = kNone;  ///< indices into Scene::grooms and its strands
  float u = 0;                                  ///< 0 at the root … 1 at the tip
  float width = 0;                              ///< diameter, metres
  Vec3 albedo;                                  ///< share of light that the first hit scatters, all directions together
  Vec2 motion;                                  ///< pixels from this sample to where its place was a frame before
  std::optional<PathSplit> split;               ///< where asked for
};

/// A scene made ready for rays: strands as curves of their basis, meshes as triangles, lights with their densities.
///
/// Holds copies of what it needs in world space and shares strands, images and meshes with `scene`, which need not outlive
/// it. Throws Error where the camera is out of range or the acceleration structure cannot be built.
class PathTracer {
 public:
  PathTracer(const Scene& scene, const PathSettings& settings);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;

  /// Sample `index` of pixel (x, y), 0 ≤ x < settings.width of the scene, likewise y. A pure function of scene, settings,
  /// pixel and index, and thread-safe. Always finite.
  PathSample sample(int x, int y, std::uint32_t index) const;

  std::size_t curve_count() const;  ///< spans of all strands
  std::size_t bytes() const;        ///< held, the acceleration structure included

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelage
