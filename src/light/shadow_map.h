// Depth of the opaque meshes as a light sees them, by rays.
#pragma once

#include "core/mesh_tracer.h"
#include "frame/frame.h"

namespace pelage {

/// One ray through the centre of each texel of `view`. Empty when there are no meshes. Deterministic.
ShadowMap build_shadow_map(const MeshTracer& meshes, const CameraView& view);

}  // namespace pelage
