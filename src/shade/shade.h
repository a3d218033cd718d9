// Shade: one evaluation per strand that a pixel sees, under all lights.
#pragma once

#include <pelage/scene.h>

#include <span>

#include "frame/frame.h"
#include "frame/visibility.h"

namespace pelage {

struct ShadeBatch;
struct ShadeConstants;
/// Evaluates a batch: evaluate() or evaluate_scalar() of shade/evaluate.h.
using Evaluator = void (*)(const ShadeConstants&, ShadeBatch&);

/// Colors of the strands that `gbuffer` shows: of `sample_keys`, or of `center` where there are none.
///
/// Samples of a pixel that see the same segment share one evaluation, made at the first of them. `sample_positions` are
/// the places of the samples inside a pixel (of `center`: one, the middle). `view` and `numbering` are those that
/// the G-buffer was made with; `rig` is prepare_lights() of the same scene.
///
/// Runs wide on the active instruction set. Order and bits of `color` do not depend on the number of threads or on the
/// instruction set. Complexity: O(pixels · samples + evaluations · lights).
///
/// `visibility`, where given, becomes the visibility sample of every evaluation, in the order of `color`; its t is that on the
/// whole span, and throws Error where 30 bits do not number the spans.
Radiance shade(const Scene& scene, const CameraView& view, const SegmentNumbering& numbering, const GBuffer& gbuffer,
               const LightRig& rig, std::span<const Vec2> sample_positions, Buffer<StrandSample>* visibility = nullptr);

/// The same with another evaluator: the scalar reference of tests and benchmarks.
Radiance shade_with(Evaluator evaluator, const Scene& scene, const CameraView& view, const SegmentNumbering& numbering,
                    const GBuffer& gbuffer, const LightRig& rig, std::span<const Vec2> sample_positions,
                    Buffer<StrandSample>* visibility = nullptr);

}  // namespace pelage
