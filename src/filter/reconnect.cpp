#include "filter/reconnect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/kernel_taps.h"
#include "filter/matte.h"
#include "filter/reconnect_taps.h"
#include "frame/camera_view.h"
#include "frame/reproject.h"

namespace pelage {
namespace {

/// Taps by direction: the neighbors within reach of the kernel, and those in the strip in which hits are counted.
class TapTable {
 public:
  TapTable(const SwrSettings& s, std::size_t stride) : first_(1), first_in_strip_(1) {
    const float r = static_cast<float>(s.radius), sigma_along = r * s.s_parallel, sigma_across = r * s.s_perpendicular;
    for (int cell = 0; cell < DirectionCells::kDirections; ++cell) {
      const Vec2 t = DirectionCells::middle(cell);
      for (int y = -s.radius; y <= s.radius; ++y)
        for (int x = -s.radius; x <= s.radius; ++x) {
          const Vec2 d(static_cast<float>(x), static_cast<float>(y));
          const float along = dot(d, t), across = length(d - t * along);
          const float weight =
              std::exp(-along * along / (sigma_along * sigma_along) - across * across / (sigma_across * sigma_across));
          const std::int32_t offset = y * static_cast<std::int32_t>(stride) + x;
          if (across <= s.strip) strip_.push_back({offset, along});
          if (weight >= kLeastReconnectWeight) put(offset, along, weight);
        }
      while (offset_.size() % ReconnectTaps::kLanes != 0) put(0, 0, 0);  // whole lanes; they weigh nothing
      first_.push_back(offset_.size()), first_in_strip_.push_back(strip_.size());
    }
  }
  ReconnectTaps of(int cell) const {
    const auto c = static_cast<std::size_t>(cell);
    return {first_[c + 1] - first_[c], &offset_[first_[c]], &along_[first_[c]], &weight_[first_[c]]};
  }
  struct StripTap {
    std::int32_t offset;  // in pixels of the padded picture
    float along;          // d∥, pixels: along the strand, to the right or straight down
  };
  std::span<const StripTap> strip(int cell) const {
    const auto c = static_cast<std::size_t>(cell);
    return std::span(strip_).subspan(first_in_strip_[c], first_in_strip_[c + 1] - first_in_strip_[c]);
  }

 private:
  void put(std::int32_t offset, float along, float weight) {
    offset_.push_back(offset), along_.push_back(along), weight_.push_back(weight);
  }
  std::vector<std::size_t> first_, first_in_strip_;
  std::vector<std::int32_t> offset_;
  std::vector<float> along_, weight_;
  std::vector<StripTap> strip_;
};

constexpr int kMostAroundLone = 3;  // pixels that a lone strand touches around one of its own, and one more

/// Both layers with a border of `reach` pixels that repeat those at the edge, so that a kernel needs no ends. Depths are shares
/// of the hair's depth range, or kNoDepth.
struct Padded {
  int reach;
  std::size_t stride;
  Buffer<float> r, g, b;          // color of the strand that the center shows
  Buffer<float> center, touched;  // depth of either layer
  Buffer<float> front;            // that of the conservative layer where the center is hit, else that of the opaque scene

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + reach) * stride + static_cast<std::size_t>(x + reach);
  }
};

float depth_of(PixelKey key) {
  return key == kEmptyPixel ? kNoDepth : static_cast<float>(deferred::depth_level(key)) * (1 / kernel::kRasterDepthLevels);
}

Padded pad_layers(const DeferredBuffer& buffer, const Radiance& radiance, int reach) {
  const int width = buffer.view.width, height = buffer.view.height;
  Padded p;
  p.reach = reach, p.stride = static_cast<std::size_t>(width + 2 * reach);
  const auto rows = static_cast<std::size_t>(height + 2 * reach);
  const std::array<Buffer<float>*, 6> layers{&p.r, &p.g, &p.b, &p.center, &p.touched, &p.front};
  for (Buffer<float>* layer : layers) layer->resize(p.stride * rows);
  const auto border = static_cast<std::size_t>(reach), inside = static_cast<std::size_t>(width);
  parallel_for(rows, 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int y = std::clamp(static_cast<int>(row) - reach, 0, height - 1);
      std::size_t q = static_cast<std::size_t>(y) * inside, to = row * p.stride + border;
      for (std::size_t x = 0; x < inside; ++x, ++q, ++to) {
        const bool shown = radiance.index[q] != Radiance::kNone;
        const Vec3 c = shown ? radiance.color[radiance.index[q]] : Vec3();
        p.r[to] = c.x, p.g[to] = c.y, p.b[to] = c.z;
        p.center[to] = depth_of(buffer.center[q]), p.touched[to] = depth_of(buffer.conservative[q]);
        const float behind = buffer.opaque.empty() || buffer.opaque[q] > 1 ? kNoDepth : opaque_tap(buffer.opaque[q]);
        p.front[to] = buffer.center[q] == kEmptyPixel ? behind : p.touched[to];
      }
      for (Buffer<float>* layer : layers) {
        float* begin = &(*layer)[row * p.stride];
        std::fill(begin, begin + border, begin[border]);
        std::fill(begin + border + inside, begin + p.stride, begin[border + inside - 1]);
      }
    }
  });
  return p;
}

