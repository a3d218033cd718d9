// Intel Open Image Denoise (references.bib: Afra2019OpenImageDenoise), in builds where CMake found it.
#pragma once

#include <pelage/image.h>

namespace pelage {

/// Throws Error, which says how to get it, in a build without Open Image Denoise.
void require_oidn();

/// `color` (R, G, B, A, linear) denoised by the filter "RT" for high dynamic range on the CPU; alpha stays as it is. The
/// first three channels of `albedo` (0…1) and `normal` (unit vectors or 0) guide it; all have the same size. Throws Error
/// with what the library says.
Image oidn_denoise(Image color, Image albedo, Image normal);

}  // namespace pelage
