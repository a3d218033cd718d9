// The visibility buffer of strand linking: one fragment of a strand a pixel.
#pragma once

#include <pelage/scene.h>

#include <cstddef>
#include <cstdint>

#include "core/buffer.h"
#include "core/pixel_mask.h"
#include "frame/frame.h"
#include "frame/segment_lookup.h"

namespace pelage {

/// What a visibility pixel shows, in the four words of Huang 2025, §5.1 (references.bib: Huang2025Linking).
///
/// A primitive is a span of a strand, numbered through all grooms (span s of strand i of groom g: spans of the grooms before +
/// offsets[i] + s), or whatever another renderer numbers its strands by.
struct VisibilitySample {
  float normal_x = 0, normal_y = 0;  ///< unit normal of the strand on the screen: its tangent, turned by 90°; 0, 0 seen end-on
  float t = 0;                       ///< place on the primitive, 0…1 from root to tip
  std::uint32_t bits = 0;            ///< bit 0: hair; bit 1: filled by linking; bits 2…31: primitive

  static constexpr std::uint32_t kHair = 1, kFilled = 2, kMaxPrimitive = (1u << 30) - 1;
  bool is_hair() const { return bits & kHair; }
  bool is_filled() const { return bits & kFilled; }
  std::uint32_t primitive() const { return bits >> 2; }
  /// Unit tangent on the screen, root to tip (x right, y down).
  Vec2 tangent() const { return {normal_y, -normal_x}; }
};
static_assert(sizeof(VisibilitySample) == 16);

/// `primitive` ≤ kMaxPrimitive; `tangent` a unit vector on the screen, or 0.
inline VisibilitySample pack_visibility(Vec2 tangent, float t, std::uint32_t primitive, bool filled) {
  return {-tangent.y, tangent.x, t, primitive << 2 | (filled ? VisibilitySample::kFilled : 0) | VisibilitySample::kHair};
}

/// A sample as shade finds it: what its packing has no word for comes along.
struct StrandSample {
  VisibilitySample visibility;
  float thickness = 0;  ///< diameter of the strand, pixels
};

/// Ids of VisibilitySample::primitive() for a scene: those of its segments, would every span be one. Throws Error where 30 bits
/// do not name them.
SegmentNumbering number_spans(const Scene& scene);

/// From segments of a G-buffer to what visibility pixels hold. Refers to the scene and all else.
class VisibilityPacker {
 public:
  VisibilityPacker(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering);
  /// `surface` is that of the segment at t (frame/segment_lookup.h).
  StrandSample sample(const SegmentRef& segment, float t, const StrandSurface& surface) const;

 private:
  const Scene& scene_;
  const CameraView& view_;
  const SegmentNumbering& numbering_;
  SegmentNumbering spans_;
};

/// One sample of hair a visibility pixel, in the part of the picture where hair is. A screen pixel is a square of `side`²
/// visibility pixels (side 1: one sample a pixel).
struct StrandLayer {
  int width = 0, height = 0;            ///< visibility pixels, multiples of side
  int left = 0, top = 0;                ///< visibility pixel of the picture that its first one is, multiples of side
  int side = 1;                         ///< visibility pixels a side of a screen pixel
  Buffer<VisibilitySample> visibility;  ///< [h·w]
  PixelMask hair;                       ///< where these show hair, hit or filled
  Buffer<float> depth;                  ///< [h·w] camera z of the strand, metres; +inf for none
  Buffer<Vec3> color;                   ///< [h·w] its scene-linear radiance; 0 for none
  Buffer<float> thickness;              ///< [h·w] its diameter, visibility pixels; or empty where nobody knows
  Buffer<float> coverage;               ///< [h·w] share of the pixel that strands cover, 0…1; or empty where nobody knows
  Buffer<float> opaque_depth;           ///< [h·w] camera z of the opaque scene, +inf for none; or empty without one

  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  /// Of visibility pixel (x, y) of the layer.
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  /// f(p) for the visibility pixels p of screen pixel (x, y) of the layer.
  template <class F>
  void for_each_sample(int x, int y, const F& f) const {
    for (int j = y * side; j < (y + 1) * side; ++j)
      for (int i = x * side; i < (x + 1) * side; ++i) f(index(i, j));
  }
};

/// Makes layer.hair what layer.visibility shows.
void mark_hair(StrandLayer& layer);

/// What all of the picture shows without hair, by visibility pixel.
struct Behind {
  int width = 0, height = 0;  ///< visibility pixels
  Buffer<float> depth;        ///< [h·w] camera z of the opaque scene, metres, +inf for none; or empty without one
  OpaqueLayer opaque;         ///< its colors; its own depth is moved to the above
  Backdrop backdrop;          ///< what is seen elsewhere
  Buffer<Vec4> color;         ///< [h·w] instead of all that: linear, premultiplied R, G, B, A; or empty

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  /// Of the pixel with this index: linear, premultiplied R, G, B, A.
  Vec4 at(std::size_t p) const;
};

}  // namespace pelage
