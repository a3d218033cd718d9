// One frame of method swr: deferred software rasterization of hair meshes (Lipp 2026).
#pragma once

#include <pelage/image.h>

#include <span>
#include <vector>

#include "frame/deferred.h"
#include "frame/one_frame.h"

namespace pelage {

/// The grooms of `scene`, ready to be drawn. Throws Error where one is no hair mesh, or there are more than a pixel can tell apart.
std::vector<DeferredGroom> prepare_deferred(const Scene& scene);

/// `scene` with strands in place of its hair meshes that suffice for maps of light: a few thousand of each, widened for the rest.
Scene light_stand_in(const Scene& scene);

/// The scene, linear: R, G, B, A, premultiplied.
Image render_deferred(const FrameInputs& inputs, std::span<const DeferredGroom> grooms, Stages& stages);

}  // namespace pelage
