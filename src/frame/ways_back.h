// From where strands and meshes are to where they were a frame ago.
#pragma once

#include "core/buffer.h"
#include "frame/frame.h"
#include "frame/one_frame.h"

namespace pelage {

/// [h·w] metres, world. Of a strand the way of the same parameter on the same segment in inputs.before, of a mesh that of the point
/// under the pixel. `keys` and `depth`: [h·w] what the middle of each pixel sees, camera z in metres, +inf for nothing. Pixels of
/// nothing have the way of the nearest thing within two pixels, 0 where there is none.
Buffer<Vec3> ways_back(const FrameInputs& inputs, const Buffer<PixelKey>& keys, const Buffer<float>& depth);

}  // namespace pelage
