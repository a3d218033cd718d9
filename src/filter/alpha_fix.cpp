#include "filter/alpha_fix.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/pixel_mask.h"
#include "filter/segment_counts.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8, kFillsPerTask = 1024;

/// f(source, first, last) for the fills of each source; those of one follow each other.
template <class F>
void for_each_source(std::span<const Fill> fills, std::size_t begin, std::size_t end, const F& f) {
  for (std::size_t i = begin, last = begin; i < end; i = last) {
    while (last < end && fills[last].source == fills[i].source) ++last;
    f(fills[i].source, i, last);
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
    parallel_for(links_.fills.size(), kFillsPerTask, [&](std::size_t begin, std::size_t end) {
      for_each_source(links_.fills, begin, end, [&](std::uint32_t source, std::size_t first, std::size_t last) {
        SegmentCounts::Slot* slot = counts_.find(segment_of(source));
        std::uint32_t filled = 0;
        for (std::size_t i = first; i < last; ++i) {
          slots_[links_.fills[i].pixel] = slot;
          filled += layer_.visibility[links_.fills[i].pixel].is_filled();
        }
        if (filled > 0) SegmentCounts::add_filled(*slot, filled);
      });
    });
    hair_pixels(layer_).parallel_for_each([&](int x, int y) {
      const std::size_t p = static_cast<std::size_t>(y) * static_cast<std::size_t>(layer_.width) + static_cast<std::size_t>(x);
      const VisibilitySample& v = layer_.visibility[p];
      if (v.is_filled()) return;
      SegmentCounts::Slot* slot = slots_[p] = counts_.find(v.primitive());
      if (slot) SegmentCounts::add_hit(*slot, layer_.color[p]);
    });
    stats.segments = counts_.used();
  }

  /// α of pixel p, which shows hair, and its color, which stays as it is where nothing is linked.
  float alpha(std::size_t p, Vec3& color) const {
    const SegmentCounts::Slot* slot = slots_[p];
    if (!slot) return 1;
    color = SegmentCounts::mean_color(*slot);
    return static_cast<float>(slot->hit) / static_cast<float>(slot->hit + slot->filled);
  }

 private:
  std::uint32_t segment_of(std::uint32_t pixel) const { return layer_.visibility[pixel].primitive(); }

  void insert(AlphaStats& stats) {
    std::atomic<bool> full{false};
    parallel_for(links_.fills.size(), kFillsPerTask, [&](std::size_t begin, std::size_t end) {
      for_each_source(links_.fills, begin, end, [&](std::uint32_t source, std::size_t, std::size_t) {
        if (!counts_.insert(segment_of(source))) full = true;
      });
    });
    if (!full) return;
    // Which segment finds no place depends on the order: by one thread, fill by fill, it does not change.
    counts_.clear();
    for (const Fill& fill : links_.fills) {
      if (counts_.insert(segment_of(fill.source))) continue;
      layer_.visibility[fill.pixel] = {};
      layer_.depth[fill.pixel] = std::numeric_limits<float>::infinity();
      layer_.color[fill.pixel] = {};
      ++stats.overflow;
    }
  }

  StrandLayer& layer_;
  const Links& links_;
  SegmentCounts counts_;
  Buffer<SegmentCounts::Slot*> slots_;  // [h·w] of what pixels with hair count with, null for nothing linked
};

/// The visibility pixel that screen pixel (x, y) begins with.
std::size_t corner_of(const StrandLayer& layer, int x, int y) {
  return static_cast<std::size_t>(y * layer.side) * static_cast<std::size_t>(layer.width) +
         static_cast<std::size_t>(x * layer.side);
}
/// Its visibility pixel number s.
std::size_t sample_of(const StrandLayer& layer, std::size_t corner, std::size_t s) {
  const auto side = static_cast<std::size_t>(layer.side);
  return corner + s / side * static_cast<std::size_t>(layer.width) + s % side;
}

/// hair(p, color) gives the α of visibility pixel p, which shows hair, and may change its color.
template <class Hair>
MattePixel resolve_pixel(const StrandLayer& layer, std::size_t corner, const Hair& hair) {
  const auto samples = static_cast<std::size_t>(layer.side * layer.side);
  const float share = 1 / static_cast<float>(samples);
  Vec3 sum;
  Vec2 tangent;
  MeanDirection direction;
  MattePixel m;
  bool seen = false;
  for (std::size_t s = 0; s < samples; ++s) {
    const std::size_t p = sample_of(layer, corner, s);
    if (!layer.coverage.empty()) m.coverage += layer.coverage[p] * share;
    if (!layer.visibility[p].is_hair()) continue;
    seen = true;
    Vec3 color = layer.color[p];
    const float a = hair(p, color);
    sum += color * a, m.alpha += a;
    tangent = layer.visibility[p].tangent();
    if (samples > 1) direction.add(tangent);
  }
  m.r = sum.x * share, m.g = sum.y * share, m.b = sum.z * share, m.alpha *= share;
  if (seen) m.lie(samples > 1 ? direction.mean() : tangent);
  return m;
}

template <class Hair>
void resolve_hair(const StrandLayer& layer, Matte& matte, const Hair& hair) {
  matte.clear();
  parallel_for(static_cast<std::size_t>(matte.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < matte.width; ++x) {
        const std::size_t corner = corner_of(layer, x, y);
        bool any = false;
        for (std::size_t s = 0; s < static_cast<std::size_t>(layer.side * layer.side); ++s)
          any = any || layer.visibility[sample_of(layer, corner, s)].is_hair();
        if (any || matte.exact_coverage) matte.at(x, y) = resolve_pixel(layer, corner, hair);
        if (any) matte.hair.add(x, y);
      }
  });
}

}  // namespace

std::size_t segment_table_size(const StrandLayer& layer, const Links& links) {
  const PixelBox box = hair_pixels(layer).box();
  const std::size_t pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
  return std::max<std::size_t>(1, std::min((pixels * 6 + 4) / 5, 2 * links.walks));
}

Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, int border, std::size_t table_size,
                AlphaStats& stats) {
  PELAGE_CHECK_EQ(layer.width % layer.side, 0);
  PELAGE_CHECK_EQ(layer.height % layer.side, 0);
  Matte matte(layer.width / layer.side, layer.height / layer.side, border);
  matte.left = layer.left / layer.side, matte.top = layer.top / layer.side;
  if (alpha == LinkAlpha::kCoverage) {
    PELAGE_CHECK_EQ(layer.coverage.size(), layer.visibility.size());
    matte.exact_coverage = true;
    resolve_hair(layer, matte, [&](std::size_t p, Vec3&) { return layer.coverage[p]; });
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
