// The opaque meshes of a scene as one committed ray-tracing scene: nearest hits, occlusion and surface look-up.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace pelage {

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< need not be unit length; distances are in its units
  float near = 0;  ///< hits nearer than this are ignored
  float far = INFINITY;
};

struct RayHit {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  float distance = INFINITY;
  std::uint32_t mesh = kNone;  ///< index into Scene::meshes
  std::uint32_t triangle = 0;
  float u = 0, v = 0;  ///< barycentric weights of the triangle's second and third corner
};

/// What shading needs to know of a hit.
struct Surface {
  Vec3 position;          ///< metres, world
  Vec3 normal;            ///< shading normal, unit length, on the side that the triangle's winding calls outside
  Vec3 geometric_normal;  ///< the triangle's own, unit length, same side as `normal`
  Vec3 color;             ///< diffuse reflectance, linear
};

/// Holds world-space copies of the meshes; the Scene itself is not kept. Queries are const and thread-safe.
class MeshTracer {
 public:
  static constexpr std::size_t kPacket = 16;

  explicit MeshTracer(const std::vector<MeshInstance>& meshes);
  ~MeshTracer();
  MeshTracer(MeshTracer&&) noexcept;

  bool empty() const;
  const Bounds& bounds() const;
  std::size_t bytes() const;

  /// Nearest hit of each ray; `hits` has the size of `rays`, at most kPacket. Best for rays that run side by side.
  void trace(std::span<const Ray> rays, std::span<RayHit> hits) const;
  /// Whether anything lies on each ray; sizes as for trace().
  void occluded(std::span<const Ray> rays, std::span<bool> result) const;
  Surface surface(const RayHit& hit) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelage
