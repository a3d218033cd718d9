// Small pictures for the overview.
#pragma once

#include <pelage/image.h>
#include <pelage/scene.h>

#include <string>
#include <vector>

namespace pelage::report {

inline constexpr int kThumbnailSide = 176;  ///< pixels at most

/// R, G, B as a display shows them, sRGB-encoded.
Image thumbnail(const Image& linear, ToneMap curve);

/// One channel of errors 0…1 in the colors of error_colors().
Image error_thumbnail(const Image& error);

/// The colors of errors from 0 to 1, as #rrggbb, in equal steps.
std::vector<std::string> error_colors();

}  // namespace pelage::report
