// The opaque meshes of a scene as one committed ray-tracing scene: nearest hits, occlusion and surface look-up.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <memory>
#include <span>

#include "core/world_mesh.h"

namespace pelage {

/// Holds world-space copies of the meshes; the Scene itself is not kept. Queries are const and thread-safe.
class MeshTracer {
 public:
  static constexpr std::size_t kPacket = 16;

  explicit MeshTracer(const std::vector<MeshInstance>& meshes);
  ~MeshTracer();
  MeshTracer(MeshTracer&&) noexcept;
  MeshTracer& operator=(MeshTracer&&) noexcept;

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
