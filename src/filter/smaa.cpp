#include "filter/smaa.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "core/srgb.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 4;

/// Which pixels have an edge on their left and on their top side.
class Edges {
 public:
  Edges(const Image& display, const SmaaSettings& settings) : width_(display.width), height_(display.height) {
    const Buffer<float> luma = display_luma(display);
    flags_.resize(luma.size());
    const auto width = static_cast<std::size_t>(width_);
    parallel_for(static_cast<std::size_t>(height_), kRowsPerTask, [&](std::size_t first, std::size_t last) {
      for (std::size_t p = first * width; p < last * width; ++p)
        flags_[p] = find(luma, static_cast<int>(p % width), static_cast<int>(p / width), settings);
    });
  }
  bool left(int x, int y) const { return inside(x, y) && (flags_[index(x, y)] & kLeft); }
  bool top(int x, int y) const { return inside(x, y) && (flags_[index(x, y)] & kTop); }
  bool any(std::size_t pixel) const { return flags_[pixel] != 0; }

 private:
  static constexpr std::uint8_t kLeft = 1, kTop = 2;

  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  /// A step counts where nothing much stronger is next to it: eyes see the strongest one alone.
  std::uint8_t find(const Buffer<float>& luma, int x, int y, const SmaaSettings& s) const {
    const auto at = [&](int i, int j) { return luma[index(std::clamp(i, 0, width_ - 1), std::clamp(j, 0, height_ - 1))]; };
    const float here = at(x, y);
    const float left = std::fabs(here - at(x - 1, y)), top = std::fabs(here - at(x, y - 1));
    if (left < s.threshold && top < s.threshold) return 0;
    const float strongest = std::max({left, top, std::fabs(here - at(x + 1, y)), std::fabs(here - at(x, y + 1)),
                                      std::fabs(at(x - 1, y) - at(x - 2, y)), std::fabs(at(x, y - 1) - at(x, y - 2))});
    const auto counts = [&](float step) { return step >= s.threshold && s.contrast_adaptation * step >= strongest; };
    return static_cast<std::uint8_t>((counts(left) ? kLeft : 0) | (counts(top) ? kTop : 0));
  }

  Buffer<std::uint8_t> flags_;
  int width_, height_;
};

/// The edges of one direction, as a row of top edges sees them: `edge(i)` of pixel i of the row, and the edges that cross its
/// line between pixels b − 1 and b: `crossing(b, row)`, row 0 on the pixels' own side, −1 beyond the edge.
struct Row {
  const Edges& edges;
  int line;
  bool edge(int i) const { return edges.top(i, line); }
  bool crossing(int b, int row) const { return edges.left(b, line + row); }
};
struct Column {
  const Edges& edges;
  int line;
  bool edge(int i) const { return edges.left(line, i); }
  bool crossing(int b, int row) const { return edges.top(line + row, b); }
};

/// Where an edge ends, and which way the contour goes on there.
struct LineEnd {
  int place, distance;  // border that it ends at, pixels to there
  bool above, below;
  float height() const { return above == below ? 0 : above ? 0.5f : -0.5f; }
};

/// Follows the edge of pixel i toward smaller (side = 0) or larger (side = 1) indices.
template <class Line>
LineEnd find_end(const Line& line, int i, int side, int most) {
  for (int distance = 0; distance < most; ++distance) {
    const int border = side == 0 ? i - distance : i + 1 + distance;
    const bool above = line.crossing(border, -1), below = line.crossing(border, 0);
    if (above || below || !line.edge(side == 0 ? border - 1 : border)) return {border, distance, above, below};
  }
  return {side == 0 ? i - most : i + 1 + most, most, false, false};
}

/// Heights of a line's two ends. A contour that goes on to both sides goes the way that makes the line straight.
std::array<float, 2> heights(const LineEnd& a, const LineEnd& b) {
  return {a.above && a.below ? -b.height() : a.height(), b.above && b.below ? -a.height() : b.height()};
}

/// Shares that the pixel on an edge's own side (`below`) and the one beyond it (`above`) take of each other.
template <class Line>
EdgeArea shares_across(const Line& line, int i, const SmaaSettings& s) {
  const LineEnd a = find_end(line, i, 0, s.search_steps), b = find_end(line, i, 1, s.search_steps);
  const auto [start, end] = heights(a, b);
  EdgeArea area = smaa_area(a.distance, b.distance, start, end);
  // A crossing edge that is longer than a pixel is a true corner of the shape at the nearer end, not a step of a slope.
  const bool near_a = a.distance <= b.distance, near_b = b.distance <= a.distance;
  const float rounding = (1 - s.corner_rounding) / (near_a && near_b ? 2.f : 1.f);
  const auto corner = [&](int row) {
    return (near_a && line.crossing(a.place, row) ? rounding : 0.f) + (near_b && line.crossing(b.place, row) ? rounding : 0.f);
  };
  area.below *= std::max(0.f, 1 - corner(1));
  area.above *= std::max(0.f, 1 - corner(-2));
  return area;
}

