// Pictures of several views in one.
#pragma once

#include <pelage/image.h>

#include <vector>

namespace pelage {

/// Pictures from left to right, all of the same size and channels, at least one; a single one stays what it is. O(pixels).
Image side_by_side(std::vector<Image> pictures);

/// Picture `number` of the `count` that side_by_side() has put into one. O(its pixels).
Image part_of(const Image& pictures, int number, int count);

}  // namespace pelage
