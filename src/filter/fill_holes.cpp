#include "filter/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 16;

/// A picture, and which of its pixels are known.
struct Level {
  int width, height;
  Buffer<Vec4> value;
  Buffer<std::uint8_t> known;

  Level(int w, int h) : width(w), height(h), value(size()), known(size()) {}
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

void add(Vec4& sum, Vec4 v, float weight) {
  sum.x += weight * v.x, sum.y += weight * v.y, sum.z += weight * v.z, sum.w += weight * v.w;
}

template <class Body>
void for_pixels(const Level& level, const Body& body) {
  parallel_for(static_cast<std::size_t>(level.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < level.width; ++x) body(x, y);
  });
}

/// Half the size: means of those of 2×2 pixels that are known.
Level pulled(const Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for_pixels(coarse, [&](int x, int y) {
    Vec4 sum, mean;
    float count = 0;
    for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
      for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i)
        if (const std::size_t p = fine.at(i, j); fine.known[p]) add(sum, fine.value[p], 1), ++count;
    if (count > 0) add(mean, sum, 1 / count);
    coarse.value[coarse.at(x, y)] = mean, coarse.known[coarse.at(x, y)] = count > 0;
  });
  return coarse;
}

/// What is not known of a level comes bilinearly from the next one, all of which is known by now.
void push(const Level& coarse, Level& fine) {
  for_pixels(fine, [&](int x, int y) {
    const std::size_t p = fine.at(x, y);
    if (fine.known[p]) return;
    const float u = (static_cast<float>(x) + 0.5f) / 2 - 0.5f, v = (static_cast<float>(y) + 0.5f) / 2 - 0.5f;
    const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
    const float fu = u - static_cast<float>(left), fv = v - static_cast<float>(top);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const std::size_t q = coarse.at(std::clamp(left + i, 0, coarse.width - 1), std::clamp(top + j, 0, coarse.height - 1));
        add(fine.value[p], coarse.value[q], (i ? fu : 1 - fu) * (j ? fv : 1 - fv));
      }
  });
}

}  // namespace

void fill_holes(Buffer<Vec4>& values, const Buffer<std::uint8_t>& known, int width, int height) {
  PELAGE_CHECK_EQ(values.size(), known.size());
  std::vector<Level> levels;
  levels.emplace_back(width, height);
  for_pixels(levels[0], [&](int x, int y) {
    const std::size_t p = levels[0].at(x, y);
    levels[0].value[p] = known[p] ? values[p] : Vec4(), levels[0].known[p] = known[p];
  });
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(pulled(levels.back()));
  if (!levels.back().known[0]) return;
  for (std::size_t l = levels.size() - 1; l-- > 0;) push(levels[l + 1], levels[l]);
  for_pixels(levels[0], [&](int x, int y) {
    const std::size_t p = levels[0].at(x, y);
    if (!known[p]) values[p] = levels[0].value[p];
  });
}

}  // namespace pelage
