// The state of a picture on disk: what was traced so far is never lost, and goes on to the same bits.
#pragma once

#include <pelage/trace.h>

#include <cstdint>
#include <string>

#include "reference/film.h"

namespace pelage {

/// A number that two calls of trace() share when they draw the same picture: all of scene and settings that a sample depends
/// on. How many samples, when to stop and what to keep does not count, so a finished picture can be refined.
std::uint64_t fingerprint(const Scene& scene, const TraceSettings& settings);

/// Replaces the file at `path` in one step: killed at any moment, the old state or the new one stands there.
/// Throws Error when it cannot be written.
void write_checkpoint(const std::string& path, const Film& film, std::uint64_t fingerprint);

/// Reads into `film`, whose size and layers say what is expected. Returns false when there is no file. Throws Error on a
/// damaged file, and on one of another picture.
bool read_checkpoint(const std::string& path, std::uint64_t fingerprint, Film& film);

}  // namespace pelage
