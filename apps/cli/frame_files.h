// The files of a sequence of frames.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace pelage::cli {

struct FrameFiles {
  std::vector<std::string> files;  ///< in the order of their numbers
  std::vector<int> numbers;        ///< of each file, for a pattern with %d; else empty
};

/// The frames that `pattern` names: files with a number where it says %d (or %04d, …), or those that its wildcards * and ?
/// match, ordered by the numbers in their names. None where `pattern` is the name of one picture: it has neither, or a file
/// is called just that. Throws Error where no file matches.
std::optional<FrameFiles> frame_files(const std::string& pattern);

/// Throws Error where two sequences do not have the same frames.
void check_same_frames(const std::string& test_pattern, const FrameFiles& test, const std::string& reference_pattern,
                       const FrameFiles& reference);

}  // namespace pelage::cli
