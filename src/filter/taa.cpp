#include "filter/taa.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "frame/reproject.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 4;

/// Something seen: where on the screen, how far, and which pixel's it is.
struct Sample {
  Vec2 at;
  float depth;
  std::size_t pixel;
};

/// Depths of a frame's samples, its border continued outside.
class DepthField {
 public:
  DepthField(const Buffer<float>& depth, int width, int height, Vec2 position)
      : depth_(&depth), width_(width), height_(height), position_(position) {}

  /// The nearest of the 3×3 samples around a pixel: at an outline the thing in front, whose motion the outline has.
  Sample nearest_around(int x, int y) const {
    Sample best = at(x, y);
    for (int j = y - 1; j <= y + 1; ++j)
      for (int i = x - 1; i <= x + 1; ++i)
        if (const Sample s = at(i, j); s.depth < best.depth) best = s;
    return best;
  }

 private:
  Sample at(int x, int y) const {
    x = std::clamp(x, 0, width_ - 1), y = std::clamp(y, 0, height_ - 1);
    const std::size_t p = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    return {{static_cast<float>(x) + position_.x, static_cast<float>(y) + position_.y}, (*depth_)[p], p};
  }

  const Buffer<float>* depth_;
  int width_, height_;
  Vec2 position_;
};

/// Y, Co, Cg and alpha of a pixel.
Vec4 to_ycocg(const float* rgba) {
  const Vec3 c = kernel::filter_to_ycocg(Vec3(rgba[0], rgba[1], rgba[2]));
  return {c.x, c.y, c.z, rgba[3]};
}

/// Mean and standard deviation of the colors of 3×3 pixels.
struct ColorBox {
  Vec4 middle, deviation;
};

ColorBox colors_around(const Image& image, int x, int y) {
  Vec4 sum, squares;
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i) {
      const Vec4 c = to_ycocg(image.at(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1)));
      sum.x += c.x, sum.y += c.y, sum.z += c.z, sum.w += c.w;
      squares.x += c.x * c.x, squares.y += c.y * c.y, squares.z += c.z * c.z, squares.w += c.w * c.w;
    }
  const auto deviation = [](float square, float mean) { return std::sqrt(std::max(0.f, square / 9 - mean * mean)); };
  const Vec4 m(sum.x / 9, sum.y / 9, sum.z / 9, sum.w / 9);
  return {m, {deviation(squares.x, m.x), deviation(squares.y, m.y), deviation(squares.z, m.z), deviation(squares.w, m.w)}};
}

/// Pulls a color of the history toward the middle of the box until it is inside.
Vec4 clip(Vec4 c, const ColorBox& box, float deviations) {
  if (std::isinf(deviations)) return c;
  const Vec3 offset(c.x - box.middle.x, c.y - box.middle.y, c.z - box.middle.z);
  const Vec3 half = Vec3(box.deviation.x, box.deviation.y, box.deviation.z) * deviations;
  const float share = kernel::filter_clip_share(offset, half), reach = box.deviation.w * deviations;
  return {box.middle.x + share * offset.x, box.middle.y + share * offset.y, box.middle.z + share * offset.z,
          std::clamp(c.w, box.middle.w - reach, box.middle.w + reach)};
}

/// The history between its pixels, by Catmull-Rom weights: sharper than bilinear, exact at pixel centers.
Vec4 read_history(const Image& image, Vec2 at) {
  const float fx = std::floor(at.x - 0.5f), fy = std::floor(at.y - 0.5f);
  const Vec4 u = kernel::curve_catmull_rom_weights(at.x - 0.5f - fx), v = kernel::curve_catmull_rom_weights(at.y - 0.5f - fy);
  const float across[4] = {u.x, u.y, u.z, u.w}, down[4] = {v.x, v.y, v.z, v.w};
  float sum[4] = {};
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const float* p = image.at(std::clamp(static_cast<int>(fx) + i - 1, 0, image.width - 1),
                                std::clamp(static_cast<int>(fy) + j - 1, 0, image.height - 1));
      for (int c = 0; c < 4; ++c) sum[c] += across[i] * down[j] * p[c];
    }
  for (float& value : sum) value = std::max(value, 0.f);  // the weights have negative lobes
  sum[3] = std::min(sum[3], 1.f);
  return to_ycocg(sum);
}

