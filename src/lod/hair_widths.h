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

/// How wide a thick hair is drawn: of `fibers` fibers with diameter `fiber` that lie at random in a band of width `band`, the mean part of
/// the band that is covered, band·(1 − (1 − fiber/band)^fibers). One fiber is as wide as itself, dense hair as its band. A share of them, s·fibers and (1 − s)·fibers, passes
/// in product what all of them do; below one fiber it goes to 0. Metres.
float covered_width(float band, float fiber, float fibers);

/// Fibers that are `length_ratio` times as long as the center they wind about: how many times as much hair a line of sight across meets.
/// They lean by δ, cos δ = 1/ratio, toward all sides alike; what leans along the line of sight is seen as short as the center. Mean of
/// the projected lengths: the perimeter of an ellipse with semi-axes `length_ratio` and 1 over 2π. 1 where the ratio is below 1.
float crossing_ratio(float length_ratio);

/// Such fibers' variance of direction about the center's, along each axis across it: sin²δ/2. Radians², 0…½.
float direction_variance(float length_ratio);

/// By how much the picture of a thick hair differs from that of its fibers, at its control points: variance of light, in units of the contrast of hair.
///
/// A band of width W pixels stands for fibers that cover D of it: hair has the same density on the scale of W, and below it is grain, white noise of
/// density D instead of the fibers' own, which hardly counts. Leaning fibers are bright and dark in turn over lengths of W: more grain, kLeanGrain σ² W.
/// Eyes see what is coarser than kFinestSeen pixels, so the variance is (D + kLeanGrain σ² W)·(1/kFinestSeen − 1/W), 0 where W is below. INFINITY before the near plane.
struct HairErrors {
  alignas(64) std::array<float, LodHierarchy::kPoints> variance;
};
HairErrors hair_errors(const LodHierarchy& lod, const LodEye& eye, std::uint32_t hair);
inline constexpr float kLeanGrain = 2, kFinestSeen = 1.5f;

}  // namespace pelage
