#include "filter/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 16;

/// Values times their weight, and the weight: 1 known, 0 not.
struct Level {
  int width, height;
  Buffer<Vec4> sum;
  Buffer<float> weight;

  Level(int w, int h) : width(w), height(h), sum(size()), weight(size()) {}
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

/// Half the size: means of 2×2, and how much of a whole pixel is known.
Level pulled(const Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for_pixels(coarse, [&](int x, int y) {
    Vec4 sum;
    float weight = 0;
    for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
      for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
        add(sum, fine.sum[fine.at(i, j)], 1), weight += fine.weight[fine.at(i, j)];
      }
    const float most = weight > 1 ? 1 / weight : 1;
    Vec4 scaled;
    add(scaled, sum, most);
    coarse.sum[coarse.at(x, y)] = scaled, coarse.weight[coarse.at(x, y)] = std::min(weight, 1.f);
  });
  return coarse;
}

/// What a level lacks of whole pixels comes from the next one, bilinearly.
void push(const Level& coarse, Level& fine) {
  for_pixels(fine, [&](int x, int y) {
    const std::size_t p = fine.at(x, y);
    const float lack = 1 - fine.weight[p];
    if (!(lack > 0)) return;
    const float u = (static_cast<float>(x) + 0.5f) / 2 - 0.5f, v = (static_cast<float>(y) + 0.5f) / 2 - 0.5f;
    const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
    const float fu = u - static_cast<float>(left), fv = v - static_cast<float>(top);
    Vec4 sum;
    float weight = 0;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const std::size_t q = coarse.at(std::clamp(left + i, 0, coarse.width - 1), std::clamp(top + j, 0, coarse.height - 1));
        const float share = (i ? fu : 1 - fu) * (j ? fv : 1 - fv);
        add(sum, coarse.sum[q], share), weight += share * coarse.weight[q];
      }
    if (!(weight > 0)) return;
    add(fine.sum[p], sum, lack / weight);
    fine.weight[p] = 1;
  });
}

}  // namespace

void fill_holes(Buffer<Vec4>& values, const Buffer<std::uint8_t>& known, int width, int height) {
  PELAGE_CHECK_EQ(values.size(), known.size());
  std::vector<Level> levels;
  levels.emplace_back(width, height);
  for_pixels(levels[0], [&](int x, int y) {
    const std::size_t p = levels[0].at(x, y);
    levels[0].sum[p] = known[p] ? values[p] : Vec4(), levels[0].weight[p] = known[p] ? 1.f : 0.f;
  });
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(pulled(levels.back()));
  for (std::size_t l = levels.size() - 1; l-- > 0;) push(levels[l + 1], levels[l]);
  for_pixels(levels[0], [&](int x, int y) {
    const std::size_t p = levels[0].at(x, y);
    if (!known[p] && levels[0].weight[p] > 0) values[p] = levels[0].sum[p];
  });
}

}  // namespace pelage
