#include "frame_list.h"

#include <fmt/format.h>

#include <regex>

#include "verbs.h"

namespace pelage::cli {
namespace {

constexpr int kMostPictures = 100000;

}  // namespace

FrameList parse_frames(const char* option, const std::string& text) {
  static const std::regex count("[0-9]{1,6}"), range("(-?[0-9]{1,7})-(-?[0-9]{1,7})");
  FrameList list;
  std::smatch parts;
  if (std::regex_match(text, count)) list.count = std::stoi(text);
  else if (std::regex_match(text, parts, range)) list.range = FrameRange{std::stoi(parts[1]), std::stoi(parts[2])};
  const bool sound =
      list.count ? *list.count >= 1 && *list.count <= kMostPictures
                 : list.range && list.range->last >= list.range->first && list.range->last - list.range->first < kMostPictures;
  if (!sound) throw UsageError(option, text, "not understood", "a number of frames, or the first and the last: 48, 1-240");
  return list;
}

void check_frames(const char* option, const Scene& scene, const FrameRange& frames) {
  const std::string text =
      frames.first == frames.last ? fmt::format("{}", frames.first) : fmt::format("{}-{}", frames.first, frames.last);
  const std::optional<FrameRange> moving = animated_frames(scene);
  if (!moving) throw UsageError(option, text, "nothing moves here", "pelage simulate makes hair move");
  if (frames.first < moving->first || frames.last > moving->last)
    throw UsageError(option, text, "there are no such frames", fmt::format("frames are {} to {}", moving->first, moving->last));
}

}  // namespace pelage::cli
