// Frames by their numbers, as options name them.
#pragma once

#include <pelage/animation.h>

#include <optional>
#include <string>

namespace pelage::cli {

/// --frames N or --frames A-B.
struct FrameList {
  std::optional<int> count;         ///< N
  std::optional<FrameRange> range;  ///< A to B, both of them
};

/// Throws UsageError unless `text` is a number from 1 on, or two with a dash between them, the second not below the first.
FrameList parse_frames(const char* option, const std::string& text);

/// Throws UsageError where the scene does not move, or not in these frames.
void check_frames(const char* option, const Scene& scene, const FrameRange& frames);

}  // namespace pelage::cli
