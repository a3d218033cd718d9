// PNG files, read by libpng itself: OpenImageIO's reader lets libpng tell the user of the terminal about damage.
#pragma once

#include <pelage/image.h>

#include "io/byte_source.h"

namespace pelage::io {

/// Pixels as they stand in the file, 0…1, channels Y, YA, RGB or RGBA; palettes, transparent colors and fewer than 8 bits
/// are expanded to them. Throws Error for a file that is cut, damaged or too short for the size that it states.
///
/// Thread safe. Untrusted-input safe. Prints nothing.
Image read_png(const ByteSource& source);

}  // namespace pelage::io
