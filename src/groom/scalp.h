// Where hair grows on the mannequin, and which way it leaves the skin.
#pragma once

#include <pelage/vec.h>

namespace pelage::groom {

/// Height of the hairline, metres (y), at `azimuth` radians 0…π from the front of the axis through kHeadAxis.
float hairline_height(float azimuth);
inline constexpr Vec3 kHeadAxis{0, 0, -0.012f};

/// Height above the hairline, metres; positive on the hairy side. Slightly irregular.
float hairline_distance(Vec3 p);

/// Density of roots, 0…1: full on the scalp, thinning over the last millimetres before the hairline.
float scalp_density(Vec3 p);

/// Tangential combing direction of hair that falls from a parting, `parting_x` metres left of the head's middle, to a
/// whorl at the crown. Not normalised.
Vec3 parting_flow(Vec3 p, Vec3 normal, float parting_x);

/// Tangential direction in which uncombed short hair grows: out of the whorl in a spiral, forward, down and back.
Vec3 whorl_flow(Vec3 p, Vec3 normal);

}  // namespace pelage::groom
