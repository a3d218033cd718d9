// Motion vectors: where on the screen things were a frame ago.
#pragma once

#include <pelage/image.h>

#include "core/buffer.h"
#include "frame/frame.h"

namespace pelage {

/// [h·w] pixels, from where `view` sees what is at the center of a pixel to where `before` saw it: a camera that stood
/// still makes zeros. What `before` had behind its near plane points twice the picture's size away, outside.
///
/// depth: [h·w] camera z at the pixel's center, metres, +inf for nothing (then the direction of view counts).
/// way: [h·w] metres, world: from where what is there is to where it was a frame ago; empty where only the camera moves.
/// Rows in parallel, O(pixels).
Buffer<Vec2> motion_vectors(const CameraView& view, const CameraView& before, const Buffer<float>& depth,
                            const Buffer<Vec3>& way = {});

/// The vectors for files: R and G in pixels, B 0, A 1 where there is something. O(pixels).
Image motion_data(const Buffer<Vec2>& motion, const Buffer<float>& depth, int width, int height);
/// … and for people: hue is the direction, saturation grows with the length and is full at 16 pixels; gray stands still.
Image motion_display(const Buffer<Vec2>& motion, const Buffer<float>& depth, int width, int height);

}  // namespace pelage
