// The opaque scene behind and between the strands: primary rays, shaded with the same lights as the hair.
#pragma once

#include <pelage/scene.h>

#include <span>

#include "core/mesh_tracer.h"
#include "frame/frame.h"

namespace pelage {

/// One ray per sample of every pixel; `sample_positions` are their places inside a pixel, 0…1, at most 16 of them: those
/// of the strands' sample layers, so that depths compare. Samples of a pixel that see the same surface share one shade.
///
/// Shading: Lambert and GGX under the rig's lights, shaded by meshes (rays) and by strands (opacity maps); the
/// environment by its irradiance, which the coat mirrors too, and the share of its pieces that are seen. `scene.settings.shadows` rules both.
/// The buffers are empty when `meshes` is. Deterministic for any thread count.
OpaqueLayer trace_opaque(const Scene& scene, const CameraView& view, std::span<const Vec2> sample_positions,
                         const MeshTracer& meshes, const LightRig& rig);

}  // namespace pelage
