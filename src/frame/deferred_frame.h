// A frame of method swr: deferred software rasterization of hair meshes (Lipp 2026).
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <span>
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

/// What render_hair() counts, besides the hair, in all views.
struct HairWork {
  std::uint64_t strands = 0, points = 0, evaluations = 0;
};

/// The hair of the scene as each of `views` sees it, without its background: lod and raster for all of them at once, then shade and
/// filter for one after the other.
///
/// views: of one scene and its lights, 1…kMostViews; opaque: what hides hair, one a view, or none.
std::vector<HairPicture> render_hair(std::span<const FrameInputs> views, const DeferredGrooms& grooms,
                                     std::span<const OpaqueLayer> opaque, Stages& stages, HairWork* work = nullptr);

/// The scene as each of `views` sees it, linear: R, G, B, A, premultiplied.
std::vector<Image> render_deferred(std::span<const FrameInputs> views, const DeferredGrooms& grooms, Stages& stages);

}  // namespace pelage
