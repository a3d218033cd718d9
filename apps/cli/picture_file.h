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

/// Before long work: throws Error where no picture can be written to `path`. Opens what writing would open, and drops it.
void check_output(const std::string& path);

/// The first three of four channels.
Image without_alpha(const Image& image);

}  // namespace pelage::cli
