// Every arrow of the data-flow diagram is one plain struct here; stages talk to each other through these alone.
//
//   posed strands ─assemble▶ ScreenBlock ─raster▶ GBuffer ─shade▶ Radiance ─composite▶ Image
//                      light ─▶ OpacityMap, ShadowMap ──────┘
#pragma once

#include <pelage/image.h>
#include <pelage/scene.h>
#include <pelage/vec.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/buffer.h"

namespace pelage {

/// A camera made ready for projection. Pixel (0, 0) is the top left one; pixel centres are at +0.5.
///
/// Camera space: x right, y down, z forward, metres, eye at the origin. Perspective: screen = center + focal·(x, y)/z;
/// orthographic: screen = center + focal·(x, y), focal in pixels per metre.
struct CameraView {
  Affine world_to_camera;
  Affine camera_to_world;
  float focal = 1;       ///< pixels (perspective) or pixels per metre (orthographic)
  float center_x = 0;    ///< pixels
  float center_y = 0;    ///< pixels
  float near_plane = 0;  ///< metres, > 0
  int width = 0;         ///< pixels
  int height = 0;        ///< pixels
  bool perspective = true;
};

/// The curve segments of all grooms are numbered through: segment k of span s of strand i of groom g has the id
///   groom_base[g] + (offsets[i] + s)·subdivisions + k,
/// so an id (and t on the segment) names a place on a strand without any table. Bézier spans: s counts spans.
struct SegmentNumbering {
  std::vector<std::uint32_t> groom_base;    ///< [groom_count + 1]; the last is the number of ids
  std::vector<std::uint32_t> subdivisions;  ///< [groom_count] segments per span, ≥ 1
};

/// A run of projected polyline points, on its way from assemble to raster: a few thousand, then reused.
///
/// Point j and point j + stride bound a segment where `id[j] != kNoSegment`. Bands are camera-facing; kernel/raster/band.h
/// says which points of the screen a band covers. The line through point j across (cap_x, cap_y) is where the band of
/// one segment ends and that of the next begins, so neighbours share an edge exactly.
struct ScreenBlock {
  static constexpr std::uint32_t kNoSegment = 0xffffffffu;
  static constexpr std::size_t kPadding = 64;  ///< valid floats behind the points, for whole-lane loads
  std::size_t count = 0;                       ///< points in use; arrays hold kPadding more behind them
  std::size_t stride = 1;                      ///< from a point to the next one of its strand
  Buffer<float> x, y;                          ///< pixels; may lie outside the image, at most kGuardBand from it
  Buffer<float> depth;                         ///< camera-space z, metres; ≥ near_plane (clipped)
  Buffer<float> radius;                        ///< pixels, half the band's width
  Buffer<float> cap_x, cap_y;  ///< direction of the strand at the point, halfway between its two segments; any length
  Buffer<std::uint32_t> id;    ///< id of the segment that starts here, kNoSegment at a strand's last point
  Buffer<std::uint32_t> payload_high,
      payload_low;  ///< of strands of hair meshes: bits 39…32 and 31…0 of a DeferredBuffer's pixel
};

/// 64-bit pixel of the nearest-wins layers. A smaller key is nearer; equal depths are settled by the id, so the
/// winner is the same in any order. Empty: all ones.
///   bits 63…32  depth, IEEE bits of a positive float (order-preserving), metres
///   bits 31…0   segment id
using PixelKey = std::uint64_t;
inline constexpr PixelKey kEmptyPixel = ~PixelKey{0};

/// What raster makes of all strands. Layers that were not asked for are empty.
struct GBuffer {
  int width = 0, height = 0;                        ///< pixels
  int samples = 1;                                  ///< sample positions per pixel in `sample_keys`: 1, 2, 4, 8, 16
  Buffer<PixelKey> center;                          ///< [h·w] the band covers the pixel's centre
  Buffer<PixelKey> conservative;                    ///< [h·w] the band touches the pixel anywhere
  Buffer<PixelKey> sample_keys;                     ///< [h·w·samples] the band covers the sample; samples of a pixel adjacent
  static constexpr float kCoverageUnit = 0x1p-16f;  ///< optical depth per unit of `coverage`
  Buffer<std::uint32_t> coverage;     ///< [h·w] analytic: optical depth of the strands, fixed point; analytic_coverage()
  Buffer<std::int32_t> tangent_cos2;  ///< [h·w] Σ area·cos 2ψ, ψ the screen angle of the band; fixed point
  Buffer<std::int32_t> tangent_sin2;  ///< [h·w] Σ area·sin 2ψ
  Buffer<std::uint32_t> overdraw;     ///< [h·w] fragments tested; only for the debug view
  Buffer<float> opaque_depth;         ///< OpaqueLayer::depth, handed over to raster; empty without meshes
};

/// Share of the pixel that strands cover, 0…1. Strands are independent of each other: transmittances multiply.
inline float analytic_coverage(const GBuffer& g, std::size_t pixel) {
  return -std::expm1(-static_cast<float>(g.coverage[pixel]) * GBuffer::kCoverageUnit);
}

/// Opaque scene behind and between the strands, by primary rays. Samples of a pixel that see the same surface share a color.
struct OpaqueLayer {
  static constexpr std::uint8_t kNone = 0xff;
  int width = 0, height = 0, samples = 1;
  Buffer<float> depth;          ///< [h·w·samples] camera z, metres; +inf where nothing is hit. Read by raster alone
  Buffer<std::uint32_t> first;  ///< [h·w] where the colors of a pixel's samples begin in `color`
  Buffer<std::uint8_t> shade;   ///< [h·w·samples] the sample's color, counted from there; kNone where nothing is hit
  Buffer<Vec3> color;           ///< shaded linear radiance of every distinct surface of every pixel
};

/// Radiance of sample `sample` (numbered through all pixels); 0 where nothing is hit.
inline Vec3 opaque_color(const OpaqueLayer& layer, std::size_t sample) {
  if (layer.shade[sample] == OpaqueLayer::kNone) return {0, 0, 0};
  return layer.color[layer.first[sample / static_cast<std::size_t>(layer.samples)] + layer.shade[sample]];
}

/// Deep opacity map of one light: how many strands lie between the light and a place (Yuksel & Keyser 2008).
/// Crossings are expectations: the mean over a texel's rays of the number of strands that a ray meets.
struct OpacityMap {
  static constexpr int kLayers = 8;
  static constexpr float kCrossingUnit = 1.f / 8192;  ///< strands per unit of `crossings`
  static constexpr int kOriginBlock = 4;              ///< texels a side that share one first depth
  CameraView view;                                    ///< the light as a camera; its width × height are the map's
  Buffer<float> first_depth;               ///< [⌈h/4⌉·⌈w/4⌉] depth of a block's first strand, metres; +inf for none
  std::array<float, kLayers> layer_end{};  ///< metres behind first_depth at which layer i ends; increasing
  Buffer<std::uint32_t> crossings;         ///< [h·w·kLayers] strands crossed up to layer_end[i], fixed point; linear between
};

/// Depth of the opaque meshes as a light sees them.
struct ShadowMap {
  CameraView view;
  Buffer<float> depth;  ///< [h·w] camera z, metres; +inf for none
};

/// A light ready for shading.
struct PreparedLight {
  Light light;
  float spread = 0;           ///< radians, standard deviation of its directions; > 0: a piece of the environment
  bool only_in_view = false;  ///< one face of a light inside the hair: lights what `opacity.view` sees
  OpacityMap opacity;         ///< empty when the light casts no shadow
  ShadowMap shadow;           ///< empty when there is no mesh
};

/// The environment blurred by lobes of growing roughness (kernel/light/probe.h), each a map of the octahedron.
struct EnvironmentProbe {
  Buffer<float> texels;  ///< [kProbeLevels · 3 · (kProbeSide + 2)²] planes of R, G and B, W/(m²·sr); empty: no probe
};

/// All light of a scene.
struct LightRig {
  std::vector<PreparedLight> lights;  ///< lights of the scene, then pieces of the environment
  EnvironmentProbe probe;             ///< instead of pieces of the environment, where the settings ask for it
  std::array<Vec3, 9> irradiance{};   ///< environment on a diffuse surface by its normal, W/m²: real spherical harmonics
  Bounds strands;                     ///< that the maps are of, widths included; world space. Empty: not known
};

/// Shaded colour of every distinct visible strand sample of a G-buffer: what composite spreads over pixels.
/// Sample i of pixel p has the colour `color[index[p·samples + i]]`, kNone where no strand is visible.
struct Radiance {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  Buffer<std::uint32_t> index;  ///< [h·w·samples]
  Buffer<Vec3> color;           ///< scene-linear radiance, W/(m²·sr)
};

/// What is seen where there is neither strand nor mesh.
struct Backdrop {
  Vec3 color;           ///< scene-linear radiance
  float alpha = 1;      ///< 0: the picture stays transparent there
  Buffer<Vec3> pixels;  ///< [h·w], instead of `color`; or empty
};

}  // namespace pelage
