// Pixels as text: how pictures travel inside a page that may not ask any server for them.
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pelage::report {

/// RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

/// All channels as IEEE half floats, clamped to their range, one channel after the other; each half is the difference to
/// the one before it (modulo 65536); all high bytes, then all low bytes; zlib; base64. Lossless but for the halves.
/// page.js, unpack_halves(), is the way back.
std::string pack_halves(const Image& image);

/// Values 0…1 in 255 steps, each byte the difference to the one before it (modulo 256); zlib; base64.
std::string pack_bytes(const Image& image);

}  // namespace pelage::report