/// A strand as a pixel of either layer shows it.
struct ScreenStrand {
  int cell;     // of its direction on the screen
  float depth;  // of the range
  float slope;  // by which depth grows along the direction, per pixel
};

/// Mean of neighbors and their hits.
struct Gathered {
  Vec4 sum;                 // weighted colors; w: their weights
  float hits = 0, all = 0;  // center and conservative hits in the strip
};

class Reconnecter {
 public:
  Reconnecter(const DeferredBuffer& buffer, const Radiance& radiance, const SwrSettings& s, const Buffer<float>& coverage)
      : buffer_(buffer), settings_(s), coverage_(coverage), padded_(pad_layers(buffer, radiance, s.radius)),
        taps_(s, padded_.stride), color_scale_(1 / (s.sigma_color * s.sigma_color)) {}

  Vec4 pixel(int x, int y) const {
    const std::size_t at =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(buffer_.view.width) + static_cast<std::size_t>(x);
    const PixelKey touched = buffer_.conservative[at], center = buffer_.center[at];
    if (touched == kEmptyPixel) return {0, 0, 0, 0};
    const std::size_t middle = padded_.index(x, y);
    if (settings_.alpha != SwrAlpha::kRatio && !lone(middle)) return amid_others(touched, x, y, at);
    if (center == kEmptyPixel) return promoted(touched, x, y, at);
    const Vec4 own = centered(center, x, y, at);
    if (padded_.touched[middle] > padded_.center[middle] - settings_.connect_depth) return own;
    // Another strand in front: laid over the pixel's own, which is opaque then.
    const float alpha = own.w;
    const Vec4 behind = alpha > 0 ? Vec4(own.x / alpha, own.y / alpha, own.z / alpha, 1) : own;
    const Vec4 front = in_front(touched, x, y);
    const float through = 1 - front.w;
    return {front.x + behind.x * through, front.y + behind.y * through, front.z + behind.z * through, 1};
  }

 private:
  ScreenStrand strand(PixelKey key, int x, int y) const {
    const CameraView& v = buffer_.view;
    const float z = buffer_.range.metres(deferred::depth_level(key));
    const Vec3 place = unproject(v, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, z);
    const Vec3 along = transform_vector(v.world_to_camera, deferred::tangent(key));
    const Vec2 on_screen = project_direction(v, place, along);
    const float pixels = length(on_screen);
    const float depth = depth_of(key);
    if (!(pixels > 0)) return {0, depth, 0};
    const Vec2 t = on_screen * (1 / pixels);
    const int cell = DirectionCells::cell_of(MeanDirection::doubled(t));
    const float sign = dot(t, DirectionCells::middle(cell)) < 0 ? -1.f : 1.f;
    // No steeper than a pixel for a pixel: what is seen nearly end-on is short.
    const float steepest = 1 / pixels_per_metre(v, z), per_pixel = std::clamp(along.z / pixels, -steepest, steepest);
    return {cell, depth, sign * per_pixel / (buffer_.range.far_end - buffer_.range.near_end)};
  }

  /// Whether few of the eight pixels around are touched by any strand.
  bool lone(std::size_t middle) const {
    int touched = 0;
    for (const std::size_t row : {middle - padded_.stride, middle, middle + padded_.stride})
      for (std::size_t q = row - 1; q <= row + 1; ++q) touched += padded_.touched[q] != kNoDepth;
    return touched <= 1 + kMostAroundLone;
  }

  /// In dense hair: mean and share of the hits under the kernel along what is in front, but for pixels that the opaque scene hides
  /// from it. Color comes from neighbors that what is in
  /// front of is as deep; where there are none, from all.
  Vec4 amid_others(PixelKey key, int x, int y, std::size_t at) const {
    const ScreenStrand s = strand(key, x, y);
    const std::size_t middle = padded_.index(x, y);
    const ReconnectTaps taps = taps_.of(s.cell);
    const ReconnectPixels here{&padded_.front[middle], &padded_.r[middle], &padded_.g[middle], &padded_.b[middle]};
    TapSums sums = sum_taps(taps, here, {s.depth, s.slope, settings_.depth_tolerance, 0});
    if (!(sums.alike.w > 0)) sums = sum_taps(taps, here, {s.depth, s.slope, 0.5f * kNoDepth, 0});
    const float alpha = !coverage_.empty() ? coverage_[at] : sums.seen > 0 ? std::min(sums.hits / sums.seen, 1.f) : 0;
    return premultiplied({sums.alike}, alpha);
  }

