#include "filter/link.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "core/pixel_mask.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = PixelMask::kRowsPerTask;
constexpr float kLongestStep = 1.5f;    // pixels
constexpr std::size_t kPrefetch = 8;    // walks ahead
constexpr float kShortestStep = 1e-4f;  // of a span: gives up halving where a strand jumps

/// Neighbor n = 0…8 of a pixel is at (n mod 3 − 1, n div 3 − 1); 4 is the pixel itself.
constexpr int neighbor_x(int n) { return n % 3 - 1; }
constexpr int neighbor_y(int n) { return n / 3 - 1; }

/// How much a score falls short of 1, in 12 bits.
std::uint16_t loss_of(float score) { return static_cast<std::uint16_t>((1 - std::clamp(score, 0.f, 1.f)) * 4095 + 0.5f); }
constexpr std::uint16_t kNoWalk = 4096;

/// The neighbor whose strand fits an empty pixel best, and how well (eq. 5).
struct Choice {
  std::uint16_t neighbor : 4, loss : 12;
};

class Selector {
 public:
  Selector(const StrandLayer& layer, const PixelMask& hair, const LinkSettings& settings)
      : layer_(layer), hair_(hair), settings_(settings) {
    for (int n = 0; n < 9; ++n) {  // from the neighbor to the pixel
      const Vec2 offset(static_cast<float>(-neighbor_x(n)), static_cast<float>(-neighbor_y(n)));
      if (n != 4) axis_[n] = kernel::filter_alignment_axis(offset, settings.sigma);
    }
  }

  /// False where none fits well enough.
  bool choose(int x, int y, Choice& choice) const {
    const float front = settings_.depth_sigma > 0 ? nearest_candidate(x, y) : 0;
    float best = settings_.alignment;
    for (int n = 0; n < 9; ++n)
      if (const float score = score_of(x, y, n, front); score > best) {
        best = score;
        choice = {static_cast<std::uint16_t>(n), loss_of(score)};
      }
    return best > settings_.alignment;
  }

 private:
  /// 0 for no candidate.
  float score_of(int x, int y, int n, float front) const {
    const int nx = x + neighbor_x(n), ny = y + neighbor_y(n);
    if (n == 4 || !hair_.contains(nx, ny)) return 0;
    const std::size_t i = layer_.index(nx, ny);
    const float fit = std::fabs(dot(axis_[n], layer_.visibility[i].tangent()));
    if (!(settings_.depth_sigma > 0)) return fit;
    return fit * kernel::filter_depth_continuity((layer_.depth[i] - front) / front, settings_.depth_sigma);
  }
  float nearest_candidate(int x, int y) const {
    float nearest = INFINITY;
    for (int n = 0; n < 9; ++n)
      if (const int nx = x + neighbor_x(n), ny = y + neighbor_y(n); hair_.contains(nx, ny))
        nearest = std::min(nearest, layer_.depth[layer_.index(nx, ny)]);
    return nearest;
  }

  const StrandLayer& layer_;
  const PixelMask& hair_;
  const LinkSettings& settings_;
  Vec2 axis_[9];
};

/// A pixel on a walk.
struct Step {
  std::uint64_t order;  ///< the least fills the pixel
  std::uint32_t pixel;
  VisibilitySample sample;
  float depth;
};

/// Score (best first), depth (nearest first), source: 12, 20 and 32 bits.
std::uint64_t order_of(std::uint16_t loss, float depth, std::size_t source) {
  const std::uint64_t far = std::bit_cast<std::uint32_t>(depth) >> 11;
  return static_cast<std::uint64_t>(loss) << 52 | far << 32 | source;
}

class Walker {
 public:
  Walker(const StrandLayer& layer, const PixelMask& hair, const StrandCurves& curves)
      : layer_(layer), hair_(hair), curves_(curves) {}

  void prefetch(std::size_t source) const { curves_.prefetch(layer_.visibility[source].primitive()); }
  StrandCurve curve_of(std::size_t source) const { return curves_.curve_of(layer_.visibility[source].primitive()); }

