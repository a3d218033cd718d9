// What a path tracer cannot digest.
#pragma once

#include <pelage/scene.h>

namespace pelage {

/// Throws Error naming the first value of `scene` that is not finite (pictures: with the pixel), or a size out of range.
/// Files are checked when they are read; this is for scenes that a program made, and for pictures, which may hold anything.
void check_scene(const Scene& scene);

}  // namespace pelage
