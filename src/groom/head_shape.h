// The mannequin as an implicit surface: what its mesh, its collision grid and its scalp are made from.
#pragma once

#include <pelage/vec.h>

namespace pelage::groom {

/// Signed distance to the mannequin (head, neck, bust), metres, negative inside. Head centred near the origin at eye
/// level, facing +Z, chin to crown 0.24 m; first-order exact at the surface.
float head_distance(Vec3 p);

/// Unit outward gradient of head_distance().
Vec3 head_normal(Vec3 p);

/// Texture coordinate of a place on the head: azimuthal equidistant projection from the crown, so that the whole scalp
/// has no seam; (0.5, 0.5) is the crown, the face lies toward v = 0.
Vec2 head_uv(Vec3 p);

/// Box that holds the mannequin with room around it.
inline constexpr Vec3 kHeadLower{-0.205f, -0.285f, -0.150f};
inline constexpr Vec3 kHeadUpper{0.205f, 0.135f, 0.145f};

}  // namespace pelage::groom
