#include "filter/alpha_fix.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "core/check.h"
#include "core/parallel.h"
#include "core/pixel_mask.h"
#include "filter/segment_counts.h"

namespace pelage {
namespace {

constexpr std::size_t kFillsPerTask = 1024;

/// f(source, its fills) for each source; the fills of one follow each other.
template <class F>
void for_each_source(std::span<const Fill> fills, const F& f) {
  while (!fills.empty()) {
    const std::uint32_t source = fills.front().source;
    const auto end = std::find_if(fills.begin(), fills.end(), [&](const Fill& fill) { return fill.source != source; });
    const auto count = static_cast<std::size_t>(end - fills.begin());
    f(source, fills.first(count));
    fills = fills.subspan(count);
  }
}

/// M, N and the colors of all linked segments, and what follows from them for a pixel.
class SegmentAlpha {
 public:
  SegmentAlpha(StrandLayer& layer, const Links& links, std::size_t table_size)
      : layer_(layer), links_(links), counts_(table_size), slots_(layer.visibility.size()) {}

  void count(AlphaStats& stats) {
    insert(stats);
    // Filled pixels count with the segment that they were filled from, even where they lie on the next one.
    parallel_for_fills([&](std::uint32_t source, std::span<const Fill> fills) {
      const std::uint32_t slot = counts_.find(segment_of(source));
      if (slot == SegmentCounts::kNone) return;  // taken back
      for (const Fill& fill : fills) slots_[fill.pixel] = slot;
      SegmentCounts::add_filled(counts_[slot], static_cast<std::uint32_t>(fills.size()));
    });
    layer_.hair.parallel_for_each([&](int x, int y) {
      const std::size_t p = layer_.index(x, y);
      const VisibilitySample& v = layer_.visibility[p];
      if (v.is_filled()) return;
      const std::uint32_t slot = slots_[p] = counts_.find(v.primitive());
      if (slot != SegmentCounts::kNone) SegmentCounts::add_hit(counts_[slot], layer_.color[p]);
    });
    stats.segments = counts_.used();
  }

  /// α of pixel p, which shows hair, and its color, which stays as it is where nothing is linked.
  float alpha(std::size_t p, Vec3& color) const {
    if (slots_[p] == SegmentCounts::kNone) return 1;
    const SegmentCounts::Slot& slot = counts_[slots_[p]];
    color = SegmentCounts::mean_color(slot);
    return static_cast<float>(slot.hit) / static_cast<float>(slot.hit + slot.filled);
  }

 private:
  std::uint32_t segment_of(std::uint32_t pixel) const { return layer_.visibility[pixel].primitive(); }

  /// f(source, fills) in parallel; some sources come twice.
  template <class F>
  void parallel_for_fills(const F& f) const {
    parallel_for(links_.fills.size(), kFillsPerTask, [&](std::size_t begin, std::size_t end) {
      for_each_source(std::span(links_.fills).subspan(begin, end - begin), f);
    });
  }

  void insert(AlphaStats& stats) {
    std::atomic<bool> full{false};
    parallel_for_fills([&](std::uint32_t source, std::span<const Fill>) {
      if (!counts_.insert(segment_of(source))) full = true;
    });
    if (!full) return;
    // Which segment finds no place depends on the order: by one thread, fill by fill, it does not change.
    counts_.clear();
    for (const Fill& fill : links_.fills) {
      if (counts_.insert(segment_of(fill.source))) continue;
      layer_.visibility[fill.pixel] = {};
      layer_.hair.remove(fill.pixel);
      layer_.depth[fill.pixel] = std::numeric_limits<float>::infinity();
      layer_.color[fill.pixel] = {};
      ++stats.overflow;
    }
  }

