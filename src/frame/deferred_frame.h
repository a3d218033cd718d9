// One frame of method swr: deferred software rasterization of hair meshes (Lipp 2026).
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <vector>

#include "frame/deferred.h"
#include "frame/one_frame.h"

namespace pelage {

/// What all frames of a scene share.
struct DeferredGrooms {
  std::vector<DeferredGroom> meshes;
  DeferredMaterials materials;  ///< once there are lights
};

/// The grooms of `scene`, ready to be drawn, without materials yet. Throws Error where one is no hair mesh, or there are more than
/// a pixel can tell apart.
DeferredGrooms prepare_deferred(const Scene& scene);

/// `scene` with strands in place of its hair meshes that suffice for maps of light: a few thousand of each, widened for the rest.
Scene light_stand_in(const Scene& scene);

/// What render_hair() counts, besides the hair.
struct HairWork {
  std::uint64_t strands = 0, points = 0, evaluations = 0;
};

/// The hair of the scene, without its background: lod, raster, shade and filter. opaque_depth: of the whole picture, camera z,
/// [height · width · samples], or empty.
HairPicture render_hair(const FrameInputs& inputs, const DeferredGrooms& grooms, const Buffer<float>& opaque_depth,
                        Stages& stages, HairWork* work = nullptr);

/// The scene, linear: R, G, B, A, premultiplied.
Image render_deferred(const FrameInputs& inputs, const DeferredGrooms& grooms, Stages& stages);

}  // namespace pelage
