// Where hair grows on the mannequin, and which way it leaves the skin.
#pragma once

#include <pelage/vec.h>

#include <cstdint>

namespace pelage::groom {

/// Signed distance to the hairline along the skin, roughly, metres; positive on the hairy side. Slightly irregular.
float hairline_distance(Vec3 p);

/// Density of roots, 0…1: full on the scalp, thinning over the last millimetres before the hairline.
float scalp_density(Vec3 p);

struct Parting {
  float x = 0.016f;           ///< metres, where the parting runs; right of the middle as the head sees it when negative
  float sharpness = 200;      ///< 1/metre
};
/// Tangential combing direction of a haircut that falls from a parting and a crown whorl. Not normalised, never zero on
/// the scalp.
Vec3 parting_flow(Vec3 p, Vec3 normal, const Parting& parting);

}  // namespace pelage::groom
