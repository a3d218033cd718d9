// A number per pixel, and its mean over a set of pixels.
#pragma once

#include <pelage/metrics.h>

#include <algorithm>
#include <optional>

#include "core/parallel.h"

namespace pelage::metrics {

constexpr std::size_t kRowGrain = 8;

/// Calls body(y) for every row, in parallel.
template <class Body>
void for_each_row(int height, const Body& body) {
  parallel_for(static_cast<std::size_t>(height), kRowGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y) body(static_cast<int>(y));
  });
}

inline Image make_field(int width, int height) { return Image(width, height, {"error"}); }

/// Mean of term(x, y) over the pixels of `set` inside `within`; none where there are none. Rows sum by themselves and are
/// added in their order: the same bits for any number of threads.
template <class Term>
std::optional<double> mean_over(const PixelSet& set, PixelRect within, const Term& term) {
  const int x0 = std::max(set.rect.x, within.x), x1 = std::min(set.rect.x + set.rect.width, within.x + within.width);
  const int y0 = std::max(set.rect.y, within.y), y1 = std::min(set.rect.y + set.rect.height, within.y + within.height);
  if (x0 >= x1 || y0 >= y1) return std::nullopt;
  struct Row {
    double sum = 0;
    std::size_t count = 0;
  };
  std::vector<Row> rows(static_cast<std::size_t>(y1 - y0));
  for_each_row(y1 - y0, [&](int row) {
    Row sum;
    for (int x = x0; x < x1; ++x)
      if (set.contains(x, y0 + row)) sum.sum += static_cast<double>(term(x, y0 + row)), ++sum.count;
    rows[static_cast<std::size_t>(row)] = sum;
  });
  Row total;
  for (const Row& row : rows) total.sum += row.sum, total.count += row.count;
  if (!total.count) return std::nullopt;
  return total.sum / static_cast<double>(total.count);
}

inline std::optional<double> mean_over(const PixelSet& set, const Image& field) {
  return mean_over(set, {0, 0, field.width, field.height}, [&](int x, int y) { return *field.at(x, y); });
}

}  // namespace pelage::metrics