  /// From the sample of pixel `source` along its strand, `curve`, toward the tip (sign 1) or the root (−1): adds the empty pixels
  /// on the way to `steps`.
  void walk(std::size_t source, StrandCurve& curve, std::uint16_t loss, float sign, std::vector<Step>& steps) const {
    const VisibilitySample& start = layer_.visibility[source];
    float s = static_cast<float>(start.primitive() - curve.first_primitive) + start.t;
    CurvePoint last;
    if (!curves_.at(curve, s, last)) return;
    float step = curves_.step(curve, s, layer_.depth[source], 1);
    std::size_t pixel = source;  // the last one that was entered
    for (int count = 0; count < most_steps(); ++count) {
      step = std::min(step, 1.f);
      const float next = std::clamp(s + sign * step, 0.f, curve.end);
      CurvePoint point;
      if (next == s || !curves_.at(curve, next, point)) return;
      const float pixels = length(point.screen - last.screen), tried = step;
      step = kernel::filter_next_step(step, pixels);
      if (pixels > kLongestStep && tried > kShortestStep) continue;  // behind a place that is seen end-on: again, shorter
      s = next, last = point;
      const int x = static_cast<int>(std::floor(point.screen.x)) - layer_.left,
                y = static_cast<int>(std::floor(point.screen.y)) - layer_.top;
      if (!layer_.contains(x, y)) return;
      const std::size_t entered = layer_.index(x, y);
      if (entered == pixel) continue;
      pixel = entered;
      if (pixel == source) continue;
      if (hair_.contains(x, y)) return;
      if (!layer_.opaque_depth.empty() && layer_.opaque_depth[pixel] < point.depth) continue;
      float t = 0;
      const std::uint32_t primitive = StrandCurves::primitive_at(curve, s, t);
      steps.push_back({order_of(loss, point.depth, source), static_cast<std::uint32_t>(pixel),
                       pack_visibility(point.tangent, t, primitive, true), point.depth});
    }
  }

 private:
  /// No walk along a strand needs more, unless the strand winds through the layer's pixels without ever meeting a sample.
  int most_steps() const { return 4 * (layer_.width + layer_.height); }

  const StrandLayer& layer_;
  const PixelMask& hair_;
  const StrandCurves& curves_;
};

/// What every empty pixel next to hair takes, if anything.
struct Choices {
  PixelMask made;          ///< pixels that have chosen
  Buffer<Choice> choices;  ///< [h·w], undefined elsewhere
};

Choices choose_all(const StrandLayer& layer, const PixelMask& hair, const LinkSettings& settings) {
  const Selector selector(layer, hair, settings);
  Choices all{PixelMask(layer.width, layer.height), Buffer<Choice>(layer.visibility.size())};
  hair.grown(1).without(hair).parallel_for_each([&](int x, int y) {
    if (selector.choose(x, y, all.choices[layer.index(x, y)])) all.made.add(x, y);
  });
  return all;
}

/// A sample that walks begin at: the least loss of the empty pixels that chose it, by whether they lie toward the strand's root
/// or its tip; kNoWalk for none.
struct Source {
  std::size_t pixel;
  std::uint16_t loss[2] = {kNoWalk, kNoWalk};
};

Source make_source(const StrandLayer& layer, const Choices& all, int x, int y) {
  Source source{layer.index(x, y)};
  const Vec2 tangent = layer.visibility[source.pixel].tangent();
  for (int n = 0; n < 9; ++n) {
    const int ex = x + neighbor_x(n), ey = y + neighbor_y(n);
    if (!all.made.contains(ex, ey)) continue;
    const Choice& choice = all.choices[layer.index(ex, ey)];
    if (choice.neighbor != 8 - n) continue;  // the empty pixel sees its source on the other side
    const Vec2 offset(static_cast<float>(neighbor_x(n)), static_cast<float>(neighbor_y(n)));
    std::uint16_t& least = source.loss[dot(offset, tangent) > 0];
    least = std::min<std::uint16_t>(least, choice.loss);
  }
  return source;
}

