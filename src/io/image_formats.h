// The picture formats, one file each: bytes ↔ Image, pixels as they stand in the file.
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <string>

#include "io/byte_source.h"

namespace pelage::io {

/// Throws Error for a picture of no pixels, a side above 65536, or more pixels than the file can be believed to hold.
void check_image_size(const ByteSource& source, std::int64_t width, std::int64_t height, std::uint64_t channels);

// Readers: pixels as they stand in the file, no transfer curve, no multiplication by alpha. All throw Error for a file that
// is cut, damaged or too short for the size that it states, before memory is asked for on its word.
//
// Thread safe. Untrusted-input safe. They print nothing.

/// 0…1; channels Y, YA, RGB or RGBA; palettes, transparent colors and fewer than 8 bits are expanded to them.
Image read_png(const ByteSource& source);
/// 0…1; channels Y or RGB.
Image read_jpeg(const ByteSource& source);
/// The first part of the file: scan lines or tiles, any compression, every channel at full resolution. Layers in the
/// file's order (by name), R, G, B, A, Z in front of a layer's other channels.
Image read_exr(const ByteSource& source);
/// Channels R, G, B; rows from the top, in any of Radiance's encodings of RGBE.
Image read_hdr(const ByteSource& source);

// Writers: the bytes of the file. `name` is what an Error names.

/// At most 4 channels, clamped to 0…1, in 8 or 16 bits.
std::string encode_png(const std::string& name, const Image& image, bool sixteen_bits);
/// Any channels, half or float, compressed without loss.
std::string encode_exr(const std::string& name, const Image& image, bool full_float);
/// 3 channels, in runs.
std::string encode_hdr(const std::string& name, const Image& image);

}  // namespace pelage::io