  /// compare: whether the term of color counts. nearby: whether only what is as deep counts, hits and colors: for a strand that
  /// is laid over another one.
  Gathered gather(const ScreenStrand& s, std::size_t middle, bool compare, bool nearby) const {
    Gathered g;
    const float tolerance = nearby ? settings_.connect_depth : settings_.depth_tolerance;
    for (const TapTable::StripTap& tap : taps_.strip(s.cell)) {
      const std::size_t q = middle + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(tap.offset));
      const float expected = s.depth + s.slope * tap.along, center = padded_.center[q], touched = padded_.touched[q];
      const bool hit = center != kNoDepth, touch = touched != kNoDepth;
      g.hits += hit && (!nearby || std::fabs(center - expected) <= tolerance) ? 1.f : 0.f;
      g.all += touch && (!nearby || std::fabs(touched - expected) <= tolerance) ? 1.f : 0.f;
    }
    const ReconnectPixels at{&padded_.center[middle], &padded_.r[middle], &padded_.g[middle], &padded_.b[middle]};
    g.sum = sum_taps(taps_.of(s.cell), at, {s.depth, s.slope, tolerance, compare ? color_scale_ : 0.f}).alike;
    return g;
  }

  float opacity(const Gathered& g, std::size_t at) const {
    if (!coverage_.empty()) return coverage_[at];
    return g.all > 0 ? std::min(g.hits / g.all, 1.f) : 1.f;
  }
  static Vec4 premultiplied(const Gathered& g, float alpha) {
    if (!(g.sum.w > 0)) return {0, 0, 0, 0};
    const float scale = alpha / g.sum.w;
    return {g.sum.x * scale, g.sum.y * scale, g.sum.z * scale, alpha};
  }

  Vec4 centered(PixelKey key, int x, int y, std::size_t at) const {
    const std::size_t middle = padded_.index(x, y);
    const Gathered g = gather(strand(key, x, y), middle, true, false);
    return premultiplied(g, opacity(g, at));
  }
  Vec4 promoted(PixelKey key, int x, int y, std::size_t at) const {
    const Gathered g = gather(strand(key, x, y), padded_.index(x, y), false, false);
    return premultiplied(g, opacity(g, at));
  }
  Vec4 in_front(PixelKey key, int x, int y) const {
    const Gathered g = gather(strand(key, x, y), padded_.index(x, y), false, true);
    return premultiplied(g, g.all > 0 ? std::min(g.hits / g.all, 1.f) : 0.f);
  }

  const DeferredBuffer& buffer_;
  const SwrSettings& settings_;
  const Buffer<float>& coverage_;
  const Padded padded_;
  const TapTable taps_;
  float color_scale_;
};

HairPicture picture_like(const DeferredBuffer& buffer) {
  HairPicture picture;
  picture.left = buffer.left, picture.top = buffer.top;
  picture.width = buffer.view.width, picture.height = buffer.view.height;
  picture.color.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  return picture;
}

}  // namespace

HairPicture reconnect(const DeferredBuffer& buffer, const Radiance& radiance, const SwrSettings& settings,
                      const Buffer<float>& coverage) {
  HairPicture picture = picture_like(buffer);
  if (picture.color.empty()) return picture;
  PELAGE_CHECK_EQ(buffer.conservative.size(), picture.color.size());
  PELAGE_CHECK_EQ(radiance.index.size(), picture.color.size());
  const Reconnecter reconnecter(buffer, radiance, settings, coverage);
  const auto width = static_cast<std::size_t>(picture.width);
  parallel_for(static_cast<std::size_t>(picture.height), 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = 0; x < width; ++x)
        picture.color[y * width + x] = reconnecter.pixel(static_cast<int>(x), static_cast<int>(y));
  });
  return picture;
}

HairPicture mean_of_samples(const DeferredBuffer& buffer, const Radiance& radiance) {
  HairPicture picture = picture_like(buffer);
  if (picture.color.empty()) return picture;
  const std::size_t samples = radiance.index.size() / picture.color.size();
  const float share = 1 / static_cast<float>(samples);
  parallel_for(picture.color.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Vec4 sum(0, 0, 0, 0);
      for (std::size_t i = p * samples; i < (p + 1) * samples; ++i) {
        if (radiance.index[i] == Radiance::kNone) continue;
        const Vec3 c = radiance.color[radiance.index[i]];
        sum.x += c.x, sum.y += c.y, sum.z += c.z, sum.w += 1;
      }
      picture.color[p] = {sum.x * share, sum.y * share, sum.z * share, sum.w * share};
    }
  });
  return picture;
}

}  // namespace pelage
