// measure_continuity(): which places of a strand a picture shows, and how long one can follow it.
//
// A place is judged by the contrast across the strand: the mean of the pixels within one of it, minus the mean of those three and
// four pixels to either side. An even haze has no contrast, and blur loses it as it widens, so neither closes a gap; a strand that is
// drawn one pixel off still has it. The reference says how much contrast there is to show, and in which channels:
//
//   shown  ⇔  t · r ≥ share · r · r        r, t: contrast (R, G, B, A; linear, premultiplied) of reference and test
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "metrics/pair.h"

namespace pelage {
namespace {

using metrics::Colors;

constexpr float kCore[] = {-1, -0.5f, 0, 0.5f, 1};  // pixels across the strand
constexpr float kSides[] = {-4, -3, 3, 4};
constexpr std::size_t kPartsPerTask = 64;

/// A picture as premultiplied linear channels.
class Channels {
 public:
  Channels(const Picture& picture, bool with_alpha) : colors_(metrics::colors_of(picture)) {
    if (picture.encoding == Encoding::kDisplay) {
      colors_.rgb = metrics::decode_display(std::move(colors_.rgb));
      for (std::size_t p = 0; p < colors_.alpha.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) colors_.rgb.pixels[3 * p + c] *= colors_.alpha[p];
    }
    if (!with_alpha) colors_.alpha.clear();
  }

  int width() const { return colors_.rgb.width; }
  int height() const { return colors_.rgb.height; }

  /// Of the strand at `place` that runs along the unit vector `along`.
  Vec4 contrast(Vec2 place, Vec2 along) const {
    const Vec4 core = mean_across(place, along, kCore), sides = mean_across(place, along, kSides);
    return {core.x - sides.x, core.y - sides.y, core.z - sides.z, core.w - sides.w};
  }

 private:
  template <std::size_t n>
  Vec4 mean_across(Vec2 place, Vec2 along, const float (&offsets)[n]) const {
    Vec4 sum;
    for (const float offset : offsets) {
      const Vec4 c = pixel(place + offset * Vec2(-along.y, along.x));
      sum = {sum.x + c.x, sum.y + c.y, sum.z + c.z, sum.w + c.w};
    }
    const float share = 1.f / n;
    return {sum.x * share, sum.y * share, sum.z * share, sum.w * share};
  }

  Vec4 pixel(Vec2 at) const {
    const int x = std::clamp(static_cast<int>(std::floor(at.x)), 0, width() - 1);
    const int y = std::clamp(static_cast<int>(std::floor(at.y)), 0, height() - 1);
    const std::size_t p = static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
    const float* c = colors_.rgb.pixels.data() + 3 * p;
    return {c[0], c[1], c[2], colors_.alpha.empty() ? 0 : colors_.alpha[p]};
  }

  Colors colors_;
};

float dot4(Vec4 a, Vec4 b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

/// Direction of the path at place `i` of a part.
Vec2 direction(std::span<const Vec2> part, std::size_t i) {
  const Vec2 along = part[std::min(i + 1, part.size() - 1)] - part[i > 0 ? i - 1 : 0];
  const float l = length(along);
  return l > 0 ? along * (1 / l) : Vec2(1, 0);
}

/// Places, not pixels: whole numbers add up to the same in any order.
struct Counts {
  std::uint64_t asked = 0, shown = 0, connected = 0, missing = 0, gaps = 0;

  void add(const Counts& c) {
    asked += c.asked, shown += c.shown, connected += c.connected, missing += c.missing, gaps += c.gaps;
  }
};

/// Follows one part. Places that are not asked for neither break a run nor count.
class Follower {
 public:
  explicit Follower(std::size_t least_run) : least_run_(least_run) {}

  void place(std::size_t i, bool shown) {
    ++counts_.asked;
    shown ? ++counts_.shown : ++counts_.missing;
    if (!shown && (counts_.asked == 1 || last_shown_)) ++counts_.gaps;
    if (!shown) end_run();
    else if (run_++ == 0) run_begin_ = i;
    if (shown) run_end_ = i + 1;
    last_shown_ = shown;
  }
  Counts finish() {
    if (counts_.missing == 0) counts_.connected = counts_.shown;  // the whole of a short part
    else end_run();
    return counts_;
  }

 private:
  void end_run() {
    if (run_ > 0 && run_end_ - run_begin_ >= least_run_) counts_.connected += run_;
    run_ = 0;
  }

  std::size_t least_run_, run_begin_ = 0, run_end_ = 0;
  std::uint64_t run_ = 0;
  bool last_shown_ = false;
  Counts counts_;
};

Counts follow(std::span<const Vec2> part, const Channels& test, const Channels& reference, const ContinuityOptions& options) {
  Follower follower(static_cast<std::size_t>(std::ceil(options.least_run / FlyawayPaths::kStep)));
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Vec2 along = direction(part, i);
    const Vec4 wanted = reference.contrast(part[i], along);
    const float energy = dot4(wanted, wanted);
    if (!(energy >= options.least_contrast * options.least_contrast)) continue;
    follower.place(i, dot4(test.contrast(part[i], along), wanted) >= options.share * energy);
  }
  return follower.finish();
}

bool has_alpha(const Picture& picture) { return metrics::channel(picture.image, "A").has_value(); }

void check_size(const Picture& picture, const FlyawayPaths& paths) {
  if (picture.image.width == paths.width && picture.image.height == paths.height) return;
  throw Error(picture.name, "",
              fmt::format("{} × {} pixels, but the strands were projected to {} × {}", picture.image.width,
                          picture.image.height, paths.width, paths.height),
              "project them to the size of the pictures");
}

}  // namespace

Continuity measure_continuity(const Picture& test, const Picture& reference, const FlyawayPaths& paths,
                              const ContinuityOptions& options) {
  check_size(test, paths), check_size(reference, paths);
  const bool with_alpha = has_alpha(test) && has_alpha(reference);
  const Channels test_channels(test, with_alpha), reference_channels(reference, with_alpha);
  std::vector<Counts> of_task((paths.part_count() + kPartsPerTask - 1) / kPartsPerTask);
  parallel_for(paths.part_count(), kPartsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      of_task[first / kPartsPerTask].add(
          follow(std::span(paths.places).subspan(paths.offsets[i], paths.offsets[i + 1] - paths.offsets[i]), test_channels,
                 reference_channels, options));
  });
  Counts counts;
  for (const Counts& c : of_task) counts.add(c);
  Continuity result;
  result.length = static_cast<double>(counts.asked) * static_cast<double>(FlyawayPaths::kStep);
  if (counts.gaps > 0)
    result.mean_gap =
        static_cast<double>(counts.missing) * static_cast<double>(FlyawayPaths::kStep) / static_cast<double>(counts.gaps);
  if (counts.asked > 0) {
    result.connected = static_cast<double>(counts.connected) / static_cast<double>(counts.asked);
    result.shown = static_cast<double>(counts.shown) / static_cast<double>(counts.asked);
  }
  return result;
}

}  // namespace pelage
