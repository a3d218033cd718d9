// How wide thick hairs look: a hair at once, a control point per lane.
#pragma once

#include <pelage/lod.h>

#include <array>
#include <cstdint>

#include "frame/frame.h"

namespace pelage {

/// Where a groom's chain stands in a scene: what choosing and drawing levels needs of it.
struct LodPlace {
  const LodHierarchy& lod;
  const CameraView& view;
  Affine to_camera;  ///< object → camera, a similarity
};

/// The eye in the space of a groom.
class LodEye {
 public:
  explicit LodEye(const LodPlace& place);

  bool perspective;
  Vec3 place;    ///< of the eye; in orthographic views the direction to it
  Vec3 forward;  ///< depth of p in the camera's metres: dot(forward, p) + depth
  float depth;
  float near_plane;  ///< metres
  float pixels;      ///< that a metre of the groom takes at depth 1, or at any depth in orthographic views

  /// Direction from `p` to the eye, of any length.
  Vec3 from(Vec3 p) const { return perspective ? place - p : place; }
};

/// Widths of a thick hair at its control points: the shadow of its ellipse across the hair, as section_extent() says.
struct HairWidths {
  alignas(64) std::array<float, LodHierarchy::kPoints> metres;  ///< in the groom's space
  alignas(64) std::array<float, LodHierarchy::kPoints> pixels;  ///< INFINITY before the near plane
};
HairWidths hair_widths(const LodHierarchy& lod, const LodEye& eye, std::uint32_t hair);

}  // namespace pelage
