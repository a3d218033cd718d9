#include "filter/matte.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/hair_box.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;

/// What is seen through the hair of screen pixel (x, y): the mean of what is behind its visibility pixels, of those that no
/// sample of hair hides where there are such.
Vec4 seen_behind(const StrandLayer& layer, std::size_t x, std::size_t y) {
  const auto side = static_cast<std::size_t>(layer.side), stride = static_cast<std::size_t>(layer.width);
  if (side == 1) return layer.behind[y * stride + x];
  Vec4 open, all;
  float count = 0;
  const auto add = [](Vec4& sum, Vec4 v, float weight) {
    sum.x += weight * v.x, sum.y += weight * v.y, sum.z += weight * v.z, sum.w += weight * v.w;
  };
  for (std::size_t s = 0; s < side * side; ++s) {
    const std::size_t p = (y * side + s / side) * stride + x * side + s % side;
    const VisibilitySample& v = layer.visibility[p];
    add(all, layer.behind[p], 1);
    if (!v.is_hair() || v.is_filled()) add(open, layer.behind[p], 1), count += 1;
  }
  Vec4 mean;
  if (count > 0) add(mean, open, 1 / count);
  else add(mean, all, 1 / static_cast<float>(side * side));
  return mean;
}

}  // namespace

void Matte::resize(int w, int h, bool exact_coverage) {
  width = w, height = h;
  const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  for (Buffer<float>* plane : {&r, &g, &b, &alpha, &tangent_x, &tangent_y}) plane->resize(n);
  if (exact_coverage) coverage.resize(n);
}

Vec2 MeanDirection::mean() const {
  const float square = cos2_ * cos2_ + sin2_ * sin2_;
  if (!(square > 0)) return {};
  const float length = std::sqrt(square);
  // Half of the angle, by the half-angle formulas.
  const float c = cos2_ / length, x = std::sqrt(std::max(0.f, (1 + c) / 2)), y = std::sqrt(std::max(0.f, (1 - c) / 2));
  return {x, sin2_ < 0 ? -y : y};
}

void extend_tangents(Matte& m, int reach) {
  const HairBox hair = hair_box(m.width, m.height, [&](std::size_t p) { return m.tangent_x[p] != 0 || m.tangent_y[p] != 0; });
  const int left = std::max(0, hair.left - reach), right = std::min(m.width, hair.right + reach),
            top = std::max(0, hair.top - reach), bottom = std::min(m.height, hair.bottom + reach);
  const auto width = static_cast<std::size_t>(m.width);
  // Sums over 2·reach + 1 pixels of a row; those over as many rows of them follow.
  Buffer<Vec2> rows(static_cast<std::size_t>(std::max(0, hair.height())) * width);
  parallel_for(static_cast<std::size_t>(std::max(0, hair.height())), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row)
      for (int x = left; x < right; ++x) {
        MeanDirection sum;
        const std::size_t p = (row + static_cast<std::size_t>(hair.top)) * width;
        for (int i = std::max(hair.left, x - reach); i <= std::min(hair.right - 1, x + reach); ++i)
          sum.add({m.tangent_x[p + static_cast<std::size_t>(i)], m.tangent_y[p + static_cast<std::size_t>(i)]});
        rows[row * width + static_cast<std::size_t>(x)] = sum.doubled();
      }
  });
  parallel_for(static_cast<std::size_t>(std::max(0, bottom - top)), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (int y = top + static_cast<int>(first); y < top + static_cast<int>(last); ++y)
      for (int x = left; x < right; ++x) {
        const std::size_t p = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
        if (m.tangent_x[p] != 0 || m.tangent_y[p] != 0) continue;
        MeanDirection sum;
        for (int j = std::max(hair.top, y - reach); j <= std::min(hair.bottom - 1, y + reach); ++j)
          sum.add_doubled(rows[static_cast<std::size_t>(j - hair.top) * width + static_cast<std::size_t>(x)]);
        const Vec2 t = sum.mean();
        m.tangent_x[p] = t.x, m.tangent_y[p] = t.y;
      }
  });
}

Image lay_over(const Matte& m, const StrandLayer& layer, float exposure) {
  PELAGE_CHECK_EQ(m.width * layer.side, layer.width);
  PELAGE_CHECK_EQ(m.height * layer.side, layer.height);
  Image image(m.width, m.height, {"R", "G", "B", "A"});
  const float light = std::exp2(exposure);
  const auto width = static_cast<std::size_t>(m.width);
  parallel_for(static_cast<std::size_t>(m.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p) {
      const Vec4 back = seen_behind(layer, p % width, p / width);
      // Where the area is known, the filter has only had to find its color.
      const bool exact = !m.coverage.empty() && m.alpha[p] > 0;
      const float alpha = exact ? m.coverage[p] : m.alpha[p], scale = exact ? alpha / m.alpha[p] : 1, through = 1 - alpha;
      float* out = image.pixels.data() + 4 * p;
      out[0] = (m.r[p] * scale + back.x * through) * light;
      out[1] = (m.g[p] * scale + back.y * through) * light;
      out[2] = (m.b[p] * scale + back.z * through) * light;
      out[3] = alpha + back.w * through;
    }
  });
  return image;
}

}  // namespace pelage
