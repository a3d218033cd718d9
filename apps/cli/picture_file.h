// The files that pictures go to.
#pragma once

#include <pelage/image.h>

#include <string>

namespace pelage::cli {

/// After the last dot of the file's name; empty without one.
std::string extension_of(const std::string& path);

/// Whether the file's name has a place for a number, "####".
bool is_numbered(const std::string& path);
/// The path with the last run of # in its name replaced by `number`, with zeros to that width; others stay.
std::string numbered(const std::string& path, int number);

/// Whether the file's name has a place for an eye, "%V".
bool is_for_each_eye(const std::string& path);
/// The path with every %V in its name replaced by "left" (eye 0) or "right" (1).
std::string of_eye(std::string path, int eye);

/// Before long work: throws Error where no picture can be written to `path`. Opens what writing would open, and drops it.
void check_output(const std::string& path);

/// The same for a G-buffer, which is an EXR.
void check_gbuffer_output(const std::string& path);

/// Writes the R, G, B, A of a picture as PNG (`display`; with its alpha where `keep_alpha`) or Radiance HDR (`linear`).
/// Returns false, and writes nothing, for a path of another kind.
bool write_flat_picture(const std::string& path, const Image& linear, const Image& display, bool keep_alpha);

}  // namespace pelage::cli
