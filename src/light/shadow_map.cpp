#include "light/shadow_map.h"

#include <array>

#include "core/parallel.h"
#include "light/light_view.h"

namespace pelage {
namespace {

/// Square packets of rays stay together in the tree.
constexpr int kTile = 4;
static_assert(kTile * kTile == static_cast<int>(MeshTracer::kPacket));

/// Metres to step back from an orthographic light's plane so that every mesh is in front.
float step_back(const MeshTracer& meshes, const CameraView& view) {
  if (view.perspective) return 0;
  return length(to_camera(view, meshes.bounds().center())) + length(meshes.bounds().extent());
}

/// Ray through the centre of a texel; its parameter is the camera depth plus `back`.
Ray texel_ray(const CameraView& view, int x, int y, float back) {
  const float px = (static_cast<float>(x) + 0.5f - view.center_x) / view.focal;
  const float py = (static_cast<float>(y) + 0.5f - view.center_y) / view.focal;
  const Vec3 eye = view.perspective ? Vec3(0, 0, 0) : Vec3(px, py, -back);
  const Vec3 along = view.perspective ? Vec3(px, py, 1) : Vec3(0, 0, 1);
  return {transform_point(view.camera_to_world, eye), transform_vector(view.camera_to_world, along),
          view.perspective ? view.near_plane : 0};
}

}  // namespace

ShadowMap build_shadow_map(const MeshTracer& meshes, const CameraView& view) {
  ShadowMap map;
  if (meshes.empty()) return map;
  map.view = view;
  map.depth.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const float back = step_back(meshes, view);
  const int tile_columns = (view.width + kTile - 1) / kTile, tile_rows = (view.height + kTile - 1) / kTile;
  parallel_for(
      static_cast<std::size_t>(tile_columns) * static_cast<std::size_t>(tile_rows), 64,
      [&](std::size_t begin, std::size_t end) {
        std::array<Ray, MeshTracer::kPacket> rays;
        std::array<RayHit, MeshTracer::kPacket> hits;
        for (std::size_t tile = begin; tile < end; ++tile) {
          const int x0 = static_cast<int>(tile % static_cast<std::size_t>(tile_columns)) * kTile;
          const int y0 = static_cast<int>(tile / static_cast<std::size_t>(tile_columns)) * kTile;
          for (int i = 0; i < kTile * kTile; ++i)
            rays[static_cast<std::size_t>(i)] = texel_ray(view, x0 + i % kTile, y0 + i / kTile, back);
          meshes.trace(rays, hits);
          for (int i = 0; i < kTile * kTile; ++i) {
            const int x = x0 + i % kTile, y = y0 + i / kTile;
            if (x < view.width && y < view.height)
              map.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x)] =
                  hits[static_cast<std::size_t>(i)].distance - back;
          }
        }
      });
  return map;
}

}  // namespace pelage
