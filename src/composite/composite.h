// Composite: samples over the opaque scene over what is behind it → the linear picture → the picture for a display.
#pragma once

#include <pelage/image.h>
#include <pelage/render.h>  // make_display()
#include <pelage/scene.h>

#include "frame/deferred.h"
#include "frame/frame.h"

namespace pelage {

/// What is seen where nothing is: the environment where it is visible, else the background color, else nothing.
Backdrop make_backdrop(const Scene& scene, const CameraView& view);

/// The layers of one band of the picture, all of the same size and number of samples. Refers, owns nothing.
struct FrameLayers {
  const GBuffer& gbuffer;
  const Radiance& radiance;   ///< of GBuffer::sample_keys, or of `center` where there are none
  const Radiance& edges;      ///< one sample per pixel: a strand that touches it; read where no sample of the pixel is
                              ///< covered, for AlphaSource::kAnalytic only
  const OpaqueLayer& opaque;  ///< empty without meshes
  const Backdrop& backdrop;
};

/// The backdrop alone, settings.width × settings.height pixels of it: R, G, B, A; premultiplied; exposure applied.
Image backdrop_picture(const Backdrop& backdrop, const RenderSettings& settings);

/// Writes the picture of one band: its pixel (0, 0) becomes (x, y) of `linear` (R, G, B, A; premultiplied;
/// exposure applied). AlphaSource::kSamples averages the samples; kAnalytic lays the mean color of the visible strand
/// samples over the opaque scene by the exact area of GBuffer::coverage. O(samples), rows in parallel.
void resolve(const FrameLayers& layers, const RenderSettings& settings, int x, int y, Image& linear);

/// Hair that is a picture of its own over the opaque scene, whose samples are averaged, over the backdrop; exposure in stops applied.
/// opaque: of all of the picture, or empty. O(pixels), rows in parallel.
Image hair_over(const HairPicture& hair, const OpaqueLayer& opaque, const Backdrop& backdrop, int width, int height,
                float exposure);

}  // namespace pelage
