// The box around everything that is hair, on the screen: the filter's size and the segment table's follow from it.
#pragma once

#include <algorithm>
#include <cstddef>

namespace pelage {

/// Pixels left ≤ x < right, top ≤ y < bottom; empty by default.
struct HairBox {
  int left = 0, right = 0, top = 0, bottom = 0;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

/// The box of the pixels p = y·width + x for which is_hair(p) holds. O(pixels) at most: rows are read from both ends.
template <class IsHair>
HairBox hair_box(int width, int height, const IsHair& is_hair) {
  HairBox box{width, 0, height, 0};
  const auto hair = [&](int x, int y) {
    return is_hair(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  };
  for (int y = 0; y < height; ++y) {
    int x = 0;
    while (x < width && !hair(x, y)) ++x;
    if (x == width) continue;
    box.left = std::min(box.left, x), box.top = std::min(box.top, y), box.bottom = y + 1;
    for (x = width; x > box.right && !hair(x - 1, y);) --x;
    box.right = std::max(box.right, x);
  }
  return box.bottom > 0 ? box : HairBox{};
}

}  // namespace pelage