/// ∫ of the parts above and below 0 of the line from (x0, y0) to (x1, y1).
void add_area(float x0, float y0, float x1, float y1, EdgeArea& sum) {
  if ((y0 < 0) != (y1 < 0) && y0 != 0 && y1 != 0) {
    const float zero = x0 + (x1 - x0) * y0 / (y0 - y1);
    add_area(x0, y0, zero, 0, sum);
    return add_area(zero, 0, x1, y1, sum);
  }
  const float area = 0.5f * (x1 - x0) * (y0 + y1);
  (area < 0 ? sum.below : sum.above) += std::fabs(area);
}

/// A pixel as it is mixed: straight pictures are those of a display, whose encoded values do not add up.
Vec4 in_linear_light(const float* rgba, AlphaKind alpha) {
  if (alpha == AlphaKind::kPremultiplied) return {rgba[0], rgba[1], rgba[2], rgba[3]};
  return {srgb_to_linear(rgba[0]), srgb_to_linear(rgba[1]), srgb_to_linear(rgba[2]), rgba[3]};
}

}  // namespace

EdgeArea smaa_area(int left, int right, float start, float end) {
  EdgeArea area;
  const float length = static_cast<float>(left + 1 + right), x0 = static_cast<float>(left), x1 = x0 + 1;
  if (start * end < 0) {
    const auto height = [&](float x) { return start + (end - start) * x / length; };
    add_area(x0, height(x0), x1, height(x1), area);
    return area;
  }
  const float middle = length / 2;
  const auto height = [&](float x) { return x < middle ? start * (1 - x / middle) : end * (x / middle - 1); };
  if (x0 < middle && middle < x1) {
    add_area(x0, height(x0), middle, 0, area);
    add_area(middle, 0, x1, height(x1), area);
  } else {
    add_area(x0, height(x0), x1, height(x1), area);
  }
  return area;
}

Buffer<SmaaShares> smaa_shares(const Image& display, const SmaaSettings& settings) {
  const Edges edges(display, settings);
  struct OfEdges {
    EdgeArea left, top;
  };
  const auto width = static_cast<std::size_t>(display.width), height = static_cast<std::size_t>(display.height);
  Buffer<OfEdges> areas(width * height);
  parallel_for(height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p) {
      areas[p] = {};
      if (!edges.any(p)) continue;
      const int x = static_cast<int>(p % width), y = static_cast<int>(p / width);
      if (edges.top(x, y)) areas[p].top = shares_across(Row{edges, y}, x, settings);
      if (edges.left(x, y)) areas[p].left = shares_across(Column{edges, x}, y, settings);
    }
  });
  Buffer<SmaaShares> shares(width * height);
  parallel_for(height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p)
      shares[p] = {areas[p].left.below, p % width + 1 < width ? areas[p + 1].left.above : 0, areas[p].top.below,
                   p / width + 1 < height ? areas[p + width].top.above : 0};
  });
  return shares;
}

Image smaa_blend(const Image& image, const Buffer<SmaaShares>& shares, AlphaKind alpha) {
  PELAGE_CHECK_EQ(shares.size() * 4, image.pixels.size());
  const auto width = static_cast<std::size_t>(image.width);
  Image result = image;
  parallel_for(static_cast<std::size_t>(image.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * width; p < last * width; ++p) {
      const SmaaShares s = shares[p];
      const bool in_row = std::max(s.left, s.right) > std::max(s.up, s.down);
      const float a = in_row ? s.left : s.up, b = in_row ? s.right : s.down, sum = a + b;
      if (!(sum > 0)) continue;
      const std::size_t step = in_row ? 1 : width;
      const float* pixel = image.pixels.data() + 4 * p;
      PixelSum mix(alpha);
      const auto add = [&](const float* rgba, float weight) {
        const Vec4 light = in_linear_light(rgba, alpha);
        mix.add(&light.x, weight);
      };
      add(pixel, 1 - (a * a + b * b) / sum);
      if (a > 0) add(pixel - 4 * step, a * a / sum);
      if (b > 0) add(pixel + 4 * step, b * b / sum);
      float* out = result.pixels.data() + 4 * p;
      mix.write(out);
      if (alpha == AlphaKind::kStraight)
        for (int c = 0; c < 3; ++c) out[c] = linear_to_srgb(out[c]);
    }
  });
  return result;
}

}  // namespace pelage
