#include "filter/fxaa.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "filter/resample.h"

namespace pelage {
namespace {

/// Lengths of the steps along an edge, pixels; the later ones are coarse.
constexpr float kSteps[] = {1, 1, 1, 1, 1, 1.5f, 2, 2, 2, 2, 4, 8};

/// Brightness of the picture, its border continued outside.
class Luma {
 public:
  explicit Luma(const Image& display) : values_(display_luma(display)), width_(display.width), height_(display.height) {}

  float at(int x, int y) const {
    x = std::clamp(x, 0, width_ - 1), y = std::clamp(y, 0, height_ - 1);
    return values_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }
  /// Bilinear; (x, y) in pixels from the center of pixel (0, 0).
  float between(float x, float y) const {
    const float fx = std::floor(x), fy = std::floor(y), u = x - fx, v = y - fy;
    const int i = static_cast<int>(fx), j = static_cast<int>(fy);
    const float upper = at(i, j) + u * (at(i + 1, j) - at(i, j));
    const float lower = at(i, j + 1) + u * (at(i + 1, j + 1) - at(i, j + 1));
    return upper + v * (lower - upper);
  }

 private:
  Buffer<float> values_;
  int width_, height_;
};

/// A pixel and its eight neighbors, seen along the edge that passes it: `along` is the direction of the edge.
struct Neighborhood {
  float middle, north, south, east, west, north_west, north_east, south_west, south_east;
  float range() const { return brightest() - std::min({middle, north, south, east, west}); }
  float brightest() const { return std::max({middle, north, south, east, west}); }
  /// Second differences across the rows: large where a horizontal edge passes.
  float horizontal() const {
    return 2 * std::fabs(north + south - 2 * middle) + std::fabs(north_east + south_east - 2 * east) +
           std::fabs(north_west + south_west - 2 * west);
  }
  float vertical() const {
    return 2 * std::fabs(west + east - 2 * middle) + std::fabs(north_west + north_east - 2 * north) +
           std::fabs(south_west + south_east - 2 * south);
  }
};

Neighborhood neighborhood_at(const Luma& luma, int x, int y) {
  return {luma.at(x, y),         luma.at(x, y - 1),     luma.at(x, y + 1),     luma.at(x + 1, y),    luma.at(x - 1, y),
          luma.at(x - 1, y - 1), luma.at(x + 1, y - 1), luma.at(x - 1, y + 1), luma.at(x + 1, y + 1)};
}

/// How far a pixel that differs from the mean of its neighbors moves toward the other side of its edge, 0…subpixel.
float subpixel_shift(const Neighborhood& n, float subpixel) {
  const float cross = n.north + n.south + n.east + n.west;
  const float corners = n.north_west + n.north_east + n.south_west + n.south_east;
  const float difference = std::fabs((2 * cross + corners) / 12 - n.middle) / n.range();
  const float d = std::min(difference, 1.f), smooth = (3 - 2 * d) * d * d;
  return smooth * smooth * subpixel;
}

/// Where an edge ends: `distance` pixels away, where the brightness on the edge is `change` above that of the edge.
struct EdgeEnd {
  float distance, change;
};

/// Walks on the border between two rows (or columns) until the brightness there leaves that of the edge by `enough`.
EdgeEnd find_end(const Luma& luma, Vec2 start, Vec2 step, float edge_luma, float enough) {
  EdgeEnd end{0, 0};
  for (const float length : kSteps) {
    end.distance += length;
    end.change = luma.between(start.x + end.distance * step.x, start.y + end.distance * step.y) - edge_luma;
    if (std::fabs(end.change) >= enough) break;
  }
  return end;
}

/// Of a pixel beside an edge that runs `backward` and `forward` to its ends: what part of it lies across the line
/// that the edge stands for. The line crosses the edge in its middle, so only the half near an end whose brightness goes
/// the other way than the pixel's counts.
float edge_shift(const EdgeEnd& backward, const EdgeEnd& forward, bool darker_than_edge) {
  const EdgeEnd& nearest = backward.distance < forward.distance ? backward : forward;
  if ((nearest.change < 0) == darker_than_edge) return 0;
  return 0.5f - nearest.distance / (backward.distance + forward.distance);
}

Vec2 offset_at(const Luma& luma, int x, int y, const FxaaSettings& settings) {
  const Neighborhood n = neighborhood_at(luma, x, y);
  if (n.range() < std::max(settings.edge_threshold_min, n.brightest() * settings.edge_threshold)) return {};
  const bool horizontal = n.horizontal() >= n.vertical();
  const float before = horizontal ? n.north : n.west, after = horizontal ? n.south : n.east;
  const bool toward_before = std::fabs(before - n.middle) >= std::fabs(after - n.middle);
  const float other = toward_before ? before : after, side = toward_before ? -1.f : 1.f;
  const Vec2 across = horizontal ? Vec2(0, side) : Vec2(side, 0), along = horizontal ? Vec2(1, 0) : Vec2(0, 1);

  const float edge_luma = 0.5f * (n.middle + other), enough = 0.25f * std::fabs(other - n.middle);
  const Vec2 start(static_cast<float>(x) + 0.5f * across.x, static_cast<float>(y) + 0.5f * across.y);
  const EdgeEnd backward = find_end(luma, start, along * -1.f, edge_luma, enough);
  const EdgeEnd forward = find_end(luma, start, along, edge_luma, enough);
  const float shift = std::max(edge_shift(backward, forward, n.middle < edge_luma), subpixel_shift(n, settings.subpixel));
  return across * shift;
}

}  // namespace

Buffer<Vec2> fxaa_offsets(const Image& display, const FxaaSettings& settings) {
  const Luma luma(display);
  const auto width = static_cast<std::size_t>(display.width);
  Buffer<Vec2> offsets(display.pixels.size() / 4);
  parallel_for(static_cast<std::size_t>(display.height), 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p)
      offsets[p] = offset_at(luma, static_cast<int>(p % width), static_cast<int>(p / width), settings);
  });
  return offsets;
}

}  // namespace pelage