  StrandLayer& layer_;
  const Links& links_;
  SegmentCounts counts_;
  Buffer<std::uint32_t> slots_;  // [h·w] of what pixels with hair count with, kNone for nothing linked
};

/// Fills screen pixel (x, y): hair(p, color) gives the α of visibility pixel p, which shows hair, and may change its color.
template <class Hair>
void resolve_pixel(const StrandLayer& layer, int x, int y, const Hair& hair, Matte& matte) {
  const float share = 1 / static_cast<float>(layer.side * layer.side);
  Vec3 sum;
  Vec2 tangent;
  MeanDirection direction;
  float alpha = 0, thickness = 0, count = 0;
  layer.for_each_sample(x, y, [&](std::size_t p) {
    if (!layer.visibility[p].is_hair()) return;
    if (!layer.thickness.empty()) thickness += layer.thickness[p];
    count += 1;
    Vec3 color = layer.color[p];
    const float a = hair(p, color);
    sum += color * a, alpha += a;
    tangent = layer.visibility[p].tangent();
    if (layer.side > 1) direction.add(tangent);
  });
  matte.color[matte.index(x, y)] = {sum.x * share, sum.y * share, sum.z * share, alpha * share};
  matte.lie(x, y, layer.side > 1 ? direction.mean() : tangent, thickness / (count * static_cast<float>(layer.side)));
}

/// Matte::coverage: means over the visibility pixels of a screen pixel.
void average_coverage(const StrandLayer& layer, Matte& matte) {
  const float samples = static_cast<float>(layer.side * layer.side);
  parallel_for(static_cast<std::size_t>(matte.height), PixelMask::kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < matte.width; ++x) {
        float sum = 0;
        layer.for_each_sample(x, y, [&](std::size_t p) { sum += layer.coverage[p]; });
        matte.coverage[matte.index(x, y)] = sum / samples;
      }
  });
}

/// The screen pixels that have hair in one of their visibility pixels.
PixelMask screen_hair(const StrandLayer& layer, int width, int height) {
  if (layer.side == 1) return layer.hair;
  return {width, height, [&](std::size_t p) {
            const int x = static_cast<int>(p % static_cast<std::size_t>(width)) * layer.side,
                      y = static_cast<int>(p / static_cast<std::size_t>(width)) * layer.side;
            for (int j = y; j < y + layer.side; ++j)
              if (layer.hair.bits(x, j, layer.side) != 0) return true;
            return false;
          }};
}

template <class Hair>
void resolve_hair(const StrandLayer& layer, Matte& matte, const Hair& hair) {
  matte.hair = screen_hair(layer, matte.width, matte.height);
  // Rows are cleared when they are about to be written, and lie in the cache.
  parallel_for(static_cast<std::size_t>(matte.height), PixelMask::kRowsPerTask, [&](std::size_t first, std::size_t last) {
    matte.clear(static_cast<int>(first), static_cast<int>(last));
    matte.hair.for_each(first, last, [&](int x, int y) { resolve_pixel(layer, x, y, hair, matte); });
  });
}

}  // namespace

std::size_t segment_table_size(const StrandLayer& layer, const Links& links) {
  const PixelBox box = layer.hair.box();
  const std::size_t pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
  return std::max<std::size_t>(1, std::min((pixels * 6 + 4) / 5, 2 * links.walks));
}

Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, int border, std::size_t table_size,
                AlphaStats& stats) {
  PELAGE_CHECK_EQ(layer.width % layer.side, 0);
  PELAGE_CHECK_EQ(layer.height % layer.side, 0);
  PELAGE_CHECK(layer.hair.width() == layer.width && layer.hair.height() == layer.height);
  Matte matte(layer.width / layer.side, layer.height / layer.side, border, alpha == LinkAlpha::kCoverage);
  matte.left = layer.left / layer.side, matte.top = layer.top / layer.side;
  if (alpha == LinkAlpha::kCoverage) {
    PELAGE_CHECK_EQ(layer.coverage.size(), layer.visibility.size());
    resolve_hair(layer, matte, [&](std::size_t p, Vec3&) { return layer.coverage[p]; });
    average_coverage(layer, matte);
    return matte;
  }
  if (alpha == LinkAlpha::kNone) {
    resolve_hair(layer, matte, [](std::size_t, Vec3&) { return 1.f; });
    return matte;
  }
  SegmentAlpha segments(layer, links, table_size);
  segments.count(stats);
  resolve_hair(layer, matte, [&](std::size_t p, Vec3& color) { return segments.alpha(p, color); });
  return matte;
}

Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, int border, AlphaStats& stats) {
  return fix_alpha(layer, links, alpha, border, segment_table_size(layer, links), stats);
}

}  // namespace pelage