/// Mixes a pixel of the new frame, whose share is `share`, with the history's.
void blend(Vec4 history, float share, float* rgba) {
  const Vec3 color = kernel::filter_from_ycocg(Vec3(history.x, history.y, history.z));
  const float before[4] = {color.x, color.y, color.z, history.w};
  for (int c = 0; c < 4; ++c) rgba[c] = std::max(0.f, before[c] + share * (rgba[c] - before[c]));
}

/// Finds again what a pixel sees in the frame before.
class Reprojection {
 public:
  /// `way`: as TaaFrame::way, of the frame `now` is of.
  Reprojection(DepthField now, const CameraView& view, DepthField then, const CameraView& before, const Buffer<Vec3>& way,
               float same_place)
      : now_(now), then_(then), view_(view), before_(before), way_(way), same_place_(same_place) {}

  /// The place of pixel (x, y) in the history's picture; none where it is outside, or shows something else: what was seen
  /// there has since moved otherwise than what is seen here.
  std::optional<Vec2> place_of(int x, int y) const {
    const Sample here = now_.nearest_around(x, y);
    const Vec3 way = way_.empty() ? Vec3() : way_[here.pixel];
    const std::optional<Vec2> motion = motion_of(here, view_, before_, way);
    if (!motion) return {};
    const Vec2 place = Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) + *motion;
    if (!(place.x >= 0 && place.x < static_cast<float>(view_.width))) return {};
    if (!(place.y >= 0 && place.y < static_cast<float>(view_.height))) return {};
    const Sample there = then_.nearest_around(static_cast<int>(place.x), static_cast<int>(place.y));
    const std::optional<Vec2> back = motion_of(there, before_, view_, -way);
    if (!back) return {};
    const Vec2 apart = *motion + *back;
    if (apart.x * apart.x + apart.y * apart.y > same_place_ * same_place_) return {};
    return place;
  }

 private:
  static std::optional<Vec2> motion_of(const Sample& s, const CameraView& from, const CameraView& to, Vec3 way) {
    // Through its own view as well, so that rounding cancels: a still camera moves nothing at all.
    const Seen start = reproject(from, from, s.at, s.depth), end = reproject(from, to, s.at, s.depth, way);
    if (!end.visible) return {};
    return end.at - start.at;
  }

  DepthField now_, then_;
  const CameraView& view_;
  const CameraView& before_;
  const Buffer<Vec3>& way_;
  float same_place_;
};

}  // namespace

void TaaHistory::add(TaaFrame frame) {
  const int width = frame.color.width, height = frame.color.height;
  const std::size_t columns = static_cast<std::size_t>(width), pixels = columns * static_cast<std::size_t>(height);
  PELAGE_CHECK_EQ(frame.color.channel_count(), 4u);
  PELAGE_CHECK_EQ(frame.depth.size(), pixels);
  PELAGE_CHECK(frame.way.empty() || frame.way.size() == pixels);
  if (color_.pixels.empty()) {
    age_.resize(pixels), age_.fill(1);
    color_ = std::move(frame.color), depth_ = std::move(frame.depth);
    view_ = frame.view, position_ = frame.position;
    return;
  }
  PELAGE_CHECK_EQ(color_.pixels.size(), frame.color.pixels.size());
  const Reprojection reprojection({frame.depth, width, height, frame.position}, frame.view, {depth_, width, height, position_},
                                  view_, frame.way, settings_.same_place);
  Image result = frame.color;
  Buffer<float> age(pixels);
  parallel_for(static_cast<std::size_t>(height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first * columns; p < last * columns; ++p) {
      const int x = static_cast<int>(p % columns), y = static_cast<int>(p / columns);
      const std::optional<Vec2> place = reprojection.place_of(x, y);
      age[p] = 1;
      if (!place) continue;
      age[p] = std::min(age_[static_cast<std::size_t>(place->y) * columns + static_cast<std::size_t>(place->x)] + 1,
                        1 / settings_.least_blend);
      const Vec4 history = clip(read_history(color_, *place), colors_around(frame.color, x, y), settings_.clip_deviations);
      blend(history, 1 / age[p], result.pixels.data() + 4 * p);
    }
  });
  color_ = std::move(result), depth_ = std::move(frame.depth), age_ = std::move(age);
  view_ = frame.view, position_ = frame.position;
}

}  // namespace pelage
