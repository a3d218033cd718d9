// The part of a picture that something can be seen in: what frames are made of, without the empty rest.
#pragma once

#include "core/mesh_tracer.h"
#include "frame/frame.h"

namespace pelage {

/// Pixels [x, x + width) × [y, y + height) of a picture.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where `view` may see strands, which are in `strands` (world space; empty: anywhere), or meshes. A box that reaches before the near plane may be
/// seen anywhere.
Window window_of(const CameraView& view, const Bounds& strands, const MeshTracer& meshes);

/// What `window` shows of the picture of `view`.
CameraView view_of(CameraView view, const Window& window);

}  // namespace pelage
