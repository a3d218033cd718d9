#include "composite/side_by_side.h"

#include <algorithm>
#include <utility>

#include "core/check.h"

namespace pelage {

Image side_by_side(std::vector<Image> pictures) {
  PELAGE_CHECK(!pictures.empty());
  if (pictures.size() == 1) return std::move(pictures[0]);
  const Image& first = pictures[0];
  Image all(first.width * static_cast<int>(pictures.size()), first.height, first.channels);
  const std::size_t row = static_cast<std::size_t>(first.width) * first.channel_count();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    PELAGE_CHECK(pictures[i].pixels.size() == first.pixels.size() && pictures[i].width == first.width);
    for (int y = 0; y < first.height; ++y) std::copy_n(pictures[i].at(0, y), row, all.at(static_cast<int>(i) * first.width, y));
  }
  return all;
}

Image part_of(const Image& pictures, int number, int count) {
  PELAGE_CHECK(number >= 0 && number < count && pictures.width % count == 0);
  Image part(pictures.width / count, pictures.height, pictures.channels);
  const std::size_t row = static_cast<std::size_t>(part.width) * part.channel_count();
  for (int y = 0; y < part.height; ++y) std::copy_n(pictures.at(number * part.width, y), row, part.at(0, y));
  return part;
}

}  // namespace pelage
