// Light, made ready for shading: deep opacity maps for the strands, shadow maps for the meshes, the environment in pieces.
#pragma once

#include <pelage/scene.h>

#include "core/mesh_tracer.h"
#include "frame/frame.h"

namespace pelage {

/// Prepares every light of `scene` and its environment. Lights of no intensity are left out; a point light inside the
/// grooms becomes six, one for each face of the cube that it sees.
///
/// `meshes` holds the scene's meshes; what they shade is kept in shadow maps.
/// Without `settings.shadows`, or where Light::casts_shadow is false, the maps are empty.
/// Complexity: O(lights · (control points + map texels)). The result does not depend on the number of threads.
LightRig prepare_lights(const Scene& scene, const MeshTracer& meshes);

/// Bytes that the maps hold.
std::size_t resident_bytes(const LightRig& rig);

}  // namespace pelage