/// Those in rows first ≤ y < last, of the pixels in `with_choices`.
std::vector<Source> sources_of(const StrandLayer& layer, const Choices& all, const PixelMask& with_choices, std::size_t first,
                               std::size_t last) {
  std::vector<Source> sources;
  with_choices.for_each(first, last, [&](int x, int y) {
    const Source source = make_source(layer, all, x, y);
    if (source.loss[0] != kNoWalk || source.loss[1] != kNoWalk) sources.push_back(source);
  });
  return sources;
}

void atomic_least(std::uint64_t& value, std::uint64_t other) {
  const std::atomic_ref<std::uint64_t> shared(value);
  std::uint64_t now = shared.load(std::memory_order_relaxed);
  while (other < now && !shared.compare_exchange_weak(now, other, std::memory_order_relaxed)) {
  }
}

}  // namespace

PixelBox screen_box(const StrandLayer& layer) {
  const PixelBox box = layer.hair.box();
  const auto up = [&](int x) { return (x + layer.side - 1) / layer.side; };
  return {box.left / layer.side, up(box.right), box.top / layer.side, up(box.bottom)};
}

Links link_strands(StrandLayer& layer, const StrandCurves& curves, const LinkSettings& settings) {
  Links links;
  const PixelMask& hair = layer.hair;
  PELAGE_CHECK(hair.width() == layer.width && hair.height() == layer.height);
  const Choices all = choose_all(layer, hair, settings);
  links.candidates = all.made.count();

  // All walks; every pixel learns which of them is the best.
  const std::size_t rows = static_cast<std::size_t>(layer.height), tasks = (rows + kRowsPerTask - 1) / kRowsPerTask;
  std::vector<std::vector<Step>> steps(tasks);
  Buffer<std::uint64_t> best(layer.visibility.size());
  parallel_for(best.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    std::fill(best.begin() + begin, best.begin() + end, ~std::uint64_t{0});
  });
  const PixelMask with_choices = all.made.grown(1).intersected(hair);
  const Walker walker(layer, hair, curves);
  std::atomic<std::size_t> walks{0};
  parallel_for(rows, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    std::vector<Step>& mine = steps[first / kRowsPerTask];
    const std::vector<Source> sources = sources_of(layer, all, with_choices, first, last);
    std::size_t count = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (i + kPrefetch < sources.size()) walker.prefetch(sources[i + kPrefetch].pixel);
      const Source& source = sources[i];
      StrandCurve curve = walker.curve_of(source.pixel);
      for (int tipward = 0; tipward < 2; ++tipward)
        if (source.loss[tipward] != kNoWalk)
          walker.walk(source.pixel, curve, source.loss[tipward], tipward ? 1.f : -1.f, mine), ++count;
    }
    walks += count;
    for (const Step& step : mine) atomic_least(best[step.pixel], step.order);
  });
  links.walks = walks;

  // The best ones fill their pixels. A walk that meets a pixel twice fills it once: the first time.
  std::vector<std::vector<Fill>> fills(tasks);
  parallel_for(tasks, 1, [&](std::size_t task, std::size_t) {
    for (const Step& step : steps[task]) {
      if (best[step.pixel] != step.order || layer.visibility[step.pixel].is_hair()) continue;
      const auto source = static_cast<std::uint32_t>(step.order);
      layer.visibility[step.pixel] = step.sample;
      layer.depth[step.pixel] = step.depth;
      layer.color[step.pixel] = layer.color[source];
      if (!layer.thickness.empty()) layer.thickness[step.pixel] = layer.thickness[source];
      layer.hair.add_shared(step.pixel);
      fills[task].push_back({step.pixel, source});
    }
  });
  for (const auto& part : fills) links.fills.insert(links.fills.end(), part.begin(), part.end());
  return links;
}

}  // namespace pelage
