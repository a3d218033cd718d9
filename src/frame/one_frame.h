// One frame of a scene: the list of stages from strands to linear color, and the debug views.
#pragma once

#include <pelage/image.h>
#include <pelage/scene.h>

#include <optional>
#include <span>

#include "core/buffer.h"
#include "core/mesh_tracer.h"
#include "frame/frame.h"
#include "frame/stages.h"

namespace pelage {

struct DebugView;

/// What a frame is made from. Meshes and lights are the same for every camera; view and numbering belong together.
struct FrameInputs {
  const Scene& scene;
  const MeshTracer& meshes;
  const LightRig& rig;
  CameraView view;
  SegmentNumbering numbering;
  std::optional<CameraView> previous = {};  ///< where the view was a frame ago, for motion vectors; none: it stood still
  const Scene* before = nullptr;  ///< the same segments and meshes where they were a frame ago; null: they stood still
};

/// The scene with samples at `positions` of every pixel, 1, 2, 4, 8 or 16 of them: R, G, B, A, linear, premultiplied.
/// `nearest`, where given, becomes [h·w]: camera z of what the pixel's first sample sees, metres, +inf for nothing.
Image render_frame(const FrameInputs& inputs, std::span<const Vec2> positions, Stages& stages,
                   Buffer<float>* nearest = nullptr);

/// [h·w] camera z of what the middle of each pixel sees, strand or mesh, metres; +inf for nothing. No light.
/// `way`, where given, becomes [h·w] metres, world: from there to where the same place of the strand or mesh was in inputs.before. Pixels that see
/// nothing have that of a neighbor within two pixels. Empty where inputs.before is null.
Buffer<float> render_nearest(const FrameInputs& inputs, Stages& stages, Buffer<Vec3>* way = nullptr);

/// `what`, any View but kBeauty, kMotion, kLinked and kLinkAlpha: one sample in the middle of each pixel, no light.
DebugView render_debug_view(const FrameInputs& inputs, View what, Stages& stages);

}  // namespace pelage
