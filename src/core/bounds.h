// Corners of boxes.
#pragma once

#include <pelage/vec.h>

#include <array>
#include <cstddef>

namespace pelage {

inline std::array<Vec3, 8> corners(const Bounds& b) {
  std::array<Vec3, 8> c;
  for (std::size_t i = 0; i < c.size(); ++i)
    c[i] = {i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z};
  return c;
}

}  // namespace pelage
