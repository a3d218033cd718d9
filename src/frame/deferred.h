// What flows through a frame of method swr: deferred software rasterization of hair meshes (Lipp 2026; references.bib:
// Lipp2026Deferred).
//
//   HairMesh ─lod▶ LodSelection ─assemble▶ ScreenBlock ─raster▶ DeferredBuffer ─shade▶ Radiance ─filter▶ HairPicture
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/buffer.h"
#include "frame/frame.h"
#include "kernel/scalar.h"

namespace pelage {

struct PreparedHairMesh;  // groom/hairmesh/prepared.h
struct ShadeConstants;    // shade/batch.h

/// The grooms of a scene that are hair meshes, ready to be drawn: made once, whatever the camera does.
struct DeferredGroom {
  std::uint32_t groom = 0;  ///< its number in the scene
  std::shared_ptr<const PreparedHairMesh> mesh;
};

/// What shading of a scene's grooms under its lights shares from frame to frame: tables of the materials. Refers to the rig.
class DeferredMaterials {
 public:
  DeferredMaterials() = default;
  DeferredMaterials(const Scene& scene, std::span<const DeferredGroom> grooms, const LightRig& rig);
  /// [grooms]
  const std::vector<ShadeConstants>& constants() const { return *constants_; }

 private:
  std::shared_ptr<const std::vector<ShadeConstants>> constants_;
};

/// A bundle that is drawn.
struct BundleDraw {
  std::uint32_t groom = 0, bundle = 0;  ///< of the DeferredGrooms, of its mesh
  std::uint32_t strands = 0;            ///< N_LOD of Lipp 2026, eq. 1: the first ones
  std::uint32_t points = 0;             ///< C of eq. 5, of each
  float width_scale = 1;                ///< by which strands are wider, for those that are left out
  float nearest = 0;                    ///< metres, camera depth of its box; of several views the least
  std::uint32_t views = 1;              ///< bit v: view v may see it
};

/// Views that may share their strands.
inline constexpr std::size_t kMostViews = 32;

/// What lod makes of all bundles: those that some view may see, nearest first.
struct LodSelection {
  std::vector<BundleDraw> bundles;
  std::uint64_t strands = 0, points = 0;  ///< of all of them
};

/// How much of the 18 bits of uvw a groom has: with several of them each gets a square of cells of its own, so that a pixel
/// tells its groom.
struct UvCells {
  std::uint32_t first_u = 0, first_v = 0, count = 64;
};
inline constexpr std::uint32_t kUvCells = 64;  ///< a side
/// Of groom `i` of `grooms` ≤ 4096.
UvCells uv_cells(std::size_t i, std::size_t grooms);

/// 64-bit pixel of deferred software rasterization; a smaller one is nearer, equal depths are settled by the other bits, so the
/// winner is the same in any order. Empty: all ones (kEmptyPixel).
///   bits 63…40  depth: raster_depth_level()
///   bits 39…24  tangent, root to tip, world space: raster_octahedral(), 8 bits x, 8 bits y
///   bits 23…6   u, v (cells of the groom) and w, 6 bits each
///   bits 5…0    ambient occlusion
namespace deferred {
inline constexpr PixelKey kPayload = (PixelKey{1} << 40) - 1;  ///< all of them set: no strand
inline bool is_strand(PixelKey key) { return (key & kPayload) != kPayload; }
inline std::uint32_t depth_level(PixelKey key) { return static_cast<std::uint32_t>(key >> 40); }
inline std::uint32_t u_cell(PixelKey key) { return static_cast<std::uint32_t>(key >> 18) & 63; }
inline std::uint32_t v_cell(PixelKey key) { return static_cast<std::uint32_t>(key >> 12) & 63; }
inline std::uint32_t w_cell(PixelKey key) { return static_cast<std::uint32_t>(key >> 6) & 63; }
inline float occlusion(PixelKey key) { return static_cast<float>(key & 63) * (1.f / 63); }
inline Vec3 tangent(PixelKey key) {
  const auto level = [&](int shift) {
    return kernel::raster_tangent_of_level(static_cast<float>(static_cast<std::uint32_t>(key >> shift) & 255));
  };
  return kernel::raster_from_octahedral({level(32), level(24)});
}
}  // namespace deferred

/// The depth of 24 bits: linear between the near and the far end of all hair.
struct DepthRange {
  float near_end = 0, far_end = 1;  ///< metres, camera depth
  float levels_per_metre() const { return kernel::kRasterDepthLevels / (far_end - near_end); }
  float metres(std::uint32_t level) const {
    return kernel::raster_depth_of_level(static_cast<float>(level), near_end, levels_per_metre());
  }
};

/// What raster makes of the strands: the part of the picture that hair can reach. Layers that were not asked for are empty.
struct DeferredBuffer {
  CameraView view;        ///< of the part: its center is moved, width × height are the part's
  int left = 0, top = 0;  ///< pixel of the picture that the part begins with
  int samples = 1;        ///< per pixel in `sample_keys`: 2, 4, 8
  DepthRange range;
  Buffer<PixelKey> center;        ///< [h·w] a strand's band covers the pixel's center
  Buffer<PixelKey> conservative;  ///< [h·w] a strand touches the pixel, or covers its center
  /// [h·w] with the conservative layer and an opaque scene: how deep that is where the center shows no strand, as a share of the
  /// range from its near end on, 0…1; above 1: there is none, or a strand is shown.
  Buffer<float> opaque;
  Buffer<PixelKey> sample_keys;  ///< [h·w·samples]
  Buffer<float> coverage;        ///< [h·w] share of the pixel that strands cover, 0…1: raster/coverage.h
};

/// The hair of the part of the picture that a DeferredBuffer shows, without its background.
struct HairPicture {
  int left = 0, top = 0, width = 0, height = 0;  ///< pixels
  Buffer<Vec4> color;                            ///< [h·w] premultiplied linear R, G, B and opacity
};

}  // namespace pelage
