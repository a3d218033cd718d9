#include "filter/matte.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8;

/// Camera z of the nearest hair of screen pixel (x, y); +inf for none.
float nearest_hair(const StrandLayer& layer, int x, int y) {
  float nearest = std::numeric_limits<float>::infinity();
  layer.for_each_sample(x, y, [&](std::size_t p) { nearest = std::min(nearest, layer.depth[p]); });
  return nearest;
}

/// How far one can see through screen pixel (x, y) past the opaque scene.
float farthest_opaque(const StrandLayer& layer, int x, int y) {
  if (layer.opaque_depth.empty()) return std::numeric_limits<float>::infinity();
  float farthest = 0;
  layer.for_each_sample(x, y, [&](std::size_t p) { farthest = std::max(farthest, layer.opaque_depth[p]); });
  return farthest;
}

void add_scaled(Vec4& sum, Vec4 v, float weight) {
  sum.x += weight * v.x, sum.y += weight * v.y, sum.z += weight * v.z, sum.w += weight * v.w;
}

/// What is seen through the hair of screen pixel (x, y) of the picture: the mean of what is behind its visibility pixels, of
/// those that no sample of hair hides where there are such.
Vec4 seen_behind(const StrandLayer& layer, const Behind& behind, int x, int y) {
  if (layer.side == 1) return behind.at(behind.index(x, y));
  Vec4 open, all;
  float count = 0;
  for (int j = y * layer.side; j < (y + 1) * layer.side; ++j)
    for (int i = x * layer.side; i < (x + 1) * layer.side; ++i) {
      const Vec4 color = behind.at(behind.index(i, j));
      add_scaled(all, color, 1);
      const int u = i - layer.left, v = j - layer.top;
      const bool hidden = layer.hair.contains(u, v) && !layer.visibility[layer.index(u, v)].is_filled();
      if (!hidden) add_scaled(open, color, 1), count += 1;
    }
  Vec4 mean;
  if (count > 0) add_scaled(mean, open, 1 / count);
  else add_scaled(mean, all, 1 / static_cast<float>(layer.side * layer.side));
  return mean;
}

}  // namespace

Matte::Matte(int w, int h, int b, bool exact_coverage) : width(w), height(h), border(b), hair(w, h) {
  const std::size_t pixels = stride() * static_cast<std::size_t>(h + 2 * b);
  color.resize(pixels), weight.resize(pixels), tangent.resize(pixels), thickness.resize(pixels);
  if (exact_coverage) coverage.resize(pixels);
}

void Matte::clear(int first, int last) {
  const std::size_t begin = index(-border, first == 0 ? -border : first),
                    end = index(-border, last == height ? height + border : last);
  std::fill(color.begin() + begin, color.begin() + end, Vec4());
  std::fill(weight.begin() + begin, weight.begin() + end, 0.f);
}

Vec2 MeanDirection::halved(Vec2 d) {
  const float square = dot(d, d);
  if (!(square > 0)) return {};
  // The half-angle formulas.
  const float c = d.x / std::sqrt(square), x = std::sqrt(std::max(0.f, (1 + c) / 2)), y = std::sqrt(std::max(0.f, (1 - c) / 2));
  return {x, d.y < 0 ? -y : y};
}

void extend_tangents(Matte& m, const StrandLayer& layer, int reach) {
  PELAGE_CHECK_EQ(m.width * layer.side, layer.width);
  PixelMask gaps(m.width, m.height);
  // Tangents of gaps are written where none is read: hair is left as it is until all are known.
  m.hair.grown(reach).without(m.hair).parallel_for_each([&](int x, int y) {
    MeanDirection sum;
    float nearest = std::numeric_limits<float>::infinity(), thickness = 0, count = 0;
    for (int j = std::max(0, y - reach); j <= std::min(m.height - 1, y + reach); ++j)
      for (std::uint64_t bits = m.hair.bits(x - reach, j, 2 * reach + 1); bits != 0; bits &= bits - 1) {
        const int i = x - reach + std::countr_zero(bits);
        const std::size_t p = m.index(i, j);
        sum.add(m.tangent[p]), thickness += m.thickness[p], count += 1;
        if (!layer.opaque_depth.empty()) nearest = std::min(nearest, nearest_hair(layer, i, j));
      }
    const Vec2 tangent = sum.mean();
    if (tangent == Vec2() || farthest_opaque(layer, x, y) < nearest) return;
    m.lie(x, y, tangent, thickness / count);
    gaps.add(x, y);
  });
  m.hair = m.hair.united(gaps);
}

Image lay_over(const Matte& m, const Buffer<Vec4>& filtered, const StrandLayer& layer, const Behind& behind, float exposure) {
  PELAGE_CHECK_EQ(m.width * layer.side, layer.width);
  PELAGE_CHECK_EQ(m.left * layer.side, layer.left);
  const Buffer<Vec4>& color = filtered.empty() ? m.color : filtered;
  const int width = behind.width / layer.side, height = behind.height / layer.side;
  Image image(width, height, {"R", "G", "B", "A"});
  const float light = std::exp2(exposure);
  parallel_for(static_cast<std::size_t>(height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    float* out = image.pixels.data() + 4 * first * static_cast<std::size_t>(width);
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < width; ++x, out += 4) {
        Vec4 picture = seen_behind(layer, behind, x, y);
        if (m.hair.contains(x - m.left, y - m.top)) {
          const std::size_t p = m.index(x - m.left, y - m.top);
          const Vec4 hair = color[p];
          // Where the area is known, the filter has only had to find its color.
          const bool exact = !m.coverage.empty() && hair.w > 0;
          const float alpha = exact ? m.coverage[p] : hair.w, scale = exact ? alpha / hair.w : 1, through = 1 - alpha;
          picture = {hair.x * scale + picture.x * through, hair.y * scale + picture.y * through,
                     hair.z * scale + picture.z * through, alpha + picture.w * through};
        }
        out[0] = picture.x * light, out[1] = picture.y * light, out[2] = picture.z * light, out[3] = picture.w;
      }
  });
  return image;
}

}  // namespace pelage
