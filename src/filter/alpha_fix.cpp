#include "filter/alpha_fix.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/hair_box.h"
#include "filter/segment_counts.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 8, kFillsPerTask = 1024, kPixelsPerTask = 1 << 14;

/// M, N and the colors of all linked segments, and what follows from them for a pixel.
class SegmentAlpha {
 public:
  SegmentAlpha(StrandLayer& layer, const Links& links, std::size_t table_size)
      : layer_(layer), links_(links), counts_(table_size) {}

  void count(AlphaStats& stats) {
    insert(stats);
    parallel_for(links_.fills.size(), kFillsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (const Fill& fill = links_.fills[i]; layer_.visibility[fill.pixel].is_filled())
          SegmentCounts::add_filled(*counts_.find(segment_of(fill.source)));
    });
    parallel_for(layer_.visibility.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const VisibilitySample& v = layer_.visibility[p];
        if (!v.is_hair() || v.is_filled()) continue;
        if (SegmentCounts::Slot* slot = counts_.find(v.primitive())) SegmentCounts::add_hit(*slot, layer_.color[p]);
      }
    });
    stats.segments = counts_.used();
  }

  /// α of a pixel that shows the segment, and its color, which stays as it is where nothing is linked.
  float alpha(std::uint32_t segment, Vec3& color) {
    const SegmentCounts::Slot* slot = counts_.find(segment);
    if (!slot) return 1;
    color = SegmentCounts::mean_color(*slot);
    return static_cast<float>(slot->hit) / static_cast<float>(slot->hit + slot->filled);
  }

 private:
  std::uint32_t segment_of(std::uint32_t pixel) const { return layer_.visibility[pixel].primitive(); }

  void insert(AlphaStats& stats) {
    std::atomic<bool> full{false};
    parallel_for(links_.fills.size(), kFillsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (!counts_.insert(segment_of(links_.fills[i].source))) full = true;
    });
    if (!full) return;
    // Which segment finds no place depends on the order: by one thread, pixel by pixel, it does not change.
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
};

/// The segment that a visibility pixel's hair is counted with: that of the sample which it came from.
Buffer<std::uint32_t> counted_segments(const StrandLayer& layer, const Links& links) {
  Buffer<std::uint32_t> segment(layer.visibility.size());
  parallel_for(segment.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) segment[p] = layer.visibility[p].primitive();
  });
  for (const Fill& fill : links.fills) segment[fill.pixel] = layer.visibility[fill.source].primitive();
  return segment;
}

/// Fills the matte: hair(p, color) gives the α of visibility pixel p, which shows hair, and may change its color.
template <class Hair>
void resolve_hair(const StrandLayer& layer, Matte& matte, const Hair& hair) {
  const auto side = static_cast<std::size_t>(layer.side), width = static_cast<std::size_t>(matte.width);
  const float share = 1 / static_cast<float>(side * side);
  parallel_for(static_cast<std::size_t>(matte.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t out = first * width; out < last * width; ++out) {
      const std::size_t corner = out / width * side * static_cast<std::size_t>(layer.width) + out % width * side;
      Vec3 sum;
      float alpha = 0;
      Vec2 tangent;
      MeanDirection direction;
      for (std::size_t s = 0; s < side * side; ++s) {
        const std::size_t p = corner + s / side * static_cast<std::size_t>(layer.width) + s % side;
        if (!layer.visibility[p].is_hair()) continue;
        Vec3 color = layer.color[p];
        const float a = hair(p, color);
        sum += color * a, alpha += a;
        tangent = layer.visibility[p].tangent();
        direction.add(tangent);
      }
      if (side > 1) tangent = direction.mean();
      matte.r[out] = sum.x * share, matte.g[out] = sum.y * share, matte.b[out] = sum.z * share;
      matte.alpha[out] = alpha * share;
      matte.tangent_x[out] = tangent.x, matte.tangent_y[out] = tangent.y;
    }
  });
}

/// Means of StrandLayer::coverage over screen pixels.
void average_coverage(const StrandLayer& layer, Matte& matte) {
  const auto side = static_cast<std::size_t>(layer.side), width = static_cast<std::size_t>(matte.width);
  parallel_for(matte.coverage.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t out = begin; out < end; ++out) {
      const std::size_t corner = out / width * side * static_cast<std::size_t>(layer.width) + out % width * side;
      float sum = 0;
      for (std::size_t s = 0; s < side * side; ++s)
        sum += layer.coverage[corner + s / side * static_cast<std::size_t>(layer.width) + s % side];
      matte.coverage[out] = sum / static_cast<float>(side * side);
    }
  });
}

}  // namespace

std::size_t segment_table_size(const StrandLayer& layer) {
  const HairBox box = hair_box(layer.width, layer.height, [&](std::size_t p) { return layer.visibility[p].is_hair(); });
  const std::size_t pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
  return std::max<std::size_t>(1, (pixels * 6 + 4) / 5);
}

Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, std::size_t table_size, AlphaStats& stats) {
  PELAGE_CHECK_EQ(layer.width % layer.side, 0);
  PELAGE_CHECK_EQ(layer.height % layer.side, 0);
  Matte matte;
  matte.resize(layer.width / layer.side, layer.height / layer.side, alpha == LinkAlpha::kCoverage);
  if (alpha == LinkAlpha::kCoverage) {
    PELAGE_CHECK_EQ(layer.coverage.size(), layer.visibility.size());
    resolve_hair(layer, matte, [&](std::size_t p, Vec3&) { return layer.coverage[p]; });
    average_coverage(layer, matte);
    return matte;
  }
  SegmentAlpha segments(layer, links, table_size);
  segments.count(stats);
  const Buffer<std::uint32_t> segment = counted_segments(layer, links);
  resolve_hair(layer, matte, [&](std::size_t p, Vec3& color) { return segments.alpha(segment[p], color); });
  return matte;
}

Matte fix_alpha(StrandLayer& layer, const Links& links, LinkAlpha alpha, AlphaStats& stats) {
  return fix_alpha(layer, links, alpha, segment_table_size(layer), stats);
}

}  // namespace pelage
